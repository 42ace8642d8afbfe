//! Codings of rows of bits that were measured: what Quake does, and what can be done before zstd.
//!
//! Files of `packed` have the plain bits of blocks through zstd. These are what that was held against.

use sightlines::pvs::BitMatrix;
use std::io;

/// What is done to the bits of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowCoding {
    /// The bits as they are.
    Plain,
    /// Each row but the first xor the row above it.
    Above,
    /// Each bit xor those to the left, above, and above to the left: only corners of rectangles are ones.
    Corners,
}

impl RowCoding {
    /// All codings, the simplest first.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Above, Self::Corners];

    /// Codes the rows of a tile, `stride` words each, `n_cols` columns. O(words).
    pub fn forward(self, words: &mut [u64], stride: usize, n_cols: usize) {
        if stride == 0 || self == Self::Plain {
            return;
        }
        for at in (stride..words.len()).rev() {
            words[at] ^= words[at - stride];
        }
        if self == Self::Corners {
            for row in words.chunks_exact_mut(stride) {
                let mut before = 0;
                for word in row.iter_mut() {
                    let left = *word << 1 | before;
                    before = *word >> 63;
                    *word ^= left;
                }
                row[stride - 1] &= last_mask(n_cols);
            }
        }
    }

    /// Takes [`RowCoding::forward`] back; bits past the last column are zero afterwards. O(words).
    pub fn backward(self, words: &mut [u64], stride: usize, n_cols: usize) {
        if stride == 0 {
            return;
        }
        if self == Self::Corners {
            for row in words.chunks_exact_mut(stride) {
                let mut odd = 0u64;
                for word in row.iter_mut() {
                    // Each bit becomes the parity of itself and all bits to its left.
                    for half in [1, 2, 4, 8, 16, 32] {
                        *word ^= *word << half;
                    }
                    *word ^= odd;
                    odd = 0u64.wrapping_sub(*word >> 63);
                }
            }
        }
        if self != Self::Plain {
            for at in stride..words.len() {
                words[at] ^= words[at - stride];
            }
        }
        let mask = last_mask(n_cols);
        words.chunks_exact_mut(stride).for_each(|row| row[stride - 1] &= mask);
    }
}

/// The bits of the last word of a row that belong to columns.
fn last_mask(n_cols: usize) -> u64 {
    match n_cols % 64 {
        0 => u64::MAX,
        used => !(u64::MAX << used),
    }
}

/// The rows of a matrix in blocks, coded, through zstd.
pub struct CodedRows {
    coding: RowCoding,
    per_block: usize,
    n_columns: usize,
    blocks: Vec<Vec<u8>>,
}

impl CodedRows {
    /// How hard zstd tries: as in files.
    const LEVEL: i32 = 15;

    /// Codes a matrix, `per_block` rows together.
    ///
    /// # Errors
    /// If zstd refuses.
    ///
    /// # Panics
    /// If `per_block` is 0.
    pub fn new(bits: &BitMatrix, coding: RowCoding, per_block: usize) -> io::Result<Self> {
        let (n, n_columns) = (bits.n_rows(), bits.n_cols());
        let mut blocks = Vec::new();
        for begin in (0..n).step_by(per_block) {
            let mut words: Vec<u64> = (begin..n.min(begin + per_block)).flat_map(|i| bits.row(i)).copied().collect();
            coding.forward(&mut words, n_columns.div_ceil(64), n_columns);
            let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
            blocks.push(zstd::bulk::compress(&bytes, Self::LEVEL)?);
        }
        Ok(Self { coding, per_block, n_columns, blocks })
    }

    /// Bytes of all blocks, and twelve for finding each.
    pub fn n_bytes(&self) -> usize {
        self.blocks.iter().map(|block| block.len() + 12).sum()
    }

    /// Unpacks the block of a row, as reading it for the first time does, and puts the row into `out`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize, out: &mut Vec<u64>) {
        let stride = self.n_columns.div_ceil(64);
        let (block, within) = (&self.blocks[row / self.per_block], row % self.per_block);
        let bytes = zstd::bulk::decompress(block, 8 * stride * self.per_block).expect("what was packed unpacks");
        let word = |bytes: &[u8]| u64::from_le_bytes(std::array::from_fn(|i| bytes[i]));
        let mut words: Vec<u64> = bytes.chunks_exact(8).map(word).collect();
        self.coding.backward(&mut words, stride, self.n_columns);
        out.clear();
        out.extend_from_slice(&words[within * stride..(within + 1) * stride]);
    }
}

/// Quake's coding of a row of `n` bits: a byte 0 is followed by how many there are.
pub fn zero_runs(row: &[u64], n: usize) -> Vec<u8> {
    let bytes = row.iter().flat_map(|word| word.to_le_bytes()).take(n.div_ceil(8));
    let mut out: Vec<u8> = Vec::new();
    let mut zeros = 0u8;
    for byte in bytes.map(Some).chain([None]) {
        if zeros > 0 && (byte != Some(0) || zeros == u8::MAX) {
            out.extend([0, zeros]);
            zeros = 0;
        }
        match byte {
            Some(0) => zeros += 1,
            Some(byte) => out.push(byte),
            None => {}
        }
    }
    out
}

/// Takes [`zero_runs`] back into the words of a row.
pub fn unpack_runs(bytes: &[u8], n: usize, out: &mut Vec<u64>) {
    out.clear();
    out.resize(n.div_ceil(64), 0);
    let (mut at, mut bytes) = (0, bytes.iter());
    while let Some(&byte) = bytes.next() {
        match byte {
            0 => at += usize::from(bytes.next().copied().unwrap_or(0)),
            byte => {
                out[at / 8] |= u64::from(byte) << (at % 8 * 8);
                at += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_testkit::mutate::SplitMix;

    /// Matrices of all shapes, dense and sparse.
    fn matrices() -> impl Iterator<Item = BitMatrix> {
        (0..60).map(|seed| {
            let mut random = SplitMix::new(seed);
            let (n, m, rare) = (random.below(40), 1 + random.below(700), 1 + random.below(60));
            let mut bits = BitMatrix::new(n, m);
            (0..n).for_each(|i| (0..m).for_each(|j| bits.set(i, j, random.below(rare) == 0)));
            bits
        })
    }

    #[test]
    fn codings_are_taken_back() {
        let (mut n, mut out) = (0, Vec::new());
        for bits in matrices() {
            let m = bits.n_cols();
            for coding in RowCoding::ALL {
                let coded = CodedRows::new(&bits, coding, 16).unwrap();
                for i in 0..bits.n_rows() {
                    coded.row(i, &mut out);
                    assert_eq!(out, bits.row(i), "{coding:?}");
                    unpack_runs(&zero_runs(bits.row(i), m), m, &mut out);
                    assert_eq!(out, bits.row(i));
                    n += 1;
                }
            }
        }
        assert!(n > 1000, "{n} rows");
    }

    /// The oracle: the definition, bit by bit.
    #[test]
    fn codings_are_what_they_say() {
        let mut n = 0;
        for bits in matrices().filter(|bits| bits.n_rows() > 0) {
            let stride = bits.n_cols().div_ceil(64);
            let words: Vec<u64> = (0..bits.n_rows()).flat_map(|i| bits.row(i)).copied().collect();
            let was = |i: Option<usize>, j: Option<usize>| i.zip(j).is_some_and(|(i, j)| bits.get(i, j));
            for coding in RowCoding::ALL {
                let mut coded = words.clone();
                coding.forward(&mut coded, stride, bits.n_cols());
                for (i, j) in (0..bits.n_rows()).flat_map(|i| (0..bits.n_cols()).map(move |j| (i, j))) {
                    let (above, left) = (i.checked_sub(1), j.checked_sub(1));
                    let mut expected = bits.get(i, j);
                    if coding >= RowCoding::Above {
                        expected ^= was(above, Some(j));
                    }
                    if coding == RowCoding::Corners {
                        expected ^= was(Some(i), left) ^ was(above, left);
                    }
                    assert_eq!(coded[i * stride + j / 64] >> (j % 64) & 1 == 1, expected, "{coding:?} at {i} {j}");
                    n += 1;
                }
            }
        }
        assert!(n > 100_000, "{n} bits");
    }

    #[test]
    fn a_rectangle_has_four_corners() {
        let mut words = vec![0u64; 20];
        (3..7).for_each(|row| words[2 * row] = 0xFF00);
        let count = |coding: RowCoding| {
            let mut coded = words.clone();
            coding.forward(&mut coded, 2, 128);
            coded.iter().map(|word| word.count_ones()).sum::<u32>()
        };
        assert_eq!(RowCoding::ALL.map(count), [32, 16, 4]);
    }
}
