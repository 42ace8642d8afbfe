//! Which volumes are registered in which cells.

use sightlines_pvs::CellId;

/// An entry of a slot: the cell, and its index in the list of that cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Entry {
    cell: u32,
    place: u32,
}

/// For each cell the slots whose volumes touch it, and the cells with such slots. Entering and leaving are O(1) for
/// each cell; other cells cost nothing.
#[derive(Debug, Clone, Default)]
pub(super) struct Lists {
    /// By cell: slots, and which of their entries this is.
    by_cell: Vec<Vec<(u32, u32)>>,
    by_slot: Vec<Vec<Entry>>,
    /// The cells with entries.
    occupied: Vec<u32>,
    /// By cell: its position in `occupied`.
    place_of: Vec<u32>,
    n_entries: usize,
}

impl Lists {
    /// Empty lists for `n_cells` cells.
    pub(super) fn new(n_cells: usize) -> Self {
        Self { by_cell: vec![Vec::new(); n_cells], place_of: vec![0; n_cells], ..Self::default() }
    }

    /// Registers a slot that has no entries in cells, each once.
    pub(super) fn enter(&mut self, slot: u32, cells: &[CellId]) {
        if self.by_slot.len() <= slot as usize {
            self.by_slot.resize(slot as usize + 1, Vec::new());
        }
        let entries = &mut self.by_slot[slot as usize];
        debug_assert!(entries.is_empty(), "a slot that is entered was nowhere");
        for &CellId(cell) in cells {
            let list = &mut self.by_cell[cell as usize];
            if list.is_empty() {
                self.place_of[cell as usize] = self.occupied.len() as u32;
                self.occupied.push(cell);
            }
            let place = list.len() as u32;
            list.push((slot, entries.len() as u32));
            entries.push(Entry { cell, place });
        }
        self.n_entries += cells.len();
    }

    /// Removes a slot from all its cells.
    pub(super) fn leave(&mut self, slot: u32) {
        let Some(entries) = self.by_slot.get_mut(slot as usize) else { return };
        let mut entries = std::mem::take(entries);
        self.n_entries -= entries.len();
        for &Entry { cell, place } in &entries {
            let list = &mut self.by_cell[cell as usize];
            list.swap_remove(place as usize);
            if let Some(&(moved, entry)) = list.get(place as usize) {
                self.by_slot[moved as usize][entry as usize].place = place;
            }
            if list.is_empty() {
                let at = self.place_of[cell as usize];
                self.occupied.swap_remove(at as usize);
                if let Some(&last) = self.occupied.get(at as usize) {
                    self.place_of[last as usize] = at;
                }
            }
        }
        // The memory is kept for reuse.
        entries.clear();
        self.by_slot[slot as usize] = entries;
    }

    /// The slots in a cell.
    pub(super) fn of(&self, cell: u32) -> impl Iterator<Item = u32> + '_ {
        self.by_cell.get(cell as usize).into_iter().flatten().map(|&(slot, _)| slot)
    }

    /// The cells with entries.
    pub(super) fn occupied(&self) -> &[u32] {
        &self.occupied
    }

    /// Pairs of a slot and a cell.
    pub(super) fn n_entries(&self) -> usize {
        self.n_entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Invariant: the lists are those of sets of pairs.
        #[test]
        fn lists_are_sets_of_pairs(steps in prop::collection::vec((0u32..5, prop::collection::btree_set(0u32..7, 0..5)), 1..80)) {
            let mut lists = Lists::new(7);
            let mut pairs: BTreeSet<(u32, u32)> = BTreeSet::new();
            for (slot, cells) in steps {
                lists.leave(slot);
                lists.enter(slot, &cells.iter().map(|&c| CellId(c)).collect::<Vec<_>>());
                pairs.retain(|pair| pair.1 != slot);
                pairs.extend(cells.iter().map(|&c| (c, slot)));
                let pairs_of_lists: Vec<(u32, u32)> = (0..7).flat_map(|c| lists.of(c).map(move |s| (c, s))).collect();
                prop_assert_eq!(pairs_of_lists.len(), pairs.len());
                prop_assert_eq!(pairs_of_lists.into_iter().collect::<BTreeSet<_>>(), pairs.clone());
                prop_assert_eq!(lists.n_entries(), pairs.len());
                let occupied: BTreeSet<u32> = lists.occupied().iter().copied().collect();
                prop_assert_eq!(occupied.len(), lists.occupied().len());
                prop_assert_eq!(occupied, pairs.iter().map(|p| p.0).collect::<BTreeSet<_>>());
            }
        }
    }
}
