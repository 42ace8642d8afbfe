//! Opaque rectangles, found along lines.

use super::super::rows::{Line, Octant};
use super::ray::Ray;
use sightlines_geometry::{Aabb, BoxTree};

/// Number of rectangles in a leaf of the tree.
const PER_LEAF: usize = 4;

/// Closed, opaque, axis-aligned rectangles.
#[derive(Debug, Clone)]
pub struct Blockers {
    rectangles: Vec<Aabb<3>>,
    /// The axis that each is perpendicular to.
    axes: Vec<u8>,
    tree: BoxTree<3>,
}

impl Blockers {
    /// Indexes rectangles: boxes that are flat along one axis, with accepted coordinates. Other boxes are dropped,
    /// which errs towards visible.
    ///
    /// O(n log² n).
    pub fn new(rectangles: impl IntoIterator<Item = Aabb<3>>) -> Self {
        let flat = |b: &Aabb<3>| {
            let mut flat = (0u8..3).filter(|&k| b.min[usize::from(k)] == b.max[usize::from(k)]);
            flat.next().filter(|_| flat.next().is_none() && !b.is_empty())
        };
        let (rectangles, axes): (Vec<_>, Vec<_>) = rectangles.into_iter().filter_map(|b| Some((b, flat(&b)?))).unzip();
        let tree = BoxTree::build(&rectangles, PER_LEAF);
        Self { rectangles, axes, tree }
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

    /// Rectangles that a ray may meet between two times; certainly all that it meets.
    #[inline]
    pub(super) fn near(&self, ray: &Ray, times: [f64; 2], mut each: impl FnMut(u32)) {
        let may_meet = |b: &Aabb<3>| ray.may_meet(b, times);
        self.tree.visit(may_meet, |i| {
            if may_meet(&self.rectangles[i as usize]) {
                each(i);
            }
        });
    }

    /// Rectangles that a line may meet which a ray was rounded from, place and direction; certainly all that it meets. The ray's start was
    /// computed from `origin`.
    pub(super) fn near_rounded(&self, ray: &Ray, origin: [f64; 3], mut each: impl FnMut(u32)) {
        let may_meet = |b: &Aabb<3>| ray.may_meet(&ray.widened(b, origin), [f64::NEG_INFINITY, f64::INFINITY]);
        self.tree.visit(may_meet, |i| {
            if may_meet(&self.rectangles[i as usize]) {
                each(i);
            }
        });
    }

    /// Rectangles that a ray seems to meet between two times; rounding may leave one out or let one in.
    #[inline]
    pub(super) fn met(&self, ray: &Ray, times: [f64; 2], mut each: impl FnMut(u32)) {
        self.tree.visit(
            |b| ray.seems_to_meet(b, times),
            |i| {
                if ray.seems_to_meet(&self.rectangles[i as usize], times) {
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
