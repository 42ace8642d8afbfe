//! All lines from a box to a target, as cells of line space: coarse ones first, exact ones where these are not enough.
//!
//! Lines leave a box by up to three of its sides and enter another by up to three, so nine cells hold them, and no others. As many lines
//! cross two parallel planes: one behind the first box and one before the second. All that run from box to box cross these
//! within a rectangle each, and the cell from one rectangle to the other holds them with some others. Often one chain blocks even
//! that cell. Where none does, the parts of a root are tried instead of it, and its halves where it has no parts.

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
    /// Its part of all lines, roughly: halves have half of it.
    pub(crate) share: f64,
    /// Other roots that hold all lines in question, and fewer others; none for a cell without others.
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

    /// Roots that hold all lines of a root that are in question; none for a cell that has no others.
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
                let to = planes.crossed_at(&corners(&start), &corners(target), 1)?;
                let to = beyond(to, axis, start.min[axis], upward)?;
                Some(Root::new(from, End::rectangle(&to, planes.axis)?, exits))
            });
            of_sides.extend(roots.join(of_side, whole));
        }
        let whole = Planes::between(volume, target).and_then(|planes| {
            let [from, to] = [0, 1].map(|i| planes.crossed_at(&corners(volume), &corners(target), i));
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
            let from = End::rectangle(&planes.crossed_at(&corners(volume), &triangle, 0)?, planes.axis)?;
            Some(Root::new(from, End::triangle(triangle), start_at(volume, planes.axis, planes.upward)))
        });
        let first = roots.join(of_sides, whole);
        roots.finish(&first)
    }
}

/// Two planes across an axis with nothing of two boxes between them.
#[derive(Debug, Clone, Copy)]
struct Planes {
    axis: usize,
    /// Whether the second box lies above the first along the axis.
    upward: bool,
    /// That of the first box, and that of the second.
    at: [f64; 2],
}

impl Planes {
    /// Those across the axis along which the boxes' middles are farthest apart, of those that have some.
    fn between(volume: &Aabb<3>, target: &Aabb<3>) -> Option<Self> {
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

    /// A rectangle on one of the planes that is crossed by every line from a point of the hull of some points to a point of that of
    /// others, on either side of the planes. What has to be rounded is rounded outwards.
    ///
    /// From one point the other hull is projected onto the plane, which makes a hull of the projected corners; so corners of both are enough.
    fn crossed_at(&self, from: &[Point3], to: &[Point3], plane: usize) -> Option<Aabb<3>> {
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
                    let (x, error) = if a[j] == b[j] { (a[j], 0.0) } else { (a[j] + (b[j] - a[j]) * t, crossing_error(a[j], b[j])) };
                    (low[j], high[j]) = (x - error, x + error);
                }
                crossed = crossed.with(low).with(high);
            }
        }
        crossed.min.iter().chain(&crossed.max).all(|&x| check_coordinate(x).is_ok()).then_some(crossed)
    }
}

fn corners(b: &Aabb<3>) -> [Point3; 8] {
    std::array::from_fn(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] }))
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

fn start_at(volume: &Aabb<3>, axis: usize, upward: bool) -> Start {
    Start { axis, upward, from_behind: volume.min[axis] < volume.max[axis] }
}

/// The part of a rectangle beyond a plane across an axis.
fn beyond(mut side: Aabb<3>, axis: usize, at: f64, upward: bool) -> Option<Aabb<3>> {
    if upward {
        side.min[axis] = side.min[axis].max(at);
    } else {
        side.max[axis] = side.max[axis].min(at);
    }
    let inside = if upward { side.max[axis] > at } else { side.min[axis] < at };
    inside.then_some(side)
}
