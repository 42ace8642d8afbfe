//! Rows of bits: the visibility matrix.

/// Bits in a word.
pub(crate) const WORD: usize = u64::BITS as usize;

/// A matrix of bits; each row is a slice of `u64` words.
///
/// Column `j` is bit `j % 64` of word `j / 64`. Bits of the last word past the last column are zero; every method keeps
/// them zero, and code that writes through [`BitMatrix::row_mut`] must do so too.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BitMatrix {
    n_rows: usize,
    n_cols: usize,
    stride: usize,
    words: Vec<u64>,
}

impl BitMatrix {
    /// A matrix of zeros.
    ///
    /// # Panics
    /// If the number of words is above `usize::MAX`.
    pub fn new(n_rows: usize, n_cols: usize) -> Self {
        let stride = n_cols.div_ceil(WORD);
        let n_words = n_rows.checked_mul(stride).expect("a bit matrix has at most usize::MAX words");
        Self { n_rows, n_cols, stride, words: vec![0; n_words] }
    }

    /// The square matrix with ones on the diagonal: everything sees itself.
    pub fn identity(n: usize) -> Self {
        let mut matrix = Self::new(n, n);
        (0..n).for_each(|i| matrix.set(i, i, true));
        matrix
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Number of columns.
    pub fn n_cols(&self) -> usize {
        self.n_cols
    }

    /// The bit in `row` and `col`.
    ///
    /// # Panics
    /// If there is no such place.
    #[inline]
    pub fn get(&self, row: usize, col: usize) -> bool {
        assert!(col < self.n_cols, "column {col} of {}", self.n_cols);
        self.row(row)[col / WORD] >> (col % WORD) & 1 == 1
    }

    /// Writes the bit in `row` and `col`.
    ///
    /// # Panics
    /// If there is no such place.
    #[inline]
    pub fn set(&mut self, row: usize, col: usize, on: bool) {
        assert!(col < self.n_cols, "column {col} of {}", self.n_cols);
        let word = &mut self.row_mut(row)[col / WORD];
        let bit = 1 << (col % WORD);
        if on { *word |= bit } else { *word &= !bit }
    }

    /// The words of a row, `n_cols` / 64 of them, rounded up.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> &[u64] {
        assert!(row < self.n_rows, "row {row} of {}", self.n_rows);
        &self.words[row * self.stride..(row + 1) * self.stride]
    }

    /// The words of a row, to be written. Bits past the last column must stay zero.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [u64] {
        assert!(row < self.n_rows, "row {row} of {}", self.n_rows);
        &mut self.words[row * self.stride..(row + 1) * self.stride]
    }

    /// Number of ones in all rows. O(words).
    pub fn count_ones(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    /// Number of ones in a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn count_row(&self, row: usize) -> u64 {
        self.row(row).iter().map(|w| u64::from(w.count_ones())).sum()
    }

    /// Sets in row `target` every bit that row `source` has.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn or_into(&mut self, target: usize, source: usize) {
        assert!(target < self.n_rows && source < self.n_rows, "rows {target} and {source} of {}", self.n_rows);
        for k in 0..self.stride {
            self.words[target * self.stride + k] |= self.words[source * self.stride + k];
        }
    }

    /// The columns of the ones of a row, ascending.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn iter_ones(&self, row: usize) -> Ones<'_> {
        ones(self.row(row))
    }

    /// Whether the matrix equals its transpose. O(words), 64 bits at a time.
    pub fn is_symmetric(&self) -> bool {
        self.n_rows == self.n_cols && self.first_asymmetry().is_none()
    }

    /// Some place below the diagonal of a square matrix that differs from its mirror image.
    pub(crate) fn first_asymmetry(&self) -> Option<(usize, usize)> {
        for (i, j) in self.lower_blocks() {
            let (below, mut above) = (self.block(i, j), self.block(j, i));
            transpose(&mut above);
            if let Some(r) = (0..WORD).find(|&r| below[r] != above[r]) {
                let bit = (below[r] ^ above[r]).trailing_zeros() as usize;
                return Some((i * WORD + r, j * WORD + bit));
            }
        }
        None
    }

    /// Some row with a one past the last column.
    pub(crate) fn first_stray(&self) -> Option<usize> {
        let used = self.n_cols % WORD;
        let stray = |row: &usize| self.row(*row)[self.stride - 1] >> used != 0;
        if used == 0 { None } else { (0..self.n_rows).find(stray) }
    }

    /// Sets the mirror image of every one below the diagonal of a square matrix, which has no ones above it.
    pub(crate) fn mirror_lower(&mut self) {
        for (i, j) in self.lower_blocks() {
            let mut block = self.block(i, j);
            transpose(&mut block);
            for (r, word) in block.iter().enumerate().take(self.n_rows - j * WORD) {
                self.words[(j * WORD + r) * self.stride + i] |= word;
            }
        }
    }

    /// Places of the blocks of 64 by 64 bits that meet the lower triangle.
    fn lower_blocks(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        (0..self.stride).flat_map(|i| (0..=i).map(move |j| (i, j)))
    }

    fn block(&self, i: usize, j: usize) -> [u64; WORD] {
        let row = |r| i * WORD + r;
        std::array::from_fn(|r| if row(r) < self.n_rows { self.words[row(r) * self.stride + j] } else { 0 })
    }
}

/// Transposes a block: bit `j` of row `i` changes places with bit `i` of row `j`.
///
/// Swaps the two quarters off the diagonal, then does the same inside each quarter, all at once.
fn transpose(block: &mut [u64; WORD]) {
    let mut half = WORD / 2;
    let mut low_half = u64::MAX >> half;
    while half > 0 {
        for i in (0..WORD).filter(|i| i & half == 0) {
            let swap = (block[i] >> half ^ block[i + half]) & low_half;
            block[i] ^= swap << half;
            block[i + half] ^= swap;
        }
        half /= 2;
        low_half ^= low_half << half;
    }
}

/// The indices of the ones of a row of words, ascending.
pub fn ones(words: &[u64]) -> Ones<'_> {
    Ones { words, next: 0, current: 0 }
}

/// Sets in `into` every bit that `from` has; surplus words of the longer one are left as they are.
pub fn or_words(into: &mut [u64], from: &[u64]) {
    into.iter_mut().zip(from).for_each(|(a, b)| *a |= b);
}

/// Iterator of [`ones`].
#[derive(Debug, Clone)]
pub struct Ones<'a> {
    words: &'a [u64],
    next: usize,
    current: u64,
}

impl Iterator for Ones<'_> {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        while self.current == 0 {
            self.current = *self.words.get(self.next)?;
            self.next += 1;
        }
        let bit = self.current.trailing_zeros() as usize;
        self.current &= self.current - 1;
        Some((self.next - 1) * WORD + bit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A square matrix and, beside it, the same bits one by one.
    fn squares() -> impl Strategy<Value = (BitMatrix, Vec<Vec<bool>>)> {
        (0usize..150).prop_flat_map(|n| {
            proptest::collection::vec((0..n.max(1), 0..n.max(1)), 0..60).prop_map(move |on| {
                let (mut matrix, mut plain) = (BitMatrix::new(n, n), vec![vec![false; n]; n]);
                for (i, j) in on.into_iter().filter(|_| n > 0) {
                    matrix.set(i, j, true);
                    plain[i][j] = true;
                }
                (matrix, plain)
            })
        })
    }

    fn plain_is_symmetric(plain: &[Vec<bool>]) -> bool {
        (0..plain.len()).all(|i| (0..i).all(|j| plain[i][j] == plain[j][i]))
    }

    proptest! {
        #[test]
        fn bits_read_as_written((matrix, plain) in squares()) {
            for (i, row) in plain.iter().enumerate() {
                let expected: Vec<usize> = (0..row.len()).filter(|&j| row[j]).collect();
                prop_assert_eq!(matrix.iter_ones(i).collect::<Vec<_>>(), expected.clone());
                prop_assert_eq!(matrix.count_row(i), expected.len() as u64);
                prop_assert!((0..row.len()).all(|j| matrix.get(i, j) == row[j]));
            }
            let all = plain.iter().flatten().filter(|&&b| b).count();
            prop_assert_eq!(matrix.count_ones(), all as u64);
            prop_assert_eq!(matrix.first_stray(), None);
        }

        #[test]
        fn symmetry_is_what_the_plain_bits_say((matrix, plain) in squares()) {
            prop_assert_eq!(matrix.is_symmetric(), plain_is_symmetric(&plain));
            if let Some((i, j)) = matrix.first_asymmetry() {
                prop_assert!(plain[i][j] != plain[j][i], "({}, {}) is symmetric", i, j);
            }
        }

        /// Mirroring gives a symmetric matrix; with one bit less it no longer is.
        #[test]
        fn mirroring_sets_the_upper_triangle((mut matrix, plain) in squares(), at in any::<(usize, usize)>()) {
            let n = plain.len();
            let places = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            places().filter(|(i, j)| j > i).for_each(|(i, j)| matrix.set(i, j, false));
            matrix.mirror_lower();
            for (i, j) in places() {
                prop_assert_eq!(matrix.get(i, j), plain[i.max(j)][i.min(j)]);
            }
            prop_assert!(matrix.is_symmetric() && matrix.first_stray().is_none());
            if n > 1 {
                let (i, j) = (at.0 % n, (at.0 % n + 1 + at.1 % (n - 1)) % n);
                let mut symmetric = BitMatrix::identity(n);
                symmetric.set(i, j, true);
                prop_assert!(!symmetric.is_symmetric());
                symmetric.set(j, i, true);
                prop_assert!(symmetric.is_symmetric());
            }
        }

        #[test]
        fn union_has_the_ones_of_both((mut matrix, plain) in squares(), at in any::<(usize, usize)>()) {
            let n = plain.len();
            prop_assume!(n > 0);
            let (t, s) = (at.0 % n, at.1 % n);
            let mut words = matrix.row(t).to_vec();
            or_words(&mut words, matrix.row(s));
            matrix.or_into(t, s);
            prop_assert_eq!(matrix.row(t), &words[..]);
            prop_assert!((0..n).all(|j| matrix.get(t, j) == (plain[t][j] || plain[s][j])));
        }
    }

    #[test]
    fn strays_are_found() {
        let mut matrix = BitMatrix::identity(3);
        assert_eq!(matrix.first_stray(), None);
        matrix.row_mut(1)[0] |= 1 << 3;
        assert_eq!(matrix.first_stray(), Some(1));
        assert!(!BitMatrix::new(2, 3).is_symmetric());
        assert!(BitMatrix::default().is_symmetric());
    }
}
