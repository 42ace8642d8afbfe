//! Which pairs have to be decided again.

use super::super::SLIVER;
use super::super::atomic_bits::AtomicBitMatrix;
use super::super::objects::touch;
use super::super::pairs::{CELL_BUDGET, GROUP_BUDGET, apart};
use super::super::witness_log::Worker;
use super::super::{AxialSearch, PairsInDoubt};
use super::LiveAxial;
use super::matching::Matching;
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::BoxTarget;
use std::cell::Cell;

impl PairsInDoubt {
    pub(super) fn none(n_places: usize, n_objects: usize) -> Self {
        let [cells, objects] = [n_places, n_objects].map(|n_rows| AtomicBitMatrix::new(n_rows, n_places));
        Self { cells, objects, rows: vec![false; n_places], near_new: Vec::new() }
    }

    /// Marks that it is unknown whether two places see each other.
    pub(super) fn pair(&self, a: usize, b: usize) {
        self.cells.set(a, b);
        self.cells.set(b, a);
    }

    /// Marks that it is unknown whether a place sees an object.
    pub(super) fn object(&mut self, object: u32, place: usize) {
        self.objects.set(object as usize, place);
        self.rows[place] = true;
    }

    /// Marks that it is unknown which places see a new object. O(places).
    pub(super) fn new_object(&mut self, object: u32, search: &AxialSearch<'_>) {
        for (place, &cell) in search.cell_at.iter().enumerate() {
            self.objects.set(object as usize, place);
            if search.within_reach[cell as usize].binary_search(&object).is_ok() {
                self.near_new.push((object, place));
            }
        }
    }

    /// Marks what may have become visible through a removed wall: pairs that see or touch it, from either side, and
    /// objects near such cells.
    ///
    /// If an open set of lines joins a pair that was hidden, each of them met a wall that has been removed; as the
    /// rectangles are few and closed, an open set of them meets the same one.
    pub(super) fn through(&mut self, opened: &Aabb<3>, seers: &[usize], search: &AxialSearch<'_>) {
        let axis = (0..3).find(|&k| opened.min[k] == opened.max[k]).unwrap_or(0);
        let bounds = |place: &usize| &search.graph.cells()[search.cell_at[*place] as usize].bounds;
        let low: Vec<usize> = seers.iter().copied().filter(|p| bounds(p).min[axis] < opened.max[axis]).collect();
        let high: Vec<usize> = seers.iter().copied().filter(|p| bounds(p).max[axis] > opened.min[axis]).collect();
        for &a in &low {
            high.iter().filter(|b| **b != a).for_each(|&b| self.pair(a, b));
        }
        let near = |seers: &[usize]| {
            let cells = seers.iter().map(|&place| search.cell_at[place] as usize);
            let mut near: Vec<u32> = cells.flat_map(|cell| search.within_reach[cell].iter().copied()).collect();
            near.sort_unstable();
            near.dedup();
            near
        };
        // A line to an object continues on the other side; slivers, which are thin, are on both.
        let has_slivers = search.regular.len() < search.graph.n_cells();
        let sides = if has_slivers { vec![(seers, seers)] } else { vec![(&low[..], &high[..]), (&high, &low)] };
        for (from, to) in sides {
            let near = near(to);
            for &place in from {
                near.iter().for_each(|&object| self.object(object, place));
            }
        }
    }

    /// Marks what new cells may see: at most what the old cells that they overlap saw, what is visible through removed
    /// walls, and what, like themselves, lies where no cells were.
    ///
    /// A line between two cells that meets no removed wall never crosses the border of the old cells.
    pub(super) fn new_cells(
        &mut self,
        search: &AxialSearch<'_>,
        old: &LiveAxial,
        cells: &Matching,
        heirs: &[Vec<u32>],
    ) {
        let is_new = |place: &usize| cells.old_of[search.cell_at[*place] as usize].is_none();
        let new: Vec<usize> = (0..search.cell_at.len()).filter(is_new).collect();
        if new.is_empty() {
            return;
        }
        let extents: Vec<Aabb<3>> = old.graph.cells().iter().map(|c| c.bounds).collect();
        let tree = BoxTree::build(&extents, 2);
        let mut new_in: Vec<Vec<usize>> = vec![Vec::new(); extents.len()];
        let overlapped = new.iter().map(|&place| {
            let bounds = &search.graph.cells()[search.cell_at[place] as usize].bounds;
            let mut found = Vec::new();
            tree.visit(|b| !apart(b, bounds), |i| found.extend((!apart(&extents[i as usize], bounds)).then_some(i)));
            found.iter().for_each(|&i| new_in[i as usize].push(place));
            found
        });
        let overlapped: Vec<Vec<u32>> = overlapped.collect();
        let mut seen = BitMatrix::new(1, extents.len());
        let mut seen_objects = BitMatrix::new(1, old.objects.len());
        let mut uncovered = Vec::new();
        for (&place, overlapped) in new.iter().zip(&overlapped) {
            seen.row_mut(0).fill(0);
            seen_objects.row_mut(0).fill(0);
            for &cell in overlapped {
                or(seen.row_mut(0), old.seen.cells.row(cell as usize));
                or(seen_objects.row_mut(0), old.seen.objects.row(cell as usize));
            }
            for other in seen.iter_ones(0) {
                match cells.new_of[other] {
                    Some(same) => self.pair(place, search.place[same as usize] as usize),
                    None => new_in[other].iter().filter(|p| **p != place).for_each(|&p| self.pair(place, p)),
                }
            }
            let bounds = &search.graph.cells()[search.cell_at[place] as usize].bounds;
            if is_covered(*bounds, overlapped, &extents) {
                for object in seen_objects.iter_ones(0) {
                    heirs[object].iter().for_each(|&same| self.object(same, place));
                }
            } else {
                uncovered.iter().for_each(|&other| self.pair(place, other));
                uncovered.push(place);
                (0..search.boxes.len() as u32).for_each(|object| self.object(object, place));
            }
        }
    }
}

/// The places that may see or touch an opened rectangle, as one row: new cells, and those that saw a cell that touches
/// one.
///
/// A line from an old cell to such a rectangle meets a first one; up to there nothing has changed, so it arrives
/// through a cell that the old one saw.
pub(super) fn candidates(
    search: &AxialSearch<'_>,
    old: &LiveAxial,
    cells: &Matching,
    opened: &[Aabb<3>],
) -> AtomicBitMatrix {
    let found = AtomicBitMatrix::new(1, search.cell_at.len());
    let mut near = BitMatrix::new(1, old.graph.n_cells());
    let tree = BoxTree::build(opened, 1);
    for (cell, extent) in old.graph.cells().iter().enumerate() {
        let met = Cell::new(false);
        tree.visit(|b| !met.get() && touch(b, &extent.bounds), |_| met.set(true));
        if met.get() {
            or(near.row_mut(0), old.seen.cells.row(cell));
        }
    }
    for (place, &cell) in search.cell_at.iter().enumerate() {
        if cells.old_of[cell as usize].is_none_or(|old| near.get(0, old as usize)) {
            found.set(0, place);
        }
    }
    found
}

fn or(into: &mut [u64], from: &[u64]) {
    into.iter_mut().zip(from).for_each(|(a, b)| *a |= b);
}

/// Whether some of the cells cover a box. Exact.
fn is_covered(bounds: Aabb<3>, cells: &[u32], extents: &[Aabb<3>]) -> bool {
    let mut open = vec![bounds];
    for &cell in cells {
        let cell = &extents[cell as usize];
        let mut left = Vec::new();
        for mut part in open {
            if apart(&part, cell) {
                left.push(part);
                continue;
            }
            for k in 0..3 {
                if part.min[k] < cell.min[k] {
                    let mut beside = part;
                    beside.max[k] = cell.min[k];
                    left.push(beside);
                    part.min[k] = cell.min[k];
                }
                if part.max[k] > cell.max[k] {
                    let mut beside = part;
                    beside.min[k] = cell.max[k];
                    left.push(beside);
                    part.max[k] = cell.max[k];
                }
            }
        }
        open = left;
    }
    open.is_empty()
}

impl AxialSearch<'_> {
    /// The places of those candidates that see or touch a flat box; perhaps some more.
    pub(super) fn seers(&self, target: &Aabb<3>, candidates: &AtomicBitMatrix, worker: &mut Worker<'_>) -> Vec<usize> {
        let mut found = Vec::new();
        let mut stack = vec![0];
        while let Some(n) = stack.pop() {
            let node = &self.tree.nodes()[n as usize];
            if !candidates.any([0, 1], [node.start as usize, node.end as usize]) {
                continue;
            }
            let budget = if node.is_leaf() { CELL_BUDGET } else { GROUP_BUDGET };
            let sees = touch(&node.bounds, target)
                || worker.shaft.decide(&node.bounds, target, BoxTarget::Surface, budget).may_be_visible();
            match (sees, node.is_leaf()) {
                (false, _) => {}
                (true, true) => found.push(node.start as usize),
                (true, false) => stack.extend(self.tree.children(n)),
            }
        }
        found.sort_unstable();
        found
    }

    /// The place of a cell that is not a sliver.
    pub(super) fn place_of(&self, cell: u32) -> Option<usize> {
        Some(self.place[cell as usize]).filter(|p| *p != SLIVER).map(|p| p as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_what_they_cover() {
        let cell = |min: [f64; 3], max: [f64; 3]| Aabb { min, max };
        let halves = [cell([0.0; 3], [1.0, 2.0, 2.0]), cell([1.0, 0.0, 0.0], [2.0; 3])];
        let whole = cell([0.0; 3], [2.0; 3]);
        assert!(is_covered(whole, &[0, 1], &halves) && !is_covered(whole, &[0], &halves));
        assert!(is_covered(cell([0.5, 0.5, 0.5], [1.0, 1.0, 1.0]), &[0], &halves));
        let beyond = cell([0.0; 3], [2.0, 2.0, 2f64.next_up()]);
        assert!(!is_covered(beyond, &[0, 1], &halves));
    }
}
