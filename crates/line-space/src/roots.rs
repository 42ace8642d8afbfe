//! All lines from a box to a target, as cells of line space: coarse ones first, exact ones where these are not enough.
//!
//! A line may leave a box by any of its sides that faces the target, and enter the target by any side that faces the box: mostly three
//! each. The nine cells for these pairs of sides hold all lines, and no others. If the two boxes are apart along an axis, all lines also
//! cross two planes across that axis: one through the side of the first box that faces the second, one through the side of the second
//! that faces the first. The lines cross each plane within a rectangle, and one cell, from rectangle to rectangle, holds all of them, and
//! some others. Often one chain blocks that whole cell. If none does, the parts of the root take its place; a root without parts is cut
//! in halves.

use crate::cell::Cell;
use crate::end::{End, crossing_error};
use crate::side::Limit;
use crate::touch::Start;
use sightlines_geometry::{Aabb, Point3, check_coordinate};

/// A cell that waits, and where its lines begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Root {
    pub(crate) cell: Cell,
    pub(crate) start: Start,
    /// The side of an edge on which the lines in question pass, if not all are left.
    pub(crate) limit: Option<Limit>,
    /// The share of all lines that it holds, roughly; each half of a cell has half of it.
    pub(crate) share: f64,
    /// More exact roots that together hold the same lines in question; none if it holds no others.
    pub(crate) parts: Parts,
}

impl Root {
    fn new(from: End, to: End, start: Start) -> Self {
        Self { cell: Cell { from, to }, start, limit: None, share: 0.0, parts: Parts::default() }
    }
}

/// Some of [`Roots`], one after the other.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Parts {
    first: usize,
    n: usize,
}

/// All lines from a box to a target.
#[derive(Debug, Default)]
pub(crate) struct Roots {
    all: Vec<Root>,
    whole: Parts,
}

impl Roots {
    /// Roots that hold all lines.
    pub(crate) fn whole(&self) -> &[Root] {
        self.of(self.whole)
    }

    /// The parts of a root: more exact roots that together hold its lines in question; none if it holds no others.
    pub(crate) fn parts(&self, root: &Root) -> &[Root] {
        self.of(root.parts)
    }

    fn of(&self, parts: Parts) -> &[Root] {
        &self.all[parts.first..parts.first + parts.n]
    }

    fn add(&mut self, roots: &[Root]) -> Parts {
        let parts = Parts { first: self.all.len(), n: roots.len() };
        self.all.extend_from_slice(roots);
        parts
    }

    /// Replaces several roots by one that holds them, if there is one.
    fn join(&mut self, roots: Vec<Root>, whole: Option<Root>) -> Vec<Root> {
        match whole.filter(|_| roots.len() > 1) {
            Some(whole) => vec![Root { parts: self.add(&roots), ..whole }],
            None => roots,
        }
    }

    fn finish(mut self, roots: &[Root]) -> Self {
        self.whole = self.add(roots);
        self
    }

    /// All lines from a box to another: for each side by which they leave the one and each by which they enter the other.
    ///
    /// Lines that leave or enter through an edge, or run within a side, are limits of these.
    pub(crate) fn to_box(volume: &Aabb<3>, target: &Aabb<3>) -> Self {
        let mut roots = Self::default();
        let mut of_sides = Vec::new();
        for (axis, upward, start) in sides(volume) {
            let exits = start_at(volume, axis, upward);
            let mut of_side = Vec::new();
            for (across, outward, end) in sides(target) {
                let to = beyond(end, axis, start.min[axis], upward);
                let from = beyond(start, across, end.min[across], outward);
                let ends = from.zip(to).and_then(|(f, t)| End::rectangle(&f, axis).zip(End::rectangle(&t, across)));
                of_side.extend(ends.map(|(from, to)| Root::new(from, to, exits)));
            }
            let whole = End::rectangle(&start, axis).and_then(|from| {
                let planes = Planes::between(&start, target)?;
                let to = planes.crossed_at(&start.corners(), &target.corners(), 1)?;
                let to = beyond(to, axis, start.min[axis], upward)?;
                Some(Root::new(from, End::rectangle(&to, planes.axis)?, exits))
            });
            of_sides.extend(roots.join(of_side, whole));
        }
        let whole = Planes::between(volume, target).and_then(|planes| {
            let [from, to] = [0, 1].map(|i| planes.crossed_at(&volume.corners(), &target.corners(), i));
            let ends = End::rectangle(&from?, planes.axis).zip(End::rectangle(&to?, planes.axis));
            ends.map(|(from, to)| Root::new(from, to, start_at(volume, planes.axis, planes.upward)))
        });
        let first = roots.join(of_sides, whole);
        roots.finish(&first)
    }

    /// All lines from a box to a triangle beside it.
    pub(crate) fn to_triangle(volume: &Aabb<3>, triangle: [Point3; 3]) -> Self {
        let mut roots = Self::default();
        let mut of_sides = Vec::new();
        for (axis, upward, start) in sides(volume) {
            let Some(from) = End::rectangle(&start, axis) else { continue };
            let pieces = End::beyond(triangle, axis, start.min[axis], upward);
            of_sides.extend(pieces.map(|to| Root::new(from, to, start_at(volume, axis, upward))));
        }
        let whole = Planes::between(volume, &Aabb::around(triangle)).and_then(|planes| {
            let from = End::rectangle(&planes.crossed_at(&volume.corners(), &triangle, 0)?, planes.axis)?;
            Some(Root::new(from, End::triangle(triangle), start_at(volume, planes.axis, planes.upward)))
        });
        let first = roots.join(of_sides, whole);
        roots.finish(&first)
    }
}

/// Two planes across an axis with nothing of two boxes between them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planes {
    pub(crate) axis: usize,
    /// Whether the second box lies above the first along the axis.
    upward: bool,
    /// That of the first box, and that of the second.
    at: [f64; 2],
}

impl Planes {
    /// Of the axes along which the boxes are apart, the one along which their middles are farthest from each other; none if there is none.
    pub(crate) fn between(volume: &Aabb<3>, target: &Aabb<3>) -> Option<Self> {
        let between = |axis: usize| {
            let [low, high] = [volume.min[axis] - target.max[axis], target.min[axis] - volume.max[axis]];
            if high > 0.0 {
                Some(Self { axis, upward: true, at: [volume.max[axis], target.min[axis]] })
            } else if low > 0.0 {
                Some(Self { axis, upward: false, at: [volume.min[axis], target.max[axis]] })
            } else {
                None
            }
        };
        let apart = |axis: usize| (volume.min[axis] + volume.max[axis] - target.min[axis] - target.max[axis]).abs();
        (0..3).filter_map(between).max_by(|p, q| apart(p.axis).total_cmp(&apart(q.axis)))
    }

    /// The rectangle on a plane, 0 or 1, within which every segment from the convex hull of `from` to that of `to` crosses it. Rounded outwards;
    /// none if its coordinates are out of range.
    ///
    /// Seen from one point, the projection of a convex hull onto the plane is the hull of the projected corners. So segments between corners are
    /// enough.
    pub(crate) fn crossed_at(&self, from: &[Point3], to: &[Point3], plane: usize) -> Option<Aabb<3>> {
        let (k, at) = (self.axis, self.at[plane]);
        let mut crossed = Aabb::EMPTY;
        for a in from {
            for b in to {
                if a[k] == at || b[k] == at {
                    crossed = crossed.with(if a[k] == at { *a } else { *b });
                    continue;
                }
                let t = (at - a[k]) / (b[k] - a[k]);
                let (mut low, mut high) = ([at; 3], [at; 3]);
                for j in (0..3).filter(|&j| j != k) {
                    let (x, error) =
                        if a[j] == b[j] { (a[j], 0.0) } else { (a[j] + (b[j] - a[j]) * t, crossing_error(a[j], b[j])) };
                    (low[j], high[j]) = (x - error, x + error);
                }
                crossed = crossed.with(low).with(high);
            }
        }
        crossed.min.iter().chain(&crossed.max).all(|&x| check_coordinate(x).is_ok()).then_some(crossed)
    }
}

/// The sides of a box: axis, whether it is the upper one, and the rectangle.
fn sides(b: &Aabb<3>) -> impl Iterator<Item = (usize, bool, Aabb<3>)> + '_ {
    (0..6).map(|i| {
        let (axis, upper) = (i / 2, i % 2 == 1);
        let mut side = *b;
        let at = if upper { b.max[axis] } else { b.min[axis] };
        (side.min[axis], side.max[axis]) = (at, at);
        (axis, upper, side)
    })
}

pub(crate) fn start_at(volume: &Aabb<3>, axis: usize, upward: bool) -> Start {
    Start { axis, upward, from_behind: volume.min[axis] < volume.max[axis] }
}

/// The part of a rectangle beyond a plane across an axis.
pub(crate) fn beyond(mut side: Aabb<3>, axis: usize, at: f64, upward: bool) -> Option<Aabb<3>> {
    if upward {
        side.min[axis] = side.min[axis].max(at);
    } else {
        side.max[axis] = side.max[axis].min(at);
    }
    let inside = if upward { side.max[axis] > at } else { side.min[axis] < at };
    inside.then_some(side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::{Exact, exact, mix};
    use num_rational::BigRational;
    use proptest::prelude::*;
    use proptest::test_runner::TestRunner;
    use std::cell::Cell as Count;

    fn point() -> impl Strategy<Value = Point3> {
        [-6i32..7, -6i32..7, -6i32..7].prop_map(|p| p.map(|x| f64::from(x) * 0.3))
    }

    /// A box, flat along some axes perhaps.
    fn block() -> impl Strategy<Value = Aabb<3>> {
        (point(), [0i32..4, 0i32..4, 0i32..4]).prop_map(|(min, size)| {
            let max = [0, 1, 2].map(|k| min[k] + f64::from(size[k]) * 0.7);
            Aabb { min, max }
        })
    }

    /// A point of a box, at parts of eighths.
    fn at(b: &Aabb<3>, parts: [i64; 3]) -> Exact {
        let [low, high] = [exact(b.min), exact(b.max)];
        [0, 1, 2].map(|k| &low[k] + (&high[k] - &low[k]) * BigRational::new(parts[k].into(), 8.into()))
    }

    /// Whether a segment meets the box around an end, which is a rectangle.
    fn crosses(b: &Aabb<3>, axis: usize, eye: &Exact, point: &Exact) -> bool {
        let plane = exact(b.min)[axis].clone();
        let rise = &point[axis] - &eye[axis];
        let t = (&plane - &eye[axis]) / rise;
        let zero = BigRational::from_integer(0.into());
        let one = BigRational::from_integer(1.into());
        let [low, high] = [exact(b.min), exact(b.max)];
        let within = |k: usize| {
            let x = &eye[k] + (&point[k] - &eye[k]) * &t;
            low[k] <= x && x <= high[k]
        };
        t >= zero && t <= one && (0..3).all(|k| k == axis || within(k))
    }

    fn flat_axis(end: &End) -> usize {
        let b = end.bounds();
        (0..3).find(|&k| b.min[k] == b.max[k]).expect("it is a rectangle")
    }

    /// How many roots at the bottom hold a segment; a root that holds it has to have a part that does.
    fn n_holding(roots: &Roots, some: &[Root], eye: &Exact, point: &Exact) -> usize {
        let holds = |root: &Root| {
            [&root.cell.from, &root.cell.to].into_iter().all(|end| crosses(end.bounds(), flat_axis(end), eye, point))
        };
        let of = |root: &Root| match roots.parts(root) {
            [] => 1,
            parts => {
                let n = n_holding(roots, parts, eye, point);
                assert!(n > 0, "none of the parts of {root:?}");
                n
            }
        };
        some.iter().filter(|root| holds(root)).map(of).sum()
    }

    /// Invariant: every segment from a point of one box to a point inside of the other is held by a root, by a part of that, and so on.
    #[test]
    fn every_line_is_held_by_a_root_and_by_its_parts() {
        let (joined, split) = (Count::new(0), Count::new(0));
        let parts = || [0i64..9, 0i64..9, 0i64..9];
        let inner = || [1i64..8, 1i64..8, 1i64..8];
        let shift = prop_oneof![Just(0.0), Just(1e6 / 3.0)];
        let strategy = (block(), block(), parts(), inner(), shift);
        let check = |(volume, target, from, to, shift): (Aabb<3>, Aabb<3>, [i64; 3], [i64; 3], f64)| {
            let moved = |b: Aabb<3>| Aabb { min: b.min.map(|x| x + shift), max: b.max.map(|x| x + shift) };
            let (volume, target) = (moved(volume), moved(target));
            let flat = |b: &Aabb<3>| (0..3).filter(|&k| b.min[k] == b.max[k]).count();
            let meet = (0..3).all(|k| volume.min[k] <= target.max[k] && target.min[k] <= volume.max[k]);
            prop_assume!(!meet && flat(&volume) < 2 && flat(&target) < 2);
            let (eye, point) = (at(&volume, from), at(&target, to));
            // Lines along an axis may run within sides; they are limits of others.
            prop_assume!((0..3).all(|k| eye[k] != point[k]));
            let roots = Roots::to_box(&volume, &target);
            prop_assert!(n_holding(&roots, roots.whole(), &eye, &point) > 0, "{:?} {:?}", volume, target);
            let n = if roots.parts(&roots.whole()[0]).is_empty() { &split } else { &joined };
            n.set(n.get() + 1);
            Ok(())
        };
        TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })
            .run(&strategy, check)
            .expect("the invariant holds");
        assert!(joined.get() > 50, "{} joined, {} not", joined.get(), split.get());
    }

    proptest! {
        /// Invariant: every segment from a point of a box to a point of a triangle apart from it along an axis begins within its one root, and
        /// within a part of that which has the point, or whose rounded corners may.
        #[test]
        fn every_line_to_a_triangle_is_held_by_the_first_root_and_by_a_part(
            volume in block(), triangle in [point(), point(), point()], away in 0usize..3, parts in [0i64..9, 0i64..9, 0i64..9],
            weights in [1u64..9, 1u64..9, 1u64..9],
        ) {
            let triangle = triangle.map(|p| { let mut p = p; p[away] += 7.0; p });
            prop_assume!((0..3).filter(|&k| volume.min[k] == volume.max[k]).count() < 2);
            let roots = Roots::to_triangle(&volume, triangle);
            let (eye, point) = (at(&volume, parts), mix(&triangle.map(exact), &weights));
            prop_assume!(volume.max[away] < 5.0 && (0..3).all(|k| eye[k] != point[k]));
            let begins = |root: &Root| crosses(root.cell.from.bounds(), flat_axis(&root.cell.from), &eye, &point);
            let around = |b: &Aabb<3>| (0..3).all(|k| exact(b.min)[k] <= point[k] && point[k] <= exact(b.max)[k]);
            let parts = match roots.whole() {
                [whole] if !roots.parts(whole).is_empty() => {
                    prop_assert!(begins(whole));
                    roots.parts(whole)
                }
                several => several,
            };
            prop_assert!(parts.iter().any(|part| begins(part) && around(part.cell.to.bounds())));
        }
    }

    #[test]
    fn boxes_apart_have_one_root_that_is_hardly_larger() {
        let volume = Aabb { min: [0.0; 3], max: [1.0; 3] };
        let target = Aabb { min: [9.0, 9.0, 20.0], max: [10.0, 10.0, 21.0] };
        let roots = Roots::to_box(&volume, &target);
        let [whole] = roots.whole() else { panic!("{:?}", roots.whole()) };
        assert_eq!((whole.start.axis, whole.start.upward), (2, true));
        let size = |b: &Aabb<3>| [0, 1].map(|k| b.max[k] - b.min[k]);
        // What is one long is seen at a slope of half: half of its depth comes to it.
        for end in [&whole.cell.from, &whole.cell.to] {
            assert!(size(end.bounds()).iter().all(|&x| x > 1.4 && x < 1.6), "{end:?}");
        }
        assert_eq!(roots.parts(whole).len(), 3);
        assert!(roots.parts(whole).iter().all(|part| roots.parts(part).len() == 3));
        let triangle = [[9.0, 9.0, 20.0], [10.0, 9.0, 20.0], [9.0, 10.0, 21.0]];
        let roots = Roots::to_triangle(&volume, triangle);
        assert!(roots.whole().len() == 1 && roots.parts(&roots.whole()[0]).len() == 3);
        assert_eq!(roots.whole()[0].cell.to, End::triangle(triangle));
    }

    /// The impostor: the sides of the boxes alone do not hold all lines.
    #[test]
    fn impostor_sides_alone_are_caught() {
        let volume = Aabb { min: [0.0; 3], max: [1.0; 3] };
        let target = Aabb { min: [9.0, 9.0, 20.0], max: [10.0, 10.0, 21.0] };
        let roots = Roots::to_box(&volume, &target);
        let (eye, point) = (at(&volume, [7, 7, 1]), at(&target, [4, 4, 4]));
        let whole = &roots.whole()[0].cell.from;
        assert!(crosses(whole.bounds(), 2, &eye, &point));
        assert!(!crosses(&Aabb { min: [0.0, 0.0, 1.0], max: [1.0; 3] }, 2, &eye, &point));
    }
}
