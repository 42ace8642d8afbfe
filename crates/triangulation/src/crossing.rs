//! The point at which two crossing lines are cut.

use crate::grid::PointGrid;
use crate::piece::{Cut, Piece, reach_of, sweeps};
use num_traits::ToPrimitive;
use sightlines_exact::{BigInt, BigRational, Grid};
use sightlines_geometry::{Point2, check_coordinate, orient2d};

/// How two crossing lines are cut, and whether a point off one of them was needed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Near the crossing.
    pub(crate) at: Point2,
    pub(crate) cuts: [Option<Cut>; 2],
    pub(crate) rounded: bool,
}

/// Whether a point is on the carrier of a line.
fn on(line: &Piece, p: Point2) -> bool {
    orient2d(line.a, line.b, p) == 0.0
}

/// What two properly crossing lines are cut into. `ends` are the end points of all lines.
pub(crate) fn cuts_at_crossing(l: &Piece, m: &Piece, ends: &PointGrid) -> Crossing {
    let p = rounded_crossing(l, m);
    if on(l, p) && on(m, p) {
        return Crossing { at: p, cuts: [Some(Cut::At(p)); 2], rounded: false };
    }
    let cuts = match (l.opaque, m.opaque) {
        (true, true) => {
            let p = near_end(l, m, reach_of(p)).unwrap_or_else(|| clear_of_ends(l, m, p, ends));
            let cut = |line: &Piece| (p != line.a && p != line.b).then_some(Cut::At(p));
            [cut(l), cut(m)]
        }
        (true, false) if !on(l, p) => [None, Some(short_of(m, l, p))],
        (false, true) if !on(m, p) => [Some(short_of(l, m, p)), None],
        _ => [Some(Cut::At(p)); 2],
    };
    Crossing { at: p, cuts, rounded: true }
}

/// An end point of either line that is within 4 `reach` of the other line's carrier. The distance is computed in
/// doubles, with an error of a few units in the last place, so the test uses 8 `reach`: it may accept more end points
/// than necessary, which is always allowed.
fn near_end(l: &Piece, m: &Piece, reach: f64) -> Option<Point2> {
    let near = |end: Point2, line: &Piece| {
        let d = line.b - line.a;
        orient2d(line.a, line.b, end).abs() <= 8.0 * reach * d.length()
    };
    let candidates = [(l.a, m), (l.b, m), (m.a, l), (m.b, l)];
    candidates.into_iter().find(|&(end, line)| near(end, line)).map(|(end, _)| end)
}

/// Of the doubles around `p`, nearest first, one at which neither wall sweeps over an end point; `p` if
/// there is none.
fn clear_of_ends(l: &Piece, m: &Piece, p: Point2, ends: &PointGrid) -> Point2 {
    let clear = |q: &Point2| {
        [l, m].into_iter().all(|wall| {
            let halves = [Piece { b: *q, ..*wall }, Piece { a: *q, ..*wall }];
            *q != wall.a && *q != wall.b && !halves.iter().any(|half| sweeps(wall, half, ends))
        })
    };
    neighbours(p).find(clear).unwrap_or(p)
}

/// `p` and the doubles up to two steps from it along each axis, nearest first.
fn neighbours(p: Point2) -> impl Iterator<Item = Point2> {
    let step = |x: f64, n: i32| match n {
        0 => x,
        1 => x.next_up(),
        -1 => x.next_down(),
        2 => x.next_up().next_up(),
        _ => x.next_down().next_down(),
    };
    let mut steps: Vec<(i32, i32)> = (-2..=2).flat_map(|i| (-2..=2).map(move |j| (i, j))).collect();
    steps.sort_by_key(|&(i, j): &(i32, i32)| (i * i + j * j, i, j));
    let tidy = |x: f64| check_coordinate(x).ok();
    steps.into_iter().filter_map(move |(i, j)| Some(Point2::new(tidy(step(p.x, i))?, tidy(step(p.y, j))?)))
}

/// Ends `line` just short of `wall` on both sides of their crossing near `p`.
fn short_of(line: &Piece, wall: &Piece, p: Point2) -> Cut {
    let stop = |end: Point2| {
        let side = orient2d(wall.a, wall.b, end) > 0.0;
        let on_side = |q: Point2| {
            let o = orient2d(wall.a, wall.b, q);
            if side { o > 0.0 } else { o < 0.0 }
        };
        // Steps of growing length towards the end point, which is on its own side.
        let steps = (0..52).rev().map(|k| p + (end - p) * 2f64.powi(-k));
        let tidy = |q: Point2| Some(Point2::new(check_coordinate(q.x).ok()?, check_coordinate(q.y).ok()?));
        std::iter::once(p).chain(steps).filter_map(tidy).find(|&q| on_side(q)).unwrap_or(end)
    };
    Cut::Gap(stop(line.a), stop(line.b))
}

/// The crossing of two lines, rounded to doubles; exactly on a line that is parallel to an axis.
fn rounded_crossing(l: &Piece, m: &Piece) -> Point2 {
    let (x, y) = small_integers(l, m).map_or_else(|| by_fractions(l, m), |n| by_integers(&n));
    let x = [l, m].into_iter().find(|s| s.a.x == s.b.x).map_or(x, |s| s.a.x);
    let y = [l, m].into_iter().find(|s| s.a.y == s.b.y).map_or(y, |s| s.a.y);
    let tidy = |x: f64| check_coordinate(x).unwrap_or(0.0);
    Point2::new(tidy(x), tidy(y))
}

/// All coordinates as integers, if they are small ones.
fn small_integers(l: &Piece, m: &Piece) -> Option<[i128; 8]> {
    let all = [l.a.x, l.a.y, l.b.x, l.b.y, m.a.x, m.a.y, m.b.x, m.b.y];
    let small = |x: f64| x.fract() == 0.0 && x.abs() <= f64::from(1u32 << 30);
    all.iter().all(|&x| small(x)).then(|| all.map(|x| x as i128))
}

/// With coordinates up to 2^30, numerators are below 2^95 and denominators below 2^63.
fn by_integers(&[ax, ay, bx, by, cx, cy, dx, dy]: &[i128; 8]) -> (f64, f64) {
    let (ux, uy, vx, vy) = (bx - ax, by - ay, dx - cx, dy - cy);
    // Not zero: the lines cross properly.
    let denominator = ux * vy - uy * vx;
    let numerator = (cx - ax) * vy - (cy - ay) * vx;
    // Whole part and remainder have the same sign, so nothing cancels in their sum.
    let at = |from: i128, along: i128| {
        let n = from * denominator + numerator * along;
        (n / denominator) as f64 + (n % denominator) as f64 / denominator as f64
    };
    (at(ax, ux), at(ay, uy))
}

/// The same in integers of any size, as multiples of a common power of two.
fn by_fractions(l: &Piece, m: &Piece) -> (f64, f64) {
    let all = [l.a.x, l.a.y, l.b.x, l.b.y, m.a.x, m.a.y, m.b.x, m.b.y];
    // With 1 among the numbers, the unit of the grid is 1 or a fraction of it.
    let grid = Grid::of(all.into_iter().chain([1.0])).expect("coordinates of a plan are finite");
    let unit = grid.integer(1.0);
    let [ax, ay, bx, by, cx, cy, dx, dy] = all.map(|x| grid.integer(x));
    let (ux, uy, vx, vy) = (&bx - &ax, &by - &ay, &dx - &cx, &dy - &cy);
    let denominator = &ux * &vy - &uy * &vx;
    let numerator = (&cx - &ax) * &vy - (&cy - &ay) * &vx;
    let at = |from: &BigInt, along: &BigInt| {
        let (n, d) = (from * &denominator + &numerator * along, &denominator * &unit);
        BigRational::new_raw(n, d).to_f64().unwrap_or(0.0)
    };
    (at(&ax, &ux), at(&ay, &uy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn piece(a: (f64, f64), b: (f64, f64)) -> Piece {
        Piece { a: a.into(), b: b.into(), opaque: true, line: 0 }
    }

    proptest! {
        /// Invariant: both ways to compute a crossing agree within the bound that `reach_of` is built on.
        #[test]
        fn crossings_agree(c in prop::array::uniform8(-50i32..50)) {
            let [a, b, c, d] = [0, 2, 4, 6].map(|k| (f64::from(c[k]), f64::from(c[k + 1])));
            let (l, m) = (piece(a, b), piece(c, d));
            if !l.segment().crosses(&m.segment()) {
                return Ok(());
            }
            let exact = by_fractions(&l, &m);
            let quick = by_integers(&small_integers(&l, &m).unwrap());
            let near = |p: f64, q: f64| (p - q).abs() <= 2.0 * f64::EPSILON * p.abs().max(q.abs()).max(1e-300);
            prop_assert!(near(exact.0, quick.0) && near(exact.1, quick.1), "{:?} {:?}", exact, quick);
            let shifted = |p: Point2| p * 0.5f64.powi(40);
            let (l, m) = (Piece { a: shifted(l.a), b: shifted(l.b), ..l }, Piece { a: shifted(m.a), b: shifted(m.b), ..m });
            let small = by_fractions(&l, &m);
            prop_assert_eq!((small.0 * 2f64.powi(40), small.1 * 2f64.powi(40)), exact);
        }
    }

    #[test]
    fn axial_crossings_are_exact() {
        let (l, m) = (piece((0.1, 0.0), (0.1, 1.0)), piece((0.0, 0.3), (1.0, 0.3)));
        assert_eq!(rounded_crossing(&l, &m), Point2::new(0.1, 0.3));
        let none = PointGrid::new([]);
        assert!(!cuts_at_crossing(&l, &m, &none).rounded);
    }
}
