//! The lines of a cell that pass an edge on one side.
//!
//! A chain often ends at a silhouette: an edge that lines pass on both sides. Then it blocks those on one side, and another
//! chain has to block the rest. Let `s(a, b)` be `orient3d(a, b, x, y)` for an edge from `x` to `y`, which is affine in `a` and in
//! `b`, and `S` the lines between inner points of the ends with `s > 0`.
//!
//! 1. *`S` is connected* if the pairs of corners where `s > 0` are, as edges of a graph of the corners. For one `a` the points
//!    `b` with `s > 0` are a convex set. The points `a` that have any are the union of the convex sets `s(a, b_j) > 0` over the
//!    corners `b_j`; two of these share points near each corner of the first end that both have. A corner `b_j` with no `s < 0` and
//!    some `s > 0` is reached from all inner `a`, and so is enough alone; the same of `a_i`.
//! 2. *No line of `S` meets another edge*, if
//!    * its side `f` is at least `t s` at every pair of corners, for one `t > 0`, or the same of `-f`: then it is so for all
//!      lines, and `f` is nowhere 0 on `S`; or
//!    * for each of its ends `r` and every corner `a_i` of the first end `s(a_i, r) <= 0`, and for some corner less: then it is
//!      less for inner points `a` and all points `r` of the edge, but a line of `S` from `a` that meets it at `r` has
//!      `s(a, r) >= 0`. The same for the second end. One end of the edge may instead lie on the line through `x` and `y`, which no
//!      line of `S` meets; or
//!    * both of its ends lie on that line.
//! 3. The lines with `s = 0` are limits of those with `s > 0` or `s < 0`: a polynomial that is not 0 everywhere is 0 on no open set.

use crate::cell::Cell;
use crate::orient::orient;
use sightlines_geometry::Point3;
use sightlines_multifocal::mesh::collinear;

/// Lines that pass an edge at a part of what others do are a sliver: 2^-20. Only decides which chains are tried.
const SLIVER: f64 = 1.0 / (1u64 << 20) as f64;

/// An edge, and the side of it on which lines pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limit {
    /// The ends of the edge.
    pub(crate) edge: [Point3; 2],
    /// Lines from `a` to `b` have an `orient3d(a, b, x, y)` of this sign, 1 or -1.
    pub(crate) sign: f64,
}

impl Limit {
    /// The other side.
    pub(crate) fn opposite(self) -> Self {
        Self { sign: -self.sign, ..self }
    }
}

/// What is known of the side on which the line between two corners passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    Negative,
    Zero,
    /// The corners were rounded, and the value is not far enough from zero.
    Unknown,
}

impl Sign {
    fn of(value: f64) -> Self {
        match value {
            v if v > 0.0 => Self::Positive,
            v if v < 0.0 => Self::Negative,
            _ => Self::Zero,
        }
    }
}

/// On which side of an edge lines between corners pass, and how far, in some unit.
#[derive(Debug, Clone, Copy)]
struct Passes {
    value: [[f64; 4]; 4],
    sign: [[Sign; 4]; 4],
    /// How far each value may be from that of the true corners, for each corner of the first end.
    error: [f64; 4],
    n: [usize; 2],
}

impl Passes {
    /// Of the side of `edge` where the sign is `sign`.
    fn new(cell: &Cell, [x, y]: [Point3; 2], sign: f64) -> Self {
        let (from, to) = (cell.from.corners(), cell.to.corners());
        let n = [from.len(), to.len()];
        let mut passes = Self { value: [[0.0; 4]; 4], sign: [[Sign::Zero; 4]; 4], error: [0.0; 4], n };
        let rounding = cell.rounding(x, y);
        for (i, &a) in from.iter().enumerate() {
            let here = rounding.of_lines_from(a, x, y);
            passes.error[i] = here.error;
            for (j, &b) in to.iter().enumerate() {
                let value = here.value(b);
                passes.value[i][j] = sign * value;
                passes.sign[i][j] = if value.abs() > here.error {
                    Sign::of(sign * value)
                } else if cell.to.is_exact() {
                    Sign::of(sign * orient(a, b, x, y))
                } else {
                    Sign::Unknown
                };
            }
        }
        passes
    }

    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [n, m] = self.n;
        (0..n).flat_map(move |i| (0..m).map(move |j| [i, j]))
    }

    fn count(&self, sign: Sign) -> usize {
        self.pairs().filter(|&[i, j]| self.sign[i][j] == sign).count()
    }
}

/// Which of the lines of a cell are on a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// None.
    None,
    /// All, or all but some that are limits of others.
    All,
    /// Perhaps some, perhaps all.
    Some,
}

/// The lines of a cell on one side of an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    pub(crate) limit: Limit,
    passes: Passes,
}

impl Side {
    pub(crate) fn new(cell: &Cell, limit: Limit) -> Self {
        Self { limit, passes: Passes::new(cell, limit.edge, limit.sign) }
    }

    /// Which lines of the cell these are.
    pub(crate) fn part(&self) -> Part {
        let has = |sign| self.passes.count(sign) > 0;
        match [has(Sign::Positive), has(Sign::Negative), has(Sign::Unknown)] {
            [false, _, false] => Part::None,
            [true, false, false] => Part::All,
            _ => Part::Some,
        }
    }

    /// Roughly which share of the lines these are.
    pub(crate) fn share(&self) -> f64 {
        let [n, m] = self.passes.n;
        self.passes.count(Sign::Positive) as f64 / (n * m) as f64
    }

    /// The pair of corners whose line is farthest on this side, roughly.
    pub(crate) fn farthest(&self) -> [usize; 2] {
        let value = |[i, j]: [usize; 2]| self.passes.value[i][j];
        self.passes.pairs().max_by(|&p, &q| value(p).total_cmp(&value(q))).unwrap_or_default()
    }

    /// Whether the lines on the other side come near the edge only, as far as doubles tell: it hardly pays to look at them alone.
    pub(crate) fn is_nearly_all(&self) -> bool {
        let values = || self.passes.pairs().map(|[i, j]| self.passes.value[i][j]);
        let most = values().fold(0.0, f64::max);
        values().all(|value| value > -SLIVER * most)
    }

    /// Whether these lines are certainly connected, and there are some.
    ///
    /// If only a part of the first end counts, it has to be possible to reach one corner of the second end from all of it.
    pub(crate) fn is_connected(&self, cell: &Cell) -> bool {
        let passes = &self.passes;
        let of = |sign| passes.pairs().filter(move |&[i, j]| passes.sign[i][j] == sign);
        let Some([first, _]) = of(Sign::Positive).next() else { return false };
        // From a corner whose lines are nowhere on the other side all inner points of the other end can be reached.
        let [n, m] = passes.n;
        let is_whole = |signs: &[Sign]| {
            signs.contains(&Sign::Positive) && signs.iter().all(|s| matches!(s, Sign::Positive | Sign::Zero))
        };
        let to_corner = |j: usize| -> [Sign; 4] { std::array::from_fn(|i| passes.sign[i.min(n - 1)][j]) };
        if (0..m).any(|j| is_whole(&to_corner(j))) {
            return true;
        }
        if cell.from.is_partial() {
            return false;
        }
        if (0..n).any(|i| is_whole(&passes.sign[i][..m])) {
            return true;
        }
        let (mut from, mut to) = ([false; 4], [false; 4]);
        from[first] = true;
        // A path in a graph of four and four corners has at most seven edges.
        for _ in 0..7 {
            for [i, j] in of(Sign::Positive) {
                (from[i], to[j]) = (from[i] || to[j], to[j] || from[i]);
            }
        }
        of(Sign::Positive).all(|[i, _]| from[i]) && of(Sign::Unknown).all(|[i, j]| from[i] || to[j])
    }

    /// Whether certainly none of these lines meets an edge between the ends of the cell.
    pub(crate) fn misses(&self, cell: &Cell, [p, q]: [Point3; 2]) -> bool {
        let [x, y] = self.limit.edge;
        let is_on_line = [p, q].map(|r| r == x || r == y || collinear(x, y, r));
        if is_on_line == [true; 2] {
            return true;
        }
        let is_other_side = |corners: &[Point3], side: &dyn Fn(Point3) -> f64| {
            let mut strictly = false;
            corners.iter().all(|&c| {
                let side = self.limit.sign * side(c);
                strictly |= side < 0.0;
                side <= 0.0
            }) && strictly
        };
        let (from, to) = (cell.from.corners(), cell.to.corners());
        let both = |is_other_side: &dyn Fn(Point3) -> bool| {
            [p, q].iter().zip(is_on_line).all(|(&r, is_on_line)| is_on_line || is_other_side(r))
        };
        both(&|r| is_other_side(from, &|a| orient(a, r, x, y)))
            || cell.to.is_exact() && both(&|r| is_other_side(to, &|b| orient(r, b, x, y)))
            || self.implies_side(&Passes::new(cell, [p, q], 1.0))
    }

    /// Whether there is a `t > 0` such that at all pairs of corners `f >= t s`, or `-f >= t s`.
    fn implies_side(&self, f: &Passes) -> bool {
        let s = &self.passes;
        let Some([i, j]) = s.pairs().find(|&[i, j]| s.sign[i][j] == Sign::Positive) else { return false };
        let turned = match f.sign[i][j] {
            Sign::Positive => 1.0,
            Sign::Negative => -1.0,
            Sign::Zero | Sign::Unknown => return false,
        };
        let (mut low, mut high) = (0.0f64, f64::INFINITY);
        for [i, j] in s.pairs() {
            let t = turned * f.value[i][j] / s.value[i][j];
            match s.sign[i][j] {
                Sign::Positive => high = high.min(t),
                Sign::Negative => low = low.max(t),
                Sign::Zero | Sign::Unknown => {}
            }
        }
        let t = (low + high) / 2.0;
        // Also not a number, and no room.
        if !(t > 0.0 && t < f64::INFINITY && low <= high) {
            return false;
        }
        s.pairs().all(|[i, j]| {
            let sign = if turned > 0.0 { f.sign[i][j] } else { opposite(f.sign[i][j]) };
            match (sign, s.sign[i][j]) {
                (Sign::Zero | Sign::Positive, Sign::Zero | Sign::Negative) => true,
                _ => {
                    let (left, right) = (turned * f.value[i][j], t * s.value[i][j]);
                    // A product and the difference round once each, by 2^-53 of the left and the right at most.
                    let error = f.error[i] + t * s.error[i] + 4.0 * f64::EPSILON * (left.abs() + right.abs());
                    left - right > 1.01 * error
                }
            }
        })
    }
}

const fn opposite(sign: Sign) -> Sign {
    match sign {
        Sign::Positive => Sign::Negative,
        Sign::Negative => Sign::Positive,
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::end::End;
    use crate::truth::{Exact, cut_triangle, cuts, det, exact, mix};
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::{One, Signed, Zero};
    use proptest::prelude::*;
    use proptest::test_runner::TestRunner;
    use sightlines_geometry::Aabb;
    use std::cell::Cell as Count;

    type Edge = [Point3; 2];
    /// Of corners.
    type Weights = Vec<u64>;

    /// Twice the area of a triangle as seen along axis `k`, signed.
    fn turn(a: &Exact, b: &Exact, c: &Exact, k: usize) -> BigRational {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        (&b[i] - &a[i]) * (&c[j] - &a[j]) - (&b[j] - &a[j]) * (&c[i] - &a[i])
    }

    fn point() -> impl Strategy<Value = Point3> {
        [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(f64::from))
    }

    /// A cell with its true corners: a rectangle below, and a triangle that may have been cut.
    #[derive(Debug, Clone)]
    struct Case {
        cell: Cell,
        from: Vec<Exact>,
        to: Vec<Exact>,
    }

    fn case() -> impl Strategy<Value = Case> {
        let scale = prop_oneof![Just(1.0), Just(0.3)];
        ([-3i32..3, -3i32..3], [1i32..5, 1i32..5], [point(), point(), point()], cuts(3), scale).prop_filter_map(
            "a triangle has an area",
            |(low, size, triangle, cuts, scale)| {
                let low = [f64::from(low[0]) * scale, f64::from(low[1]) * scale, -4.0];
                let high = [low[0] + f64::from(size[0]) * scale, low[1] + f64::from(size[1]) * scale, -4.0];
                let triangle = triangle.map(|p| [p[0] * scale, p[1] * scale, (p[2] + 8.0) * scale]);
                if collinear(triangle[0], triangle[1], triangle[2]) {
                    return None;
                }
                let from = End::rectangle(&Aabb { min: low, max: high }, 2)?;
                let (to, truth) = cut_triangle(triangle, cuts);
                let corners = from.corners().iter().map(|&p| exact(p)).collect();
                Some(Case { cell: Cell { from, to }, from: corners, to: truth.to_vec() })
            },
        )
    }

    /// Edges between the ends, some of which end at a corner, or at one of two points.
    fn edge() -> impl Strategy<Value = [Point3; 2]> {
        let end = || prop_oneof![point(), point(), Just([0.0, 1.0, 0.0]), Just([1.0, -1.0, 1.0])];
        [end(), end()].prop_filter("an edge has two ends", |[x, y]| x != y)
    }

    /// The line from `a` over `r` to the plane of the second end: where it arrives, if that is an inner point.
    fn arrival(case: &Case, a: &Exact, r: &Exact) -> Option<Exact> {
        let [p, q, s] = [&case.to[0], &case.to[1], &case.to[2]];
        let (at_a, at_r) = (det(p, q, s, a), det(p, q, s, r));
        let t = (!(&at_a - &at_r).is_zero()).then(|| &at_a / (&at_a - &at_r))?;
        let b = [0, 1, 2].map(|k| &a[k] + (&r[k] - &a[k]) * &t);
        let k = (0..3).find(|&k| !turn(p, q, s, k).is_zero())?;
        let all = turn(p, q, s, k);
        let inside = [[p, q], [q, s], [s, p]].iter().all(|[c, d]| (turn(c, d, &b, k) * &all).is_positive());
        (t >= BigRational::one() && inside).then_some(b)
    }

    /// Invariant: no line on a side that is said to miss an edge meets it. Lines are sent over points of the edge, in fractions.
    #[test]
    fn edges_that_are_missed_are_met_by_no_line_of_the_side() {
        let (missed, met) = (Count::new(0), Count::new(0));
        let weights = || prop::collection::vec(1u64..20, 4);
        let samples = prop::collection::vec((weights(), 0u64..9), 48);
        let strategy = (case(), edge(), edge(), any::<bool>(), samples);
        let check = |(case, [x, y], [p, q], up, samples): (Case, Edge, Edge, bool, Vec<(Weights, u64)>)| {
            let limit = Limit { edge: [x, y], sign: if up { 1.0 } else { -1.0 } };
            let misses = Side::new(&case.cell, limit).misses(&case.cell, [p, q]);
            missed.set(missed.get() + u32::from(misses));
            for (weights, part) in samples {
                let a = mix(&case.from, &weights);
                let r = mix(&[exact(p), exact(q)], &[part, 8 - part]);
                if a == r {
                    continue;
                }
                let Some(b) = arrival(&case, &a, &r) else { continue };
                let side = det(&a, &b, &exact(x), &exact(y));
                if if up { side.is_positive() } else { side.is_negative() } {
                    met.set(met.get() + 1);
                    prop_assert!(!misses, "{:?} {:?} by {:?} {:?}", limit, [p, q], a, b);
                }
            }
            Ok(())
        };
        TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })
            .run(&strategy, check)
            .expect("the invariant holds");
        // Both happen, so that the comparison can fail.
        assert!(missed.get() > 0 && met.get() > 0, "{} missed, {} met", missed.get(), met.get());
    }

    /// Ends in planes across each other, and an edge along both planes or near to that: lines on one side of it are in two parts, or
    /// nearly so.
    fn crossing() -> impl Strategy<Value = (Case, Edge)> {
        let size = || 1i32..4;
        ([size(), size(), size(), size()], -1i32..2, [-1i32..2, -1i32..2]).prop_map(|(size, top, near)| {
            let [a, b, c, d] = size.map(f64::from);
            let from = End::rectangle(&Aabb { min: [-a, 0.0, -4.0], max: [b, 0.0, -2.0] }, 1).expect("it has an area");
            let triangle = [[0.0, -c, 2.0], [0.0, d, 2.0], [0.0, f64::from(top), 4.0]];
            let corners = from.corners().iter().map(|&p| exact(p)).collect();
            let case = Case {
                cell: Cell { from, to: End::triangle(triangle) },
                from: corners,
                to: triangle.map(exact).to_vec(),
            };
            let [x, y] = near.map(f64::from);
            (case, [[0.0, 0.0, -9.0], [x, y, 9.0]])
        })
    }

    /// Whether the samples of a side are connected by lines with one end in common; none without samples.
    fn is_connected_by_samples(of: &[Vec<bool>]) -> Option<bool> {
        let mut reached = vec![false; of.len()];
        reached[of.iter().position(|row| row.contains(&true))?] = true;
        for _ in 0..of.len() {
            for i in 0..of.len() {
                let joins = |k: usize| reached[k] && (0..of[i].len()).any(|j| of[i][j] && of[k][j]);
                reached[i] = reached[i] || (0..of.len()).any(joins);
            }
        }
        Some(of.iter().zip(&reached).all(|(row, reached)| *reached || !row.contains(&true)))
    }

    /// Invariant: sides that are said to be connected are: of sample points of both ends, among them some very near to each corner,
    /// lines on the side are connected by lines with one end in common. The corners of one end are approached before those of the
    /// other: either of the two will do, as a line to a corner may be within rounding of the edge's plane.
    #[test]
    fn connected_sides_are_those_whose_samples_are() {
        let (yes, no, apart) = (Count::new(0), Count::new(0), Count::new(0));
        let weights = || prop::collection::vec(prop::collection::vec(1u64..20, 4), 4);
        let ends = prop_oneof![4 => (case(), edge()), 1 => crossing()];
        let strategy = (ends, any::<bool>(), weights(), weights());
        let check = |((case, [x, y]), up, more_from, more_to): ((Case, Edge), bool, Vec<Weights>, Vec<Weights>)| {
            let limit = Limit { edge: [x, y], sign: if up { 1.0 } else { -1.0 } };
            let side = Side::new(&case.cell, limit);
            let (x, y) = (exact(x), exact(y));
            let samples = |corners: &[Exact], more: &[Weights], near: i32| -> Vec<Exact> {
                let part = BigRational::new(1.into(), BigInt::from(2).pow(near as u32));
                let near = (0..corners.len()).map(|c| {
                    let middle = mix(corners, &vec![1; corners.len()]);
                    [0, 1, 2].map(|k| &corners[c][k] + (&middle[k] - &corners[c][k]) * &part)
                });
                near.chain(more.iter().map(|weights| mix(corners, &weights[..corners.len()]))).collect()
            };
            let holds = |a: &Exact, b: &Exact| {
                let side = det(a, b, &x, &y);
                if up { side.is_positive() } else { side.is_negative() }
            };
            let found = [(200, 50), (50, 200)].map(|(near_from, near_to)| {
                let from = samples(&case.from, &more_from, near_from);
                let to = samples(&case.to, &more_to, near_to);
                let of: Vec<Vec<bool>> = from.iter().map(|a| to.iter().map(|b| holds(a, b)).collect()).collect();
                is_connected_by_samples(&of)
            });
            if found == [None; 2] {
                prop_assert!(!side.is_connected(&case.cell) && side.part() != Part::All);
                return Ok(());
            }
            let is_connected = found.contains(&Some(true));
            prop_assert!(side.part() != Part::None);
            prop_assert!(is_connected || !side.is_connected(&case.cell), "{:?}", limit);
            let count = if side.is_connected(&case.cell) { &yes } else { &no };
            count.set(count.get() + 1);
            apart.set(apart.get() + usize::from(!is_connected));
            Ok(())
        };
        TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })
            .run(&strategy, check)
            .expect("the invariant holds");
        // Most are said to be connected: saying so of none would be safe, too.
        assert!(yes.get() > no.get(), "{} connected, {} not", yes.get(), no.get());
        assert!(apart.get() > 0, "no samples are in two parts");
    }

    #[test]
    fn a_chain_behind_a_silhouette_is_enough_for_the_lines_beyond_it() {
        let square = |z: f64| Aabb { min: [0.0, 0.0, z], max: [2.0, 2.0, z] };
        let end = |z: f64| End::rectangle(&square(z), 2).expect("it has an area");
        let cell = Cell { from: end(0.0), to: end(6.0) };
        let across = |x: f64, z: f64| [[x, -1.0, z], [x, 3.0, z]];
        let beyond = |x: f64, z: f64, sign: f64| Side::new(&cell, Limit { edge: across(x, z), sign });
        let sign = if orient([2.0, 1.0, 0.0], [2.0, 1.0, 6.0], across(1.0, 2.0)[0], across(1.0, 2.0)[1]) > 0.0 {
            1.0
        } else {
            -1.0
        };
        // Lines that pass x = 1 at z = 2 on its right also pass x = 0.4 at z = 3 on its right, but x = 1.2 on both sides.
        let right = beyond(1.0, 2.0, sign);
        assert_eq!(right.part(), Part::Some);
        assert!(right.is_connected(&cell) && right.misses(&cell, across(0.4, 3.0)));
        assert!(!right.misses(&cell, across(1.2, 3.0)));
        // Edges that end at the left of it are out of their way.
        assert!(
            right.misses(&cell, [[0.2, 1.0, 2.0], [0.9, 1.0, 2.0]])
                && !right.misses(&cell, [[0.2, 1.0, 2.0], [1.1, 1.0, 2.0]])
        );
        // Where lines begin on an edge, they meet it, and another one across it.
        let begins = beyond(1.0, 0.0, sign);
        assert!(begins.part() == Part::Some && !begins.misses(&cell, [[0.5, 1.0, 0.0], [1.5, 1.0, 0.0]]));
        assert_eq!(beyond(-9.0, 2.0, sign).part(), Part::All);
        assert_eq!(beyond(-9.0, 2.0, -sign).part(), Part::None);
        assert!(beyond(1e-9, 0.0, sign).is_nearly_all() && !right.is_nearly_all());
    }

    #[test]
    fn lines_on_both_sides_of_a_cross_are_not_connected() {
        // Through the origin, which lies in both planes: lines with a of one sign and b of the other pass it on one side.
        let from = End::rectangle(&Aabb { min: [-1.0, 0.0, 0.0], max: [1.0, 0.0, 2.0] }, 1).expect("an area");
        let to = End::rectangle(&Aabb { min: [0.0, -1.0, 0.0], max: [0.0, 1.0, 2.0] }, 0).expect("an area");
        let cell = Cell { from, to };
        let side = |sign| Side::new(&cell, Limit { edge: [[0.0, 0.0, -1.0], [0.0, 0.0, 3.0]], sign });
        assert!(!side(1.0).is_connected(&cell) && !side(-1.0).is_connected(&cell));
        assert_eq!([side(1.0).part(), side(-1.0).part()], [Part::Some; 2]);
    }
}
