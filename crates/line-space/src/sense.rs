//! Triangles that block lines from their front to their back only, in chains.
//!
//! A line that leaves a volume is blocked by such a triangle wherever it crosses it, if no point of the volume is behind the triangle: it can come
//! from the front only. All others have a direction, and so has a chain with one of them:
//! 1. Each triangle of the chain gets a sense, 1 or -1. Those with a direction have 1; others what fits.
//! 2. At no edge that a line in question may meet does the chain end, counted with signs: one triangle goes around its corners from the lower to
//!    the higher end of the edge for each that goes the other way, with the triangles of sense -1 turned round.
//! 3. One line in question crosses the chain more often in its direction (from the front of a triangle of sense 1, or from the back of
//!    one of sense -1) than against it.
//!
//! Then every line in question does: as the lines are moved into each other, the difference stays the same, for a surface has the same
//! number of intersections, with signs, with all lines that do not meet its border. So every line crosses a triangle in its direction.
//! It is blocked there: by a triangle with a direction as it comes from the front; by others because they block whatever crosses them. Those
//! that no point of the volume is behind are never crossed from the back, so that one of sense -1 is never crossed in its direction.

use crate::marks::Marks;
use crate::surface::Surface;
use sightlines_geometry::Aabb;

/// What triangles do to lines from a volume.
#[derive(Debug)]
pub(crate) struct Sense {
    volume: Aabb<3>,
    /// For triangles that block from their front whether they block all lines from the volume.
    always: Marks<bool>,
}

impl Sense {
    pub(crate) fn new(surface: &Surface) -> Self {
        let n = if surface.has_fronts() { surface.mesh().triangles().len() } else { 0 };
        Self { volume: Aabb::EMPTY, always: Marks::new(n) }
    }

    /// Has to come before questions about lines from another volume.
    pub(crate) fn look_from(&mut self, volume: &Aabb<3>) {
        self.volume = *volume;
        self.always.forget();
    }

    /// Whether a triangle blocks every line from the volume that crosses it.
    pub(crate) fn blocks_always(&mut self, surface: &Surface, triangle: u32) -> bool {
        if !surface.is_front_only(triangle) {
            return true;
        }
        let known = self.always.get(triangle);
        known.unwrap_or_else(|| {
            let always = surface.is_in_front(triangle, &self.volume);
            self.always.set(triangle, always);
            always
        })
    }
}
