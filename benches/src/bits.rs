//! Rows of bits that several threads set at once.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A matrix of bits, at first all 0.
#[derive(Debug)]
pub struct SharedBits {
    words: Vec<AtomicU64>,
    words_in_row: usize,
}

impl SharedBits {
    /// `n_rows` by `n_cols` bits.
    pub fn new(n_rows: usize, n_cols: usize) -> Self {
        let words_in_row = n_cols.div_ceil(64);
        Self { words: (0..n_rows * words_in_row).map(|_| AtomicU64::new(0)).collect(), words_in_row }
    }

    fn place(&self, row: u32, col: u32) -> (&AtomicU64, u64) {
        (&self.words[row as usize * self.words_in_row + col as usize / 64], 1 << (col % 64))
    }

    /// Whether a bit is 1.
    pub fn get(&self, row: u32, col: u32) -> bool {
        let (word, bit) = self.place(row, col);
        word.load(Relaxed) & bit != 0
    }

    /// Makes a bit 1.
    pub fn set(&self, row: u32, col: u32) {
        let (word, bit) = self.place(row, col);
        // Most bits are set many times; to look costs other threads nothing.
        if word.load(Relaxed) & bit == 0 {
            word.fetch_or(bit, Relaxed);
        }
    }

    /// Number of ones.
    pub fn count_ones(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.load(Relaxed).count_ones())).sum()
    }

    /// The columns of the ones of a row, ascending.
    pub fn ones(&self, row: u32) -> Vec<u32> {
        self.listed(row, |_, word| word)
    }

    /// The columns that are 1 in a row here and 0 in `other`, ascending.
    pub fn without(&self, other: &Self, row: u32) -> Vec<u32> {
        self.listed(row, |at, word| word & !other.words[at].load(Relaxed))
    }

    fn listed(&self, row: u32, word_at: impl Fn(usize, u64) -> u64) -> Vec<u32> {
        let start = row as usize * self.words_in_row;
        let mut cols = Vec::new();
        for (k, word) in self.words[start..start + self.words_in_row].iter().enumerate() {
            let mut left = word_at(start + k, word.load(Relaxed));
            while left != 0 {
                cols.push((64 * k) as u32 + left.trailing_zeros());
                left &= left - 1;
            }
        }
        cols
    }

    /// Leaves only what is 1 in `other` too.
    ///
    /// # Panics
    /// If it has another shape.
    pub fn intersect(&mut self, other: &Self) {
        assert_eq!(self.words.len(), other.words.len(), "matrices of one shape are intersected");
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a.get_mut() &= b.load(Relaxed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_set_and_listed() {
        let (mut a, b) = (SharedBits::new(2, 130), SharedBits::new(2, 130));
        [(0, 0), (1, 63), (1, 64), (1, 129), (1, 129)].iter().for_each(|&(row, col)| a.set(row, col));
        b.set(1, 64);
        assert_eq!((a.count_ones(), a.get(1, 129), a.get(0, 129)), (4, true, false));
        assert_eq!((a.ones(1), a.without(&b, 1)), (vec![63, 64, 129], vec![63, 129]));
        a.intersect(&b);
        assert_eq!((a.ones(0), a.ones(1)), (vec![], vec![64]));
    }
}
