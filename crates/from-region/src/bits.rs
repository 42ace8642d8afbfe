//! Sets of voxels, as bits.

use crate::grid::Block;

/// A set of voxels of a grid; rows run along the last axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Bits {
    n: [usize; 3],
    words_per_row: usize,
    words: Vec<u64>,
}

/// The bits of word `word` of a row that lie from `from` to before `to`.
fn mask(word: usize, from: usize, to: usize) -> u64 {
    let low = from.max(word * 64) - word * 64;
    let high = to.min(word * 64 + 64) - word * 64;
    (u64::MAX >> (64 - (high - low))) << low
}

impl Bits {
    /// The empty set.
    pub(crate) fn new(n: [usize; 3]) -> Self {
        let words_per_row = n[2].div_ceil(64);
        Self { n, words_per_row, words: vec![0; n[0] * n[1] * words_per_row] }
    }

    fn row(&self, x: usize, y: usize) -> usize {
        (x * self.n[1] + y) * self.words_per_row
    }

    pub(crate) fn get(&self, [x, y, z]: [usize; 3]) -> bool {
        self.words[self.row(x, y) + z / 64] >> (z % 64) & 1 == 1
    }

    pub(crate) fn set(&mut self, [x, y, z]: [usize; 3]) {
        let row = self.row(x, y);
        self.words[row + z / 64] |= 1 << (z % 64);
    }

    /// Adds the voxels of a row from `from` to before `to`.
    pub(crate) fn set_run(&mut self, x: usize, y: usize, from: usize, to: usize) {
        let row = self.row(x, y);
        if from < to {
            for word in from / 64..=(to - 1) / 64 {
                self.words[row + word] |= mask(word, from, to);
            }
        }
    }

    /// Whether a voxel of a row from `from` to before `to` is in the set.
    pub(crate) fn has_any(&self, x: usize, y: usize, from: usize, to: usize) -> bool {
        let row = self.row(x, y);
        from < to && (from / 64..=(to - 1) / 64).any(|word| self.words[row + word] & mask(word, from, to) != 0)
    }

    /// Adds a block.
    pub(crate) fn set_block(&mut self, b: &Block) {
        for x in b.low[0]..b.high[0] {
            for y in b.low[1]..b.high[1] {
                self.set_run(x, y, b.low[2], b.high[2]);
            }
        }
    }

    /// Whether all of a block is in the set; so is a block without voxels.
    pub(crate) fn has_block(&self, b: &Block) -> bool {
        let (from, to) = (b.low[2], b.high[2]);
        from >= to
            || (b.low[0]..b.high[0]).all(|x| {
                (b.low[1]..b.high[1]).all(|y| {
                    let row = self.row(x, y);
                    (from / 64..=(to - 1) / 64).all(|word| {
                        let mask = mask(word, from, to);
                        self.words[row + word] & mask == mask
                    })
                })
            })
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn block(n: [usize; 3]) -> impl Strategy<Value = Block> {
        let span = |n: usize| (0..n, 0..n).prop_map(|(a, b)| (a.min(b), a.max(b) + 1));
        [span(n[0]), span(n[1]), span(n[2])].prop_map(|s| Block { low: s.map(|s| s.0), high: s.map(|s| s.1) })
    }

    fn voxels(b: &Block) -> Vec<[usize; 3]> {
        let of = |k: usize| b.low[k]..b.high[k];
        of(0).flat_map(|x| of(1).flat_map(move |y| of(2).map(move |z| [x, y, z]))).collect()
    }

    proptest! {
        /// Invariant: as a set of triples behaves.
        #[test]
        fn bits_are_a_set(blocks in prop::collection::vec(block([3, 2, 150]), 0..6), probe in block([3, 2, 150])) {
            let (mut bits, mut set) = (Bits::new([3, 2, 150]), BTreeSet::new());
            for b in &blocks {
                bits.set_block(b);
                set.extend(voxels(b));
            }
            bits.set([2, 1, 149]);
            set.insert([2, 1, 149]);
            prop_assert_eq!(bits.len(), set.len());
            prop_assert_eq!(bits.has_block(&probe), voxels(&probe).iter().all(|p| set.contains(p)));
            prop_assert!(voxels(&probe).iter().all(|&p| bits.get(p) == set.contains(&p)));
            let [x, y, from] = probe.low;
            let has_any = (from..probe.high[2]).any(|z| set.contains(&[x, y, z]));
            prop_assert_eq!(bits.has_any(x, y, from, probe.high[2]), has_any);
        }
    }
}
