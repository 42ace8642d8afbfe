//! Which objects a cell sees: those that touch it, and those that a line from it reaches.

use super::Question;
use super::pairs::{CELL_BUDGET, GROUP_BUDGET, apart};
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
    /// Marks the objects that the cell at a place certainly sees, and those that it may see, once it is
    /// known which cells it sees.
    ///
    /// A line to an object ends in a cell that the object touches, so only objects that touch a visible
    /// cell, or a sliver behind it, may be seen; those that a visible cell lies in are.
    pub(super) fn survey_objects(&self, place: usize) {
        let own = self.cell_at[place] as usize;
        self.touching[own].iter().for_each(|&o| self.objects.set(o as usize, place));
        for other in self.cells.ones(place) {
            let cell = self.cell_at[other] as usize;
            for &object in &self.within_reach[cell] {
                let o = object as usize;
                if self.may_see_object(place, o) {
                    self.maybe.set(o, place);
                }
                if !self.objects.get(o, place) && within(&self.graph.cells()[cell].bounds, &self.boxes[o]) {
                    self.objects.set(o, place);
                }
            }
        }
    }

    /// Decides which cells see an object: groups of cells first, then their halves.
    pub(super) fn settle_object(&self, object: usize, shaft: &mut Shaft<'_>, stack: &mut Vec<u32>) {
        let target = &self.boxes[object];
        stack.clear();
        stack.push(0);
        while let Some(n) = stack.pop() {
            let node = &self.tree.nodes()[n as usize];
            let places = [node.start as usize, node.end as usize];
            let open = |p: &usize| self.maybe.get(object, *p) && !self.objects.get(object, *p);
            if !(places[0]..places[1]).any(|p| open(&p)) {
                continue;
            }
            // Groups that touch the object, or some cell of which sees it, are not hidden from it.
            let ask =
                node.is_leaf() || (apart(&node.bounds, target) && !self.objects.any([object, object + 1], places));
            if ask {
                let budget = if node.is_leaf() { CELL_BUDGET } else { GROUP_BUDGET };
                match shaft.decide(&node.bounds, target, Target::Surface, budget) {
                    Sight::Blocked => continue,
                    Sight::Open(line) => {
                        self.follow(&line, [&node.bounds, target]);
                        if node.is_leaf() {
                            self.objects.set(object, places[0]);
                        }
                    }
                    Sight::Undecided => {
                        if node.is_leaf() {
                            self.n_assumed.fetch_add(1, Relaxed);
                            self.objects.set(object, places[0]);
                        }
                    }
                }
            }
            if !node.is_leaf() {
                stack.extend(self.tree.children(n));
            }
        }
    }
}
