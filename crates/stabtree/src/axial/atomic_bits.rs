//! Bits that many threads set.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// The words that have the bits of some columns, each with its index. Fewest if the columns ascend.
pub(super) fn words_of(cols: &[usize]) -> Vec<(usize, u64)> {
    let mut words: Vec<(usize, u64)> = Vec::new();
    for &col in cols {
        let (at, bit) = (col / 64, 1 << (col % 64));
        match words.last_mut() {
            Some((last, bits)) if *last == at => *bits |= bit,
            _ => words.push((at, bit)),
        }
    }
    words
}

/// A matrix of bits that are only ever set, never cleared.
#[derive(Debug)]
pub(crate) struct AtomicBitMatrix {
    width: usize,
    words: Vec<AtomicU64>,
}

impl AtomicBitMatrix {
    pub(crate) fn new(n_rows: usize, n_cols: usize) -> Self {
        let width = n_cols.div_ceil(64);
        Self { width, words: std::iter::repeat_with(AtomicU64::default).take(n_rows * width).collect() }
    }

    #[inline]
    pub(crate) fn get(&self, row: usize, col: usize) -> bool {
        self.words[row * self.width + col / 64].load(Relaxed) >> (col % 64) & 1 == 1
    }

    /// Sets the bits of a row that are ones in `words`.
    pub(crate) fn set_all(&self, row: usize, words: &[u64]) {
        for (own, &bits) in self.words[row * self.width..(row + 1) * self.width].iter().zip(words) {
            if bits & !own.load(Relaxed) != 0 {
                own.fetch_or(bits, Relaxed);
            }
        }
    }

    /// Sets the bits of a row that are ones in some of its words, each given with its index.
    pub(super) fn set_words(&self, row: usize, words: &[(usize, u64)]) {
        let own = &self.words[row * self.width..][..self.width];
        for &(at, bits) in words {
            if bits & !own[at].load(Relaxed) != 0 {
                own[at].fetch_or(bits, Relaxed);
            }
        }
    }

    /// Sets a bit and returns whether it was clear before; of several threads that set the same bit, one gets `true`.
    #[inline]
    pub(crate) fn set(&self, row: usize, col: usize) -> bool {
        let (word, bit) = (&self.words[row * self.width + col / 64], 1 << (col % 64));
        // Most bits are set already, and a load is cheaper.
        word.load(Relaxed) & bit == 0 && word.fetch_or(bit, Relaxed) & bit == 0
    }

    /// The bits of a row from one column to before another, as masked words.
    fn part(&self, row: usize, [from, to]: [usize; 2]) -> impl Iterator<Item = (u64, u64)> + '_ {
        let words = &self.words[row * self.width..][..self.width];
        (from / 64..to.div_ceil(64)).map(move |i| {
            let low = if i * 64 < from { u64::MAX << (from % 64) } else { u64::MAX };
            let high = if (i + 1) * 64 > to { u64::MAX >> (64 - to % 64) } else { u64::MAX };
            (words[i].load(Relaxed), low & high)
        })
    }

    /// Whether any bit of some rows and columns is set.
    pub(crate) fn any(&self, rows: [usize; 2], cols: [usize; 2]) -> bool {
        (rows[0]..rows[1]).any(|row| self.part(row, cols).any(|(word, mask)| word & mask != 0))
    }

    /// Whether any bit of some rows and columns is set that `other`, of the same size, has not.
    pub(super) fn any_beyond(&self, other: &Self, rows: [usize; 2], cols: [usize; 2]) -> bool {
        (rows[0]..rows[1]).any(|row| {
            let mut words = self.part(row, cols).zip(other.part(row, cols));
            words.any(|((word, mask), (other, _))| word & !other & mask != 0)
        })
    }

    /// How many bits of some rows and columns are set that `other`, of the same size, has not; counting ends beyond
    /// `most`.
    pub(super) fn count_beyond(&self, other: &Self, rows: [usize; 2], cols: [usize; 2], most: u32) -> u32 {
        let mut n = 0;
        for row in rows[0]..rows[1] {
            let words = self.part(row, cols).zip(other.part(row, cols));
            n += words.map(|((word, mask), (other, _))| (word & !other & mask).count_ones()).sum::<u32>();
            if n > most {
                break;
            }
        }
        n
    }

    /// Whether all bits of some rows and columns are set.
    pub(crate) fn all(&self, rows: [usize; 2], cols: [usize; 2]) -> bool {
        (rows[0]..rows[1]).all(|row| self.part(row, cols).all(|(word, mask)| word & mask == mask))
    }

    /// The set columns of a row from one column to before another, ascending.
    pub(super) fn ones_within(&self, row: usize, cols: [usize; 2]) -> impl Iterator<Item = usize> + '_ {
        let words = (cols[0] / 64..).zip(self.part(row, cols));
        words.flat_map(|(i, (word, mask))| crate::search::ones(word & mask).map(move |b| i * 64 + b))
    }

    /// The set columns of a row, ascending.
    pub(crate) fn ones(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        let words = &self.words[row * self.width..][..self.width];
        words.iter().enumerate().flat_map(|(i, word)| crate::search::ones(word.load(Relaxed)).map(move |b| i * 64 + b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_as_bits_one_by_one() {
        let marks = AtomicBitMatrix::new(3, 130);
        let set = [(0, 0), (1, 63), (1, 64), (2, 129), (0, 65)];
        assert!(set.iter().all(|&(r, c)| marks.set(r, c)));
        let ends = [0, 1, 62, 63, 64, 65, 66, 127, 128, 129, 130];
        for rows in [[0, 1], [0, 2], [1, 3]] {
            for cols in ends.iter().flat_map(|&a| ends.iter().filter(move |&&b| b > a).map(move |&b| [a, b])) {
                let inside = || (rows[0]..rows[1]).flat_map(|r| (cols[0]..cols[1]).map(move |c| (r, c)));
                assert_eq!(marks.any(rows, cols), inside().any(|p| set.contains(&p)), "{rows:?} {cols:?}");
                assert_eq!(marks.all(rows, cols), inside().all(|p| set.contains(&p)), "{rows:?} {cols:?}");
                let ones = (cols[0]..cols[1]).filter(|&c| set.contains(&(rows[0], c)));
                assert!(marks.ones_within(rows[0], cols).eq(ones));
            }
        }
        assert_eq!(marks.ones(1).collect::<Vec<_>>(), [63, 64]);
        let some = AtomicBitMatrix::new(2, 130);
        some.set(1, 1);
        some.set_words(1, &words_of(&[0, 63, 64, 129, 2]));
        assert_eq!((some.ones(0).count(), some.ones(1).collect::<Vec<_>>()), (0, vec![0, 1, 2, 63, 64, 129]));
        let other = AtomicBitMatrix::new(3, 130);
        assert!([(0, 0), (1, 63)].into_iter().all(|(r, c)| other.set(r, c)) && !other.set(1, 63));
        assert!(marks.any_beyond(&other, [0, 3], [0, 130]) && marks.any_beyond(&other, [1, 2], [63, 65]));
        assert_eq!(marks.count_beyond(&other, [0, 3], [0, 130], 9), 3);
        assert_eq!(marks.count_beyond(&other, [0, 3], [0, 130], 0), 1);
        assert!(!marks.any_beyond(&other, [0, 2], [0, 64]) && !other.any_beyond(&marks, [0, 3], [0, 130]));
    }
}
