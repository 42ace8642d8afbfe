//! Which objects a cell sees: those that touch it, and those that a line from it reaches.

use super::AxialSearch;
use super::pairs::{CELL_BUDGET, FEW, GROUP_BUDGET, apart};
use super::witness_log::{FoundFor, WitnessLog, Worker};
use sightlines_geometry::Aabb;
use sightlines_progress::Allowance;
use sightlines_sightline::{BoxTarget, ShaftLine, Verdict};
use std::collections::VecDeque;
use std::sync::atomic::Ordering::Relaxed;

/// Whether two closed boxes have a point in common.
pub(super) fn touch(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Whether a closed box lies in another.
pub(super) fn within(inner: &Aabb<3>, outer: &Aabb<3>) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

impl AxialSearch<'_> {
    /// Marks the objects that the cell at a place certainly sees, and those that it may see, once its visible cells are
    /// known.
    ///
    /// A line to an object ends in a cell that the object touches, so only objects that touch a visible cell, or a
    /// sliver behind it, may be seen; those that contain a visible cell are.
    pub(super) fn survey_objects(&self, place: usize, mut log: Option<&mut WitnessLog>) {
        let own = self.cell_at[place] as usize;
        for &object in &self.touching[own] {
            self.objects.set(object as usize, place);
        }
        let mut lies_in = |cell: usize| {
            for &object in &self.around[cell] {
                if self.objects.set(object as usize, place) {
                    log.iter_mut().for_each(|log| log.inside.push([object, own as u32]));
                }
            }
        };
        if let Some(doubt) = self.doubt.as_ref().filter(|doubt| !doubt.rows[place]) {
            // For most places little has to be examined. Who keeps doubts has no limit.
            debug_assert!(self.left.is_none());
            self.inner
                .iter()
                .filter(|other| self.cells.get(place, **other))
                .for_each(|&o| lies_in(self.cell_at[o] as usize));
            for &(object, near) in doubt.near_new.iter().filter(|near| self.cells.get(place, near.1)) {
                debug_assert!(self.within_reach[self.cell_at[near] as usize].contains(&object));
                if self.may_see_object(place, object as usize) {
                    self.maybe.set(object as usize, place);
                }
            }
            return;
        }
        for other in self.cells.ones(place) {
            let cell = self.cell_at[other] as usize;
            // A pair that was left says nothing about objects around it; they are asked for themselves.
            if !self.is_left(place, other) {
                lies_in(cell);
            }
            for &object in &self.within_reach[cell] {
                if self.may_see_object(place, object as usize) {
                    self.maybe.set(object as usize, place);
                }
            }
        }
    }

    /// Decides which cells of some groups see an object: groups of cells first, then their halves. Returns the groups that `unit`, a part
    /// of `all`, was not enough for.
    pub(super) fn settle_object(
        &self,
        object: usize,
        worker: &mut Worker<'_>,
        nodes: Vec<u32>,
        unit: Allowance<'_>,
        all: Allowance<'_>,
    ) -> Vec<u32> {
        let (target, row) = (&self.boxes[object], [object, object + 1]);
        let (mut next, mut is_first) = (VecDeque::from(nodes), true);
        // With a limit the largest groups come first.
        let take = |next: &mut VecDeque<u32>| if unit.is_limited() { next.pop_front() } else { next.pop_back() };
        while let Some(n) = take(&mut next) {
            // As for pairs, turns come to an end.
            if unit.is_over() && (!is_first || all.is_over()) {
                next.push_front(n);
                break;
            }
            is_first = false;
            let node = &self.tree.nodes()[n as usize];
            let places = [node.start as usize, node.end as usize];
            if !self.maybe.any_beyond(&self.objects, row, places) {
                continue;
            }
            // Groups that touch the object, or have a cell that sees it, are not hidden from it.
            let worth_it = || self.doubt.is_none() || self.maybe.count_beyond(&self.objects, row, places, FEW) > FEW;
            let ask = node.is_leaf() || (apart(&node.bounds, target) && !self.objects.any(row, places) && worth_it());
            if ask {
                let budget = if node.is_leaf() { CELL_BUDGET } else { self.group_budget() };
                let found_for = if node.is_leaf() { FoundFor::Object([object, places[0]]) } else { FoundFor::Groups };
                match worker.shaft.decide(&node.bounds, target, BoxTarget::Surface, budget) {
                    Verdict::Hidden(()) => continue,
                    Verdict::Visible(ShaftLine::Free(line)) => {
                        self.follow(&line, [&node.bounds, target], found_for, worker);
                    }
                    Verdict::Visible(ShaftLine::Fine(_)) if node.is_leaf() => {
                        self.see_without_line([object, places[0]], worker);
                    }
                    Verdict::Visible(ShaftLine::Fine(_)) => {}
                    Verdict::Undecided(_) => {
                        if node.is_leaf() && self.is_object_hidden_in_groups(object, places[0], worker) {
                            continue;
                        }
                        if node.is_leaf() {
                            self.n_assumed.fetch_add(1, Relaxed);
                            self.see_without_line([object, places[0]], worker);
                        }
                    }
                }
            }
            if !node.is_leaf() {
                next.extend(self.tree.children(n));
            }
        }
        next.into()
    }

    /// Marks an object as seen from a cell, by place, where no line in doubles shows it.
    fn see_without_line(&self, [object, place]: [usize; 2], worker: &mut Worker<'_>) {
        self.objects.set(object, place);
        let pair = [object as u32, self.cell_at[place]];
        worker.log.iter_mut().for_each(|log| log.objects_without_line.push(pair));
    }

    /// For a search in which only some pairs are in doubt and so not all groups are tested: whether an object is hidden
    /// from a group that contains the cell at a place. A search over all pairs has tested these groups and never
    /// reached the cell.
    fn is_object_hidden_in_groups(&self, object: usize, place: usize, worker: &mut Worker<'_>) -> bool {
        if self.doubt.is_none() {
            return false;
        }
        let target = &self.boxes[object];
        let mut n = 0;
        loop {
            let node = &self.tree.nodes()[n as usize];
            if node.is_leaf() {
                return false;
            }
            let ask = apart(&node.bounds, target);
            if ask && worker.shaft.decide(&node.bounds, target, BoxTarget::Surface, GROUP_BUDGET).is_hidden() {
                return true;
            }
            let [low, high] = self.tree.children(n);
            n = if (place as u32) < self.tree.nodes()[low as usize].end { low } else { high };
        }
    }
}
