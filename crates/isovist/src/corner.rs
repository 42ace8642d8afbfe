//! Corners of the mesh: ends of walls, and the points where walls cross, which no pair of doubles may represent.

use num_traits::{Signed, ToPrimitive, Zero};
use sightlines_exact::{BigInt, BigRational, Grid};
use sightlines_geometry::{Point2, Segment2};

/// A corner as doubles, and how far off they can be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    pub(crate) at: Point2,
    /// Bound on the error of each coordinate: 0 for an end of a wall, which is where it is.
    pub(crate) reach: f64,
}

/// A point in exact form.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Exact {
    Point(Point2),
    Crossing(Segment2, Segment2),
}

/// Below this magnitude a crossing's coordinate becomes 0, so that no product in the filter underflows.
const TINY: f64 = f64::from_bits((1023 - 400) << 52);

impl Corner {
    pub(crate) const fn exact(at: Point2) -> Self {
        Self { at, reach: 0.0 }
    }

    /// The point where two lines cross, rounded.
    pub(crate) fn crossing(l: Segment2, m: Segment2) -> Self {
        let (x, y) = fractions(Exact::Crossing(l, m));
        let round = |f: &BigRational| f.to_f64().filter(|x| x.abs() >= TINY).unwrap_or(0.0);
        let at = Point2::new(round(&x), round(&y));
        // Two units in the last place, where half a unit is the error of rounding.
        let reach = at.x.abs().max(at.y.abs()) * 2.0 * f64::EPSILON + TINY;
        Self { at, reach }
    }
}

/// Both coordinates as fractions.
pub(crate) fn fractions(e: Exact) -> (BigRational, BigRational) {
    let one = [1.0];
    let grid = Grid::of(numbers(e).chain(one)).expect("coordinates are finite");
    let unit = grid.integer(1.0);
    let [x, y, w] = homogeneous(e, grid);
    let w = w * unit;
    (BigRational::new(x, w.clone()), BigRational::new(y, w))
}

fn numbers(e: Exact) -> impl Iterator<Item = f64> {
    let points = match e {
        Exact::Point(p) => [p; 4],
        Exact::Crossing(l, m) => [l.a, l.b, m.a, m.b],
    };
    points.into_iter().flat_map(|p| [p.x, p.y])
}

/// x, y and w in steps of the grid; the point is (x / w, y / w). Lines of a crossing are not parallel, so w is not 0.
fn homogeneous(e: Exact, grid: Grid) -> [BigInt; 3] {
    match e {
        Exact::Point(p) => [grid.integer(p.x), grid.integer(p.y), BigInt::from(1)],
        Exact::Crossing(l, m) => {
            let [ax, ay, bx, by] = [l.a.x, l.a.y, l.b.x, l.b.y].map(|x| grid.integer(x));
            let [cx, cy, dx, dy] = [m.a.x, m.a.y, m.b.x, m.b.y].map(|x| grid.integer(x));
            let (ux, uy, vx, vy) = (bx - &ax, by - &ay, dx - &cx, dy - &cy);
            let w = &ux * &vy - &uy * &vx;
            let along = (cx - &ax) * &vy - (cy - &ay) * &vx;
            [ax * &w + ux * &along, ay * &w + uy * &along, w]
        }
    }
}

/// The sign of the orientation of three points: 1 if `c` lies to the left of the line from `a` to `b`.
#[cold]
#[inline(never)]
pub(crate) fn orient_exact(a: Exact, b: Exact, c: Exact) -> f64 {
    let grid = Grid::of([a, b, c].into_iter().flat_map(numbers)).expect("coordinates are finite");
    let [[ax, ay, aw], [bx, by, bw], [cx, cy, cw]] = [a, b, c].map(|e| homogeneous(e, grid));
    let det = &ax * (&by * &cw - &bw * &cy) - &ay * (&bx * &cw - &bw * &cx) + &aw * (&bx * &cy - &by * &cx);
    let flipped = [&aw, &bw, &cw].into_iter().filter(|w| w.is_negative()).count() % 2 == 1;
    match (det.is_zero(), det.is_positive() != flipped) {
        (true, _) => 0.0,
        (false, true) => 1.0,
        (false, false) => -1.0,
    }
}

/// Shewchuk's bound A, (3 + 16 u) u (|left| + |right|) with u = 2^-53, and 16 u^2 more: the sum with what corners are moved is rounded, too.
const BOUND: f64 = (3.0 + 16.0 * f64::EPSILON) * (0.5 * f64::EPSILON);

/// The orientation of three corners if doubles decide it: positive if `c` lies to the left of the line from `a` to `b`.
#[inline(always)]
pub(crate) fn orient_filter(a: Corner, b: Corner, c: Corner) -> Option<f64> {
    let (u, v) = (a.at - c.at, b.at - c.at);
    let (left, right) = (u.x * v.y, u.y * v.x);
    let det = left - right;
    // What the corners' own errors change: each difference by `s` or `t`. The factor 2 is for the roundings of this line.
    let (s, t) = (a.reach + c.reach, b.reach + c.reach);
    let moved = 2.0 * (s * (v.x.abs() + v.y.abs()) + t * (u.x.abs() + u.y.abs()) + 2.0 * s * t);
    (det.abs() > BOUND * (left.abs() + right.abs()) + moved).then_some(det)
}

/// A corner in exact form; crossings are the last corners.
pub(crate) fn exact_of(corners: &[Corner], crossings: &[[Segment2; 2]], corner: u32) -> Exact {
    let first = corners.len() - crossings.len();
    match (corner as usize).checked_sub(first) {
        Some(crossing) => Exact::Crossing(crossings[crossing][0], crossings[crossing][1]),
        None => Exact::Point(corners[corner as usize].at),
    }
}
