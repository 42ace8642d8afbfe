//! Sets of pairs of cells.

/// Pairs of cells, without order; a bit for each ordered pair.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pairs {
    n: usize,
    width: usize,
    words: Vec<u64>,
}

impl Pairs {
    /// No pairs of `n` cells. Takes `n²` bits.
    pub fn none(n: usize) -> Self {
        let width = n.div_ceil(64);
        Self { n, width, words: vec![0; n * width] }
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.n
    }

    /// Whether a pair is in the set; a pair with a cell that does not exist is not.
    pub fn has(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        a < self.n && b < self.n && self.words[a * self.width + b / 64] >> (b % 64) & 1 == 1
    }

    /// Adds a pair, in both orders.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn add(&mut self, a: u32, b: u32) {
        let (a, b) = (a as usize, b as usize);
        assert!(a < self.n && b < self.n, "cells {a} and {b} of {}", self.n);
        self.words[a * self.width + b / 64] |= 1 << (b % 64);
        self.words[b * self.width + a / 64] |= 1 << (a % 64);
    }

    /// Adds every pair of some cells, and each cell with itself.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn add_all(&mut self, cells: &[u32]) {
        for (i, &a) in cells.iter().enumerate() {
            cells[..=i].iter().for_each(|&b| self.add(a, b));
        }
    }

    /// Adds every pair of some cells if at least `at_least` pairs of different cells, and at least one, are new. Returns
    /// whether they were added.
    pub(crate) fn add_all_if_new(&mut self, cells: &[u32], at_least: usize) -> bool {
        let pairs = cells.iter().enumerate().flat_map(|(i, &a)| cells[..i].iter().map(move |&b| [a, b]));
        let is_new = pairs.filter(|&[a, b]| a != b && !self.has(a, b)).count() >= at_least.max(1);
        if is_new {
            self.add_all(cells);
        }
        is_new
    }

    /// Removes a pair, in both orders.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn remove(&mut self, a: u32, b: u32) {
        let (a, b) = (a as usize, b as usize);
        assert!(a < self.n && b < self.n, "cells {a} and {b} of {}", self.n);
        self.words[a * self.width + b / 64] &= !(1 << (b % 64));
        self.words[b * self.width + a / 64] &= !(1 << (a % 64));
    }

    /// The pairs of a cell: bit `j % 64` of word `j / 64` is set if it is paired with cell `j`.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn row(&self, cell: u32) -> &[u64] {
        assert!((cell as usize) < self.n, "cell {cell} of {}", self.n);
        &self.words[cell as usize * self.width..][..self.width]
    }

    /// The cells that a cell is paired with, ascending.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn of(&self, cell: u32) -> impl Iterator<Item = u32> + '_ {
        ones(self.row(cell))
    }

    /// Pairs of different cells, lower number first, ascending.
    pub fn iter(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        (0..self.n as u32).flat_map(|a| self.of(a).filter(move |&b| b > a).map(move |b| [a, b]))
    }

    /// Number of pairs of different cells.
    pub fn len(&self) -> u64 {
        let all: u64 = self.words.iter().map(|w| u64::from(w.count_ones())).sum();
        let own = (0..self.n as u32).filter(|&c| self.has(c, c)).count() as u64;
        (all - own) / 2
    }

    /// Whether there is no pair of different cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Pairs of a cell and an object; a bit for each.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ObjectPairs {
    n_objects: usize,
    width: usize,
    words: Vec<u64>,
}

impl ObjectPairs {
    /// No pairs of cells and objects. Takes a bit for each pair.
    pub fn none(n_cells: usize, n_objects: usize) -> Self {
        let width = n_objects.div_ceil(64);
        Self { n_objects, width, words: vec![0; n_cells * width] }
    }

    /// Whether a pair is in the set; a pair with a cell or an object that does not exist is not.
    pub fn has(&self, cell: u32, object: u32) -> bool {
        let (cell, object) = (cell as usize, object as usize);
        let word = || self.words.get(cell * self.width + object / 64);
        object < self.n_objects && word().is_some_and(|word| word >> (object % 64) & 1 == 1)
    }

    /// Adds a pair. Returns whether it is new.
    ///
    /// # Panics
    /// If there is no such cell or object.
    pub fn add(&mut self, cell: u32, object: u32) -> bool {
        let (cell, object) = (cell as usize, object as usize);
        assert!(object < self.n_objects, "object {object} of {}", self.n_objects);
        let (word, bit) = (&mut self.words[cell * self.width + object / 64], 1 << (object % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }

    /// Number of pairs.
    pub fn len(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }
}

/// The indices of the bits that are set in a row, ascending.
pub(crate) fn ones(row: &[u64]) -> impl Iterator<Item = u32> + '_ {
    (0u32..).zip(row).flat_map(|(i, &word)| {
        let mut word = word;
        std::iter::from_fn(move || {
            let place = (word != 0).then(|| i * 64 + word.trailing_zeros());
            word &= word.wrapping_sub(1);
            place
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_with_objects_are_kept() {
        let mut pairs = ObjectPairs::none(3, 70);
        assert!(pairs.is_empty() && pairs.add(2, 69) && pairs.add(0, 0) && !pairs.add(2, 69));
        assert_eq!((pairs.len(), pairs.is_empty()), (2, false));
        assert!(pairs.has(2, 69) && !pairs.has(1, 69) && !pairs.has(2, 70) && !pairs.has(3, 0) && !pairs.has(1, 64));
        assert!(!ObjectPairs::default().has(0, 0));
    }

    #[test]
    fn pairs_are_kept_both_ways_round() {
        let mut pairs = Pairs::none(70);
        [[3, 69], [0, 1], [64, 63], [5, 5]].iter().for_each(|&[a, b]| pairs.add(a, b));
        assert_eq!(pairs.iter().collect::<Vec<_>>(), [[0, 1], [3, 69], [63, 64]]);
        assert_eq!((pairs.len(), pairs.is_empty(), pairs.n_cells()), (3, false, 70));
        assert!(pairs.has(69, 3) && pairs.has(5, 5) && !pairs.has(3, 70) && !pairs.has(99, 0));
        pairs.remove(69, 3);
        assert_eq!((pairs.len(), pairs.of(3).count(), pairs.of(5).collect::<Vec<_>>()), (2, 0, vec![5]));
    }
}
