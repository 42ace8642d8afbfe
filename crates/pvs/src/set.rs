//! Sets of cells.

use crate::CellId;
use crate::bits::{self, WORD};

/// A set of the cells of one table, as bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellSet {
    words: Vec<u64>,
}

impl CellSet {
    /// The empty set of a table with `n_cells` cells.
    pub(crate) fn empty(n_cells: usize) -> Self {
        Self { words: vec![0; n_cells.div_ceil(WORD)] }
    }

    /// Adds the cells of a row.
    pub(crate) fn unite(&mut self, row: &[u64]) {
        bits::or_words(&mut self.words, row);
    }

    /// Whether `cell` is in the set; `false` for a cell that the table does not have.
    #[inline]
    pub fn contains(&self, cell: CellId) -> bool {
        self.words.get(cell.idx() / WORD).is_some_and(|word| word >> (cell.idx() % WORD) & 1 == 1)
    }

    /// The cells, ascending.
    pub fn iter(&self) -> impl Iterator<Item = CellId> + '_ {
        bits::ones(&self.words).map(|i| CellId(i as u32))
    }

    /// Number of cells. O(words).
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether there is no cell in the set.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Cell `j` is bit `j % 64` of word `j / 64`.
    pub fn words(&self) -> &[u64] {
        &self.words
    }
}
