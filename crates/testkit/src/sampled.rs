//! Lower bounds: random chords of a plan, judged in exact integers.
//!
//! What a chord sees is visible, so whatever calls it hidden is wrong; what no chord sees may still be
//! visible through a slit. That is why these are bounds and not oracles, and why they work for plans
//! of any size.

use crate::exact::{Form, Hp, Int, Place, crossing, scaled, small};
use crate::mutate::SplitMix;
use sightlines_cells::Plan;
use sightlines_geometry::{Aabb, Point2};

/// Up to this, all that is computed here fits `i128`: forms have coefficients up to 2^41 and 2^81 and
/// values up to 2^83; comparing two places along a chord would take more, so [`PLACES`] is lower.
const SIDES: i128 = 1 << 40;
/// With coordinates up to K, places along a chord are fractions of at most 64 K^4 / 16 K^2, and
/// comparing two takes 1024 K^6, which is 2^124 for K = 2^19.
const PLACES: i128 = 1 << 19;

/// A segment inside a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// Where it starts.
    pub from: Point2,
    /// Where it ends.
    pub to: Point2,
}

/// Whether the closed segment between two points touches no opaque wall, wall ends included. Exact.
///
/// # Panics
/// If a coordinate is not finite.
pub fn chord_is_clear(plan: &Plan, from: Point2, to: Point2) -> bool {
    clear(plan, &[Chord { from, to }])[0]
}

/// Those of `n` random chords inside the plan's bounding box that touch no opaque wall. The same
/// `seed` gives the same chords; none if the plan has no lines.
pub fn clear_chords(plan: &Plan, seed: u64, n: usize) -> Vec<Chord> {
    let chords = random_chords(&plan.bounds(), seed, n);
    let clear = clear(plan, &chords);
    chords.into_iter().zip(clear).filter_map(|(chord, clear)| clear.then_some(chord)).collect()
}

/// Ends are drawn from 2^16 steps over the box along each axis, then rounded down to [`snap`].
fn random_chords(bounds: &Aabb<2>, seed: u64, n: usize) -> Vec<Chord> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let step = snap(bounds);
    let mut random = SplitMix::new(seed);
    let mut next = || f64::from((random.next() >> 48) as u16) / 65536.0;
    let mut point = || {
        let [x, y] = [0, 1].map(|k| bounds.min[k] + (bounds.max[k] - bounds.min[k]) * next());
        let [x, y] = [x, y].map(|x| step.map_or(x, |step| (x / step).floor() * step));
        Point2::new(x, y)
    };
    (0..n).map(|_| Chord { from: point(), to: point() }).collect()
}

/// The power of two that leaves coordinates of 19 bits, so that plans on a grid as coarse are judged in
/// `i128`; none where that would leave fewer than 1024 steps over the box.
fn snap(bounds: &Aabb<2>) -> Option<f64> {
    let largest = bounds.min.iter().chain(&bounds.max).fold(0.0f64, |m, x| m.max(x.abs()));
    let mut step = 1.0;
    while largest / step > 524_288.0 {
        step *= 2.0;
    }
    while largest / step <= 262_144.0 {
        step *= 0.5;
    }
    let width = (0..2).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    (width >= 1024.0 * step).then_some(step)
}

/// Which chords touch no opaque wall.
fn clear(plan: &Plan, chords: &[Chord]) -> Vec<bool> {
    let walls = plan.lines().iter().filter(|l| l.opaque).flat_map(|l| [l.a, l.b]);
    let points: Vec<Point2> = chords.iter().flat_map(|c| [c.from, c.to]).chain(walls).collect();
    let points = scaled(&points);
    match small(&points, SIDES) {
        Some(points) => clear_in(points, chords.len()),
        None => clear_in(points, chords.len()),
    }
}

fn clear_in<T: Int>(points: Vec<[T; 2]>, n_chords: usize) -> Vec<bool> {
    let points: Vec<Hp<T>> = points.into_iter().map(Hp::new).collect();
    let (chords, walls) = points.split_at(2 * n_chords);
    chords.chunks(2).map(|c| !walls.chunks(2).any(|w| meet(&c[0], &c[1], &w[0], &w[1]))).collect()
}

/// Whether two closed segments meet; the first may be a point.
fn meet<T: Int>(p: &Hp<T>, q: &Hp<T>, u: &Hp<T>, v: &Hp<T>) -> bool {
    let apart = |a: &T, b: &T, c: &T, d: &T| a.max(b) < c.min(d) || c.max(d) < a.min(b);
    if apart(&p.x, &q.x, &u.x, &v.x) || apart(&p.y, &q.y, &u.y, &v.y) {
        return false;
    }
    let sides = |f: Form<T>, a: &Hp<T>, b: &Hp<T>| f.at(a).sign() * f.at(b).sign();
    // Boxes that meet, and neither segment on one side of the other's line: then they meet.
    sides(Form::through(p, q), u, v) <= 0 && sides(Form::through(u, v), p, q) <= 0
}

/// Which groups see which along `n` random chords: a row for each group.
///
/// A piece of a chord between two lines lies in the groups that the sides facing it name; groups of
/// pieces with no opaque line between them see each other. A subset of
/// [`crate::sector_visibility_brute_force`], and works for maps of any size. Chords that touch an end
/// of a line, or a crossing in which lines tie, are left out.
pub fn sampled_sector_visibility(plan: &Plan, seed: u64, n: usize) -> Vec<Vec<bool>> {
    let chords = random_chords(&plan.bounds(), seed, n);
    let ends = plan.lines().iter().flat_map(|l| [l.a, l.b]);
    let points: Vec<Point2> = chords.iter().flat_map(|c| [c.from, c.to]).chain(ends).collect();
    let points = scaled(&points);
    match small(&points, PLACES) {
        Some(points) => sector_chords(plan, points, chords.len()),
        None => sector_chords(plan, points, chords.len()),
    }
}

fn sector_chords<T: Int>(plan: &Plan, points: Vec<[T; 2]>, n_chords: usize) -> Vec<Vec<bool>> {
    let n_groups = plan.n_groups() as usize;
    let mut table = vec![vec![false; n_groups]; n_groups];
    let points: Vec<Hp<T>> = points.into_iter().map(Hp::new).collect();
    let (chords, ends) = points.split_at(2 * n_chords);
    for chord in chords.chunks(2) {
        // The whole line of the chord: its ends mean nothing here.
        let line = Form::through(&chord[0], &chord[1]);
        let along = line.along();
        if ends.iter().any(|p| line.at(p).is_zero()) {
            continue;
        }
        let mut crossed: Vec<(Place<T>, bool, usize)> = Vec::new();
        for (i, e) in ends.chunks(2).enumerate() {
            crossed.extend(crossing(&line, &along, &e[0], &e[1]).map(|(place, left)| (place, left, i)));
        }
        crossed.sort_unstable();
        if crossed.windows(2).all(|w| w[0].0 < w[1].0) {
            walk(plan, &crossed, &mut table);
        }
    }
    table
}

/// Marks what the pieces of one line see of each other.
fn walk<T>(plan: &Plan, crossed: &[(Place<T>, bool, usize)], table: &mut [Vec<bool>]) {
    let mut run: Vec<u32> = Vec::new();
    for (_, from_left, i) in crossed {
        let line = plan.lines()[*i];
        // A line that starts on the left of the walker has its right side towards the walker.
        let (here, beyond) = if *from_left { (line.right, line.left) } else { (line.left, line.right) };
        run.extend(here);
        if line.opaque {
            mark(&run, table);
            run.clear();
        }
        run.extend(beyond);
    }
    mark(&run, table);
}

/// Marks that all groups of `run` see each other.
pub(crate) fn mark(run: &[u32], table: &mut [Vec<bool>]) {
    for &g in run {
        run.iter().for_each(|&h| table[g as usize][h as usize] = true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plans::small_grid_plan;
    use proptest::prelude::*;
    use sightlines_cells::PlanLine;
    use sightlines_geometry::Segment2;

    fn p(x: f64, y: f64) -> Point2 {
        Point2::new(x, y)
    }

    proptest! {
        /// The same answer as the exact predicates of the library.
        #[test]
        fn sampled_chords_agree_with_segments(
            plan in small_grid_plan(1..8), ends in prop::collection::vec((0i32..=16, 0i32..=16), 2),
        ) {
            let [from, to] = [0, 1].map(|i| p(0.5 * f64::from(ends[i].0), 0.5 * f64::from(ends[i].1)));
            prop_assume!(from != to);
            let chord = Segment2::new(from, to);
            let meets = plan.lines().iter().any(|l| chord.meets(&Segment2::new(l.a, l.b)));
            prop_assert_eq!(chord_is_clear(&plan, from, to), !meets);
        }
    }

    #[test]
    fn sampled_chords_are_clear_and_repeatable() {
        let plan = Plan::from_walls([(p(0., 0.), p(0., 4.)), (p(4., 0.), p(4., 4.)), (p(2., 1.), p(2., 4.))]).unwrap();
        let chords = clear_chords(&plan, 5, 500);
        assert_eq!(chords, clear_chords(&plan, 5, 500));
        assert!((100..400).contains(&chords.len()), "{}", chords.len());
        // The impostor: a chord through the middle wall is not clear, nor is one that touches its end.
        assert!(!chord_is_clear(&plan, p(1., 3.), p(3., 3.)) && !chord_is_clear(&plan, p(1., 1.), p(3., 1.)));
        assert!(chord_is_clear(&plan, p(1., f64::next_down(1.)), p(3., f64::next_down(1.))));
        assert!(clear_chords(&Plan::default(), 1, 10).is_empty());
    }

    #[test]
    fn sampled_sectors_see_through_open_lines_only() {
        let side = |x: f64, opaque, left, right| PlanLine { a: p(x, 0.), b: p(x, 9.), opaque, left, right };
        let lines = vec![
            side(0., true, None, Some(0)),
            side(1., false, Some(0), Some(1)),
            side(2., true, Some(1), Some(2)),
            side(3., true, Some(2), None),
        ];
        let table = sampled_sector_visibility(&Plan::new(lines, vec![]).unwrap(), 1, 100);
        assert_eq!(table, [[true, true, false], [true, true, false], [false, false, true]]);
    }
}
