//! Opaque rectangles, found along lines.

use super::super::rows::{FORWARD, Line, Octant, Octants};
use super::ray::Ray;
use sightlines_geometry::{Aabb, BoxTree, OneWayRectangle};

/// Number of rectangles in a leaf of the tree.
const PER_LEAF: usize = 4;

/// Closed, opaque, axis-aligned rectangles.
#[derive(Debug, Clone)]
pub struct Blockers {
    rectangles: Vec<Aabb<3>>,
    /// The axis that each is perpendicular to.
    axes: Vec<u8>,
    /// The octants of the lines that each stops.
    stopped: Vec<Octants>,
    tree: BoxTree<3>,
    has_one_way: bool,
}

impl Blockers {
    /// Indexes rectangles: boxes that are flat along one axis, with accepted coordinates. Other boxes are dropped,
    /// which errs towards visible.
    ///
    /// O(n log² n).
    pub fn new(rectangles: impl IntoIterator<Item = Aabb<3>>) -> Self {
        Self::with_one_way(rectangles, [])
    }

    /// The same, with rectangles that hide from one side.
    pub fn with_one_way(
        rectangles: impl IntoIterator<Item = Aabb<3>>,
        one_way: impl IntoIterator<Item = OneWayRectangle>,
    ) -> Self {
        let flat = |b: &Aabb<3>| {
            let mut flat = (0u8..3).filter(|&k| b.min[usize::from(k)] == b.max[usize::from(k)]);
            flat.next().filter(|_| flat.next().is_none() && !b.is_empty())
        };
        let one_way = one_way.into_iter().map(|r| (r.bounds, Some(r.front_up)));
        let (mut all, mut axes, mut stopped) = (Vec::new(), Vec::new(), Vec::new());
        for (bounds, front_up) in rectangles.into_iter().map(|b| (b, None)).chain(one_way) {
            let Some(axis) = flat(&bounds) else { continue };
            let forward = FORWARD[usize::from(axis)];
            all.push(bounds);
            axes.push(axis);
            stopped.push(front_up.map_or(Octants::MAX, |up| if up { !forward } else { forward }));
        }
        let tree = BoxTree::build(&all, PER_LEAF);
        let has_one_way = stopped.iter().any(|octants| *octants != Octants::MAX);
        Self { rectangles: all, axes, stopped, tree, has_one_way }
    }

    /// Whether some rectangle hides from one side only. If not, lines are free in both directions or in none.
    pub const fn has_one_way(&self) -> bool {
        self.has_one_way
    }

    /// Whether a rectangle stops lines of an octant.
    #[inline(always)]
    pub(super) fn stops(&self, index: u32, octant: Octant) -> bool {
        self.stopped[index as usize] >> octant & 1 == 1
    }

    /// Number of rectangles.
    pub fn len(&self) -> usize {
        self.rectangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rectangles.is_empty()
    }

    /// All rectangles, by index.
    pub fn rectangles(&self) -> &[Aabb<3>] {
        &self.rectangles
    }

    /// A rectangle.
    ///
    /// # Panics
    /// If there is no such rectangle.
    pub fn rectangle(&self, index: u32) -> &Aabb<3> {
        &self.rectangles[index as usize]
    }

    /// The axis that a rectangle is perpendicular to.
    pub(super) fn axis(&self, index: u32) -> usize {
        usize::from(self.axes[index as usize])
    }

    /// Rectangles that stop lines of an octant, and that a ray may meet between two times; certainly all that it meets.
    #[inline]
    pub(super) fn near(&self, ray: &Ray, octant: Octant, times: [f64; 2], mut each: impl FnMut(u32)) {
        let may_meet = |b: &Aabb<3>| ray.may_meet(b, times);
        self.tree.visit(may_meet, |i| {
            if self.stops(i, octant) && may_meet(&self.rectangles[i as usize]) {
                each(i);
            }
        });
    }

    /// Rectangles that stop lines of an octant, and that a line of it may meet which a ray was rounded from, place and direction; certainly
    /// all that it meets. The ray's start was computed from `origin`.
    pub(super) fn near_rounded(&self, ray: &Ray, octant: Octant, origin: [f64; 3], mut each: impl FnMut(u32)) {
        let may_meet = |b: &Aabb<3>| ray.may_meet(&ray.widened(b, origin), [f64::NEG_INFINITY, f64::INFINITY]);
        self.tree.visit(may_meet, |i| {
            if self.stops(i, octant) && may_meet(&self.rectangles[i as usize]) {
                each(i);
            }
        });
    }

    /// Rectangles that stop lines of an octant, and that a ray seems to meet between two times; rounding may leave one out or let one in.
    #[inline]
    pub(super) fn met(&self, ray: &Ray, octant: Octant, times: [f64; 2], mut each: impl FnMut(u32)) {
        self.tree.visit(
            |b| ray.seems_to_meet(b, times),
            |i| {
                if self.stops(i, octant) && ray.seems_to_meet(&self.rectangles[i as usize], times) {
                    each(i);
                }
            },
        );
    }

    /// Whether a line in the octant misses the closed rectangle. Exact.
    pub(super) fn missed(&self, index: u32, line: &Line, octant: Octant) -> bool {
        line.misses(self.rectangle(index), self.axis(index), octant)
    }
}
