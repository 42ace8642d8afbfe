//! Prepared data within a byte budget.

use sightlines_pvs::CellId;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Prepared data by cell; when it exceeds the budget, the least recently used items are evicted first.
#[derive(Debug)]
pub(crate) struct Cache<T> {
    budget: usize,
    n_bytes: usize,
    /// By cell: the data, its bytes, and the time of its last use.
    things: BTreeMap<CellId, (Arc<T>, usize, u64)>,
    /// The cells by the time of their last use. No two have the same time.
    by_use: BTreeMap<u64, CellId>,
    /// Pinned cells, which stay regardless of the budget.
    pinned: Vec<CellId>,
    now: u64,
    n_dropped: u64,
}

impl<T> Cache<T> {
    pub(crate) fn new(budget: usize) -> Self {
        Self {
            budget,
            n_bytes: 0,
            things: BTreeMap::new(),
            by_use: BTreeMap::new(),
            pinned: Vec::new(),
            now: 0,
            n_dropped: 0,
        }
    }

    /// The data of a cell, which counts as used now. O(log n).
    pub(crate) fn get(&mut self, cell: CellId) -> Option<&Arc<T>> {
        self.now += 1;
        let (thing, _, used) = self.things.get_mut(&cell)?;
        self.by_use.remove(used);
        self.by_use.insert(self.now, cell);
        *used = self.now;
        Some(thing)
    }

    /// Whether a cell is prepared; it does not count as used.
    pub(crate) fn has(&self, cell: CellId) -> bool {
        self.things.contains_key(&cell)
    }

    /// Pins these cells, and no others, regardless of the budget.
    pub(crate) fn pin(&mut self, cells: &[CellId]) {
        self.pinned.clear();
        self.pinned.extend_from_slice(cells);
    }

    /// Changes the budget; items are evicted as when one is added.
    pub(crate) fn set_budget(&mut self, budget: usize) {
        self.budget = budget;
        self.evict();
    }

    /// Adds the data of a cell, which counts as used now. Others are evicted until the budget holds or only this one
    /// and pinned ones are left.
    pub(crate) fn add(&mut self, cell: CellId, thing: T, n_bytes: usize) -> Arc<T> {
        self.remove(cell);
        self.now += 1;
        let thing = Arc::new(thing);
        self.things.insert(cell, (Arc::clone(&thing), n_bytes, self.now));
        self.by_use.insert(self.now, cell);
        self.n_bytes += n_bytes;
        self.evict();
        thing
    }

    /// Evicts, least recently used first, until the budget holds or only the last used item and pinned ones are left.
    fn evict(&mut self) {
        while self.n_bytes > self.budget {
            let last = self.by_use.values().next_back();
            let mut loose = self.by_use.values().filter(|cell| Some(*cell) != last && !self.pinned.contains(cell));
            let Some(&oldest) = loose.next() else { break };
            self.remove(oldest);
            self.n_dropped += 1;
        }
    }

    fn remove(&mut self, cell: CellId) {
        if let Some((_, n_bytes, used)) = self.things.remove(&cell) {
            self.by_use.remove(&used);
            self.n_bytes -= n_bytes;
        }
    }

    pub(crate) fn n_bytes(&self) -> usize {
        self.n_bytes
    }

    pub(crate) fn len(&self) -> usize {
        self.things.len()
    }

    pub(crate) fn n_dropped(&self) -> u64 {
        self.n_dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Invariant: never above the budget except by one item alone; the most recently used item stays; the counters
        /// agree with the content.
        #[test]
        fn budget_is_kept(budget in 0usize..50, steps in prop::collection::vec((0u32..8, 1usize..20, any::<bool>()), 1..60)) {
            let mut cache = Cache::new(budget);
            for (cell, n_bytes, ask) in steps {
                let cell = CellId(cell);
                if ask {
                    let there = cache.has(cell);
                    prop_assert_eq!(cache.get(cell).is_some(), there);
                } else {
                    cache.add(cell, n_bytes, n_bytes);
                    prop_assert!(cache.has(cell));
                }
                prop_assert!(cache.n_bytes() <= budget || cache.len() == 1);
                prop_assert_eq!(cache.n_bytes(), cache.things.values().map(|t| *t.0).sum::<usize>());
                prop_assert_eq!(cache.by_use.len(), cache.len());
            }
        }
    }

    #[test]
    fn pinned_ones_stay() {
        let mut cache = Cache::new(10);
        cache.pin(&[CellId(0), CellId(1)]);
        for cell in [0, 1, 2, 3] {
            cache.add(CellId(cell), (), 10);
        }
        assert!(cache.has(CellId(0)) && cache.has(CellId(1)) && !cache.has(CellId(2)) && cache.has(CellId(3)));
        cache.pin(&[]);
        cache.add(CellId(4), (), 10);
        assert_eq!(cache.len(), 1);
    }

    #[test]
    fn oldest_goes_first() {
        let mut cache = Cache::new(20);
        for cell in 0..2 {
            cache.add(CellId(cell), (), 10);
        }
        cache.get(CellId(0));
        cache.add(CellId(2), (), 10);
        assert!(cache.has(CellId(0)) && !cache.has(CellId(1)) && cache.has(CellId(2)));
        assert_eq!(cache.n_dropped(), 1);
    }
}
