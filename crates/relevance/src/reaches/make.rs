//! Products of matrices of bits, reach by reach.

use super::{Nibbles, ReachOptions, WhoMoves, nibble, set_nibble};
use crate::distance::{Boxes, Distances, Walk, is_within};
use sightlines_pvs::Table;
use sightlines_pvs::bits::or_words;
use std::num::NonZero;

/// A square matrix of bits in rows of words.
struct Square {
    n: usize,
    stride: usize,
    words: Vec<u64>,
}

impl Square {
    fn new(n: usize) -> Self {
        let stride = n.div_ceil(64);
        Self { n, stride, words: vec![0; n * stride] }
    }

    fn row(&self, i: usize) -> &[u64] {
        &self.words[i * self.stride..(i + 1) * self.stride]
    }

    /// Writes the transpose of another matrix, in blocks of 64 × 64.
    fn transpose_of(&mut self, other: &Self, threads: usize) {
        let (n, stride) = (self.n, self.stride);
        in_rows(&mut self.words, 64 * stride, threads, |block, rows| {
            for word in 0..n.div_ceil(64) {
                let mut bits = [0u64; 64];
                for (i, b) in bits.iter_mut().enumerate().take(n - 64 * word) {
                    *b = other.row(64 * word + i)[block];
                }
                transpose(&mut bits);
                rows.chunks_mut(stride).zip(bits).for_each(|(row, b)| row[word] = b);
            }
        });
    }
}

/// Transposes a block of bits in place: six rounds that swap halves (Warren, "Hacker's Delight", 2nd edition, section 7-3).
fn transpose(bits: &mut [u64; 64]) {
    let (mut width, mut mask) = (32, 0x0000_0000_ffff_ffff_u64);
    while width != 0 {
        let mut k = 0;
        while k < 64 {
            let swap = (bits[k] >> width ^ bits[k + width]) & mask;
            bits[k] ^= swap << width;
            bits[k + width] ^= swap;
            k = (k + width + 1) & !width;
        }
        width /= 2;
        mask ^= mask << width;
    }
}

/// Does `work` with pieces of a matrix, each of `len` items but the last, on several threads; it is given the index of the piece.
fn in_rows<T: Send>(all: &mut [T], len: usize, threads: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    if all.is_empty() {
        return;
    }
    let n_pieces = all.len().div_ceil(len);
    let each = n_pieces.div_ceil(threads);
    std::thread::scope(|scope| {
        for (t, part) in all.chunks_mut(each * len).enumerate() {
            let work = &work;
            scope.spawn(move || part.chunks_mut(len).enumerate().for_each(|(i, piece)| work(t * each + i, piece)));
        }
    });
}

/// The index of the first reach at which each pair may see each other, or the number of reaches.
pub(super) fn first_rungs(table: &Table, boxes: &Boxes, reaches: &[f64], options: &ReachOptions) -> Nibbles {
    let n = table.n_cells();
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, NonZero::get),
        some => some.min(n.max(1)),
    };
    let none = reaches.len() as u8;
    let mut first = Nibbles::new(n, none);
    in_rows(&mut first.bytes, first.stride, threads, |i, row| {
        table.visible(sightlines_pvs::CellId(i as u32)).for_each(|j| set_nibble(row, j.idx(), 0));
    });
    if n == 0 || reaches.len() == 1 {
        return first;
    }
    let steps = steps(table, boxes, reaches, options, threads);
    let visible = |k: usize| table.row(sightlines_pvs::CellId(k as u32));
    // What is seen from where the first may get: grows from reach to reach.
    let mut moved = Square::new(n);
    let stride = moved.stride;
    in_rows(&mut moved.words, stride, threads, |i, row| row.copy_from_slice(visible(i)));
    let mut across = Square::new(if options.movers == WhoMoves::Both { n } else { 0 });
    for reach in 1..none {
        in_rows(&mut moved.words, stride, threads, |i, row| {
            let from = steps.row(i);
            (0..n).filter(|&k| nibble(from, k) == reach).for_each(|k| or_words(row, visible(k)));
        });
        if options.movers == WhoMoves::Both {
            across.transpose_of(&moved, threads);
        }
        in_rows(&mut first.bytes, n.div_ceil(2), threads, |i, row| {
            let mut seen = moved.row(i).to_vec();
            if options.movers == WhoMoves::Both {
                let from = steps.row(i);
                for k in (0..n).filter(|&k| k != i && nibble(from, k) <= reach) {
                    or_words(&mut seen, across.row(k));
                }
                or_words(&mut seen, across.row(i));
            }
            for j in sightlines_pvs::bits::ones(&seen) {
                if nibble(row, j) == none {
                    set_nibble(row, j, reach);
                }
            }
        });
    }
    first
}

/// The index of the first reach within which each cell can be got to from each: 0 for a cell itself alone.
fn steps(table: &Table, boxes: &Boxes, reaches: &[f64], options: &ReachOptions, threads: usize) -> Nibbles {
    let n = table.n_cells();
    let distances = Distances::new(table, boxes, options.ways);
    let most = reaches[reaches.len() - 1];
    let mut steps = Nibbles::new(n, reaches.len() as u8);
    let len = steps.stride * n.div_ceil(64 * threads).max(1);
    let stride = steps.stride;
    in_rows(&mut steps.bytes, len, threads, |piece, rows| {
        let mut walk = Walk::default();
        for (i, row) in rows.chunks_mut(stride).enumerate() {
            let i = piece * (len / stride) + i;
            set_nibble(row, i, 0);
            distances.each_within(i as u32, most, &mut walk, |k, far| {
                let step = 1 + reaches[1..].iter().take_while(|&&reach| !is_within(far, reach)).count();
                set_nibble(row, k as usize, step as u8);
            });
        }
    });
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_transposed() {
        let mut random = sightlines_geometry::Random::new(1);
        let before: [u64; 64] = std::array::from_fn(|_| random.bits());
        let mut after = before;
        transpose(&mut after);
        let bit = |rows: &[u64; 64], i: usize, j: usize| rows[i] >> j & 1;
        assert!((0..64).all(|i| (0..64).all(|j| bit(&before, i, j) == bit(&after, j, i))));
        let n = 130;
        let mut square = Square::new(n);
        (0..n).for_each(|i| {
            (0..n).filter(|j| (i * j + i) % 7 == 3).for_each(|j| square.words[i * 3 + j / 64] |= 1 << (j % 64))
        });
        let mut across = Square::new(n);
        across.transpose_of(&square, 3);
        assert!((0..n).all(|i| (0..n).all(|j| square.row(i)[j / 64] >> (j % 64) & 1 == across.row(j)[i / 64] >> (i % 64) & 1)));
    }
}
