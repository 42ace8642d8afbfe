//! Which objects a cell sees: those that touch it, and those that a line from it reaches.

use super::Question;
use super::pairs::CELL_BUDGET;
use sightlines_geometry::Aabb;
use sightlines_sightline::{Shaft, Sight, Target};
use std::sync::atomic::Ordering::Relaxed;

/// Whether two closed boxes have a point in common.
pub(super) fn touch(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Whether a closed box lies in another.
fn within(inner: &Aabb<3>, outer: &Aabb<3>) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

impl Question<'_> {
    /// Decides which objects the cell at a place sees, once it is known which cells it sees.
    ///
    /// A line to an object ends in the cell where it reaches it, so only objects that touch a visible
    /// cell are asked about.
    pub(super) fn settle_objects(&self, place: usize, shaft: &mut Shaft<'_>, seen: &mut Vec<bool>) {
        let own = self.cell_at[place] as usize;
        let bounds = &self.graph.cells()[own].bounds;
        for &object in &self.touching[own] {
            self.objects.set(place, object as usize);
        }
        seen.clear();
        seen.resize(self.boxes.len(), false);
        for other in self.cells.ones(place) {
            let cell = self.cell_at[other] as usize;
            for &object in &self.touching[cell] {
                let reached = || within(&self.graph.cells()[cell].bounds, &self.boxes[object as usize]);
                let o = object as usize;
                if !std::mem::replace(&mut seen[o], true) && !self.objects.get(place, o) && reached() {
                    self.objects.set(place, o);
                }
            }
        }
        for o in (0..self.boxes.len()).filter(|&o| seen[o]) {
            if self.objects.get(place, o) || !self.may_see_object(place, o) {
                continue;
            }
            match shaft.decide(bounds, &self.boxes[o], Target::Surface, CELL_BUDGET) {
                Sight::Blocked => {}
                Sight::Open(line) => {
                    self.follow(&line, [bounds, &self.boxes[o]]);
                    self.objects.set(place, o);
                }
                Sight::Undecided => {
                    self.n_assumed.fetch_add(1, Relaxed);
                    self.objects.set(place, o);
                }
            }
        }
    }
}
