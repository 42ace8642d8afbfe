//! Unpacked blocks, kept within a budget; the least recently used are evicted first.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// An unpacked block.
#[derive(Debug)]
pub(crate) enum Block {
    /// Rows of bits.
    Words(Vec<u64>),
    /// Records, preceded by their ends.
    Bytes(Vec<u8>),
}

impl Block {
    /// Bytes in memory for the block, including its bookkeeping.
    pub(crate) fn size(&self) -> usize {
        let content = match self {
            Self::Words(words) => 8 * words.capacity(),
            Self::Bytes(bytes) => bytes.capacity(),
        };
        content + size_of::<Self>() + size_of::<Slot>() + 2 * size_of::<usize>()
    }
}

/// Counters of the work done so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PackedStats {
    /// Requested blocks that were in memory.
    pub hits: u64,
    /// Requested blocks that had to be read.
    pub misses: u64,
    /// Blocks that were evicted.
    pub evictions: u64,
    /// Bytes read from the source, including those read when it was opened.
    pub bytes_read: u64,
}

const NONE: u32 = u32::MAX;

#[derive(Debug)]
struct Slot {
    number: u32,
    block: Arc<Block>,
    /// Slots used after and before this one.
    newer: u32,
    older: u32,
}

#[derive(Debug)]
struct Kept {
    /// For each block its slot, or [`NONE`].
    slot_of: Vec<u32>,
    slots: Vec<Slot>,
    newest: u32,
    oldest: u32,
    bytes: usize,
    stats: PackedStats,
}

/// The kept blocks of a file.
#[derive(Debug)]
pub(crate) struct Cache {
    budget: usize,
    kept: Mutex<Kept>,
}

impl Cache {
    /// A cache for blocks 0 to `n_blocks` that keeps at most `budget` bytes. Takes 4 bytes per block.
    pub(crate) fn new(n_blocks: usize, budget: usize) -> Self {
        let kept = Kept {
            slot_of: vec![NONE; n_blocks],
            slots: Vec::new(),
            newest: NONE,
            oldest: NONE,
            bytes: 0,
            stats: PackedStats::default(),
        };
        Self { budget, kept: Mutex::new(kept) }
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // Nothing here panics half-way; and even then, a cache that lost a block is still valid.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The block, if it is in memory; counts a hit or a miss. O(1), no allocation.
    #[inline]
    pub(crate) fn get(&self, number: usize) -> Option<Arc<Block>> {
        let mut kept = self.lock();
        let slot = kept.slot_of[number];
        if slot == NONE {
            kept.stats.misses += 1;
            return None;
        }
        kept.stats.hits += 1;
        if kept.newest != slot {
            kept.unlink(slot);
            kept.link(slot);
        }
        Some(Arc::clone(&kept.slots[slot as usize].block))
    }

    /// Keeps a block if it fits the budget on its own, and evicts others for it.
    pub(crate) fn put(&self, number: usize, block: &Arc<Block>) {
        let size = block.size();
        let mut kept = self.lock();
        // Another thread may have been quicker.
        if size > self.budget || kept.slot_of[number] != NONE {
            return;
        }
        while kept.bytes + size > self.budget {
            kept.evict();
        }
        let slot = kept.slots.len() as u32;
        kept.slots.push(Slot { number: number as u32, block: Arc::clone(block), newer: NONE, older: NONE });
        kept.slot_of[number] = slot;
        kept.bytes += size;
        kept.link(slot);
    }

    pub(crate) fn count_read(&self, bytes: u64) {
        self.lock().stats.bytes_read += bytes;
    }

    pub(crate) fn stats(&self) -> PackedStats {
        self.lock().stats
    }

    pub(crate) fn bytes(&self) -> usize {
        self.lock().bytes
    }

    pub(crate) fn budget(&self) -> usize {
        self.budget
    }
}

impl Kept {
    fn link(&mut self, slot: u32) {
        let newest = std::mem::replace(&mut self.newest, slot);
        (self.slots[slot as usize].newer, self.slots[slot as usize].older) = (NONE, newest);
        match newest {
            NONE => self.oldest = slot,
            newest => self.slots[newest as usize].newer = slot,
        }
    }

    fn unlink(&mut self, slot: u32) {
        let Slot { newer, older, .. } = self.slots[slot as usize];
        match newer {
            NONE => self.newest = older,
            newer => self.slots[newer as usize].older = older,
        }
        match older {
            NONE => self.oldest = newer,
            older => self.slots[older as usize].newer = newer,
        }
    }

    /// Evicts the oldest block; the last slot takes its place.
    fn evict(&mut self) {
        let slot = self.oldest;
        self.unlink(slot);
        let gone = self.slots.swap_remove(slot as usize);
        self.slot_of[gone.number as usize] = NONE;
        self.bytes -= gone.block.size();
        self.stats.evictions += 1;
        if let Some(moved) = self.slots.get(slot as usize) {
            let Slot { number, newer, older, .. } = *moved;
            self.slot_of[number as usize] = slot;
            match newer {
                NONE => self.newest = slot,
                newer => self.slots[newer as usize].older = slot,
            }
            match older {
                NONE => self.oldest = slot,
                older => self.slots[older as usize].newer = slot,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    proptest! {
        /// The oracle: a plain list of block numbers, the newest first.
        #[test]
        fn the_oldest_blocks_go_first(
            asked in prop::collection::vec(0usize..12, 0..200),
            budget in 0usize..1000,
        ) {
            let size_of = |number: usize| Block::Bytes(vec![number as u8; 16 * (1 + number % 5)]);
            let cache = Cache::new(12, budget);
            let mut list: VecDeque<usize> = VecDeque::new();
            let (mut hits, mut evictions) = (0, 0);
            for number in asked.iter().copied() {
                let found = cache.get(number);
                let at = list.iter().position(|&n| n == number);
                prop_assert_eq!(found.is_some(), at.is_some());
                if let Some(at) = at {
                    list.remove(at);
                    list.push_front(number);
                    hits += 1;
                    let same = matches!(&*found.unwrap(), Block::Bytes(b) if b[0] == number as u8);
                    prop_assert!(same);
                    continue;
                }
                cache.put(number, &Arc::new(size_of(number)));
                let total = |list: &VecDeque<usize>| list.iter().map(|&n| size_of(n).size()).sum::<usize>();
                if size_of(number).size() <= budget {
                    while total(&list) + size_of(number).size() > budget {
                        list.pop_back();
                        evictions += 1;
                    }
                    list.push_front(number);
                }
                prop_assert_eq!(cache.bytes(), total(&list));
                prop_assert!(cache.bytes() <= cache.budget());
            }
            let stats = cache.stats();
            prop_assert_eq!((stats.hits, stats.misses, stats.evictions), (hits, asked.len() as u64 - hits, evictions));
        }
    }
}
