//! Numbers and texts as bytes.

use crate::BitMatrix;

/// The bytes of a section under construction.
#[derive(Default)]
pub(super) struct Writer(pub(super) Vec<u8>);

impl Writer {
    pub(super) fn u32(&mut self, x: u32) {
        self.0.extend(x.to_le_bytes());
    }

    /// A count; [`crate::Table::new`] has checked that it fits.
    pub(super) fn count(&mut self, n: usize) {
        self.u32(u32::try_from(n).expect("a checked table counts with 32 bits"));
    }

    /// Seven bits per byte, the lowest first; the high bit is set if another byte follows.
    pub(super) fn varint(&mut self, mut x: u64) {
        while x >= 0x80 {
            self.0.push(x as u8 | 0x80);
            x >>= 7;
        }
        self.0.push(x as u8);
    }

    pub(super) fn floats(&mut self, xs: &[f64]) {
        xs.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
    }

    pub(super) fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend_from_slice(text.as_bytes());
    }

    /// All words of a matrix, row by row.
    pub(super) fn rows(&mut self, rows: &BitMatrix) {
        self.0.reserve_exact((0..rows.n_rows()).map(|i| 8 * rows.row(i).len()).sum());
        (0..rows.n_rows()).flat_map(|i| rows.row(i)).for_each(|word| self.0.extend(word.to_le_bytes()));
    }
}
