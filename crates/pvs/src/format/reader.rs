//! Reads the fields of a section and never past its end.

use super::container::{Section, array};
use super::error::{DecodeError, DecodeErrorKind as Kind};
use crate::BitMatrix;

/// A position in a section.
pub(super) struct Reader<'a> {
    section: Section<'a>,
    at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(section: Section<'a>) -> Self {
        Self { section, at: 0 }
    }

    /// An error about the `back` bytes just read.
    pub(super) fn fail(&self, back: usize, kind: Kind) -> DecodeError {
        DecodeError { section: Some(self.section.id), offset: (self.section.offset + self.at - back) as u64, kind }
    }

    fn left(&self) -> usize {
        self.section.bytes.len() - self.at
    }

    /// Checks that `n` items of `size` bytes can follow; called before memory is allocated for them.
    pub(super) fn expect(&self, n: u64, size: usize) -> Result<(), DecodeError> {
        let (need, left) = (n.saturating_mul(size as u64), self.left() as u64);
        if need > left { Err(self.fail(0, Kind::Cut { need, left })) } else { Ok(()) }
    }

    pub(super) fn take(&mut self, n: usize) -> Result<&'a [u8], DecodeError> {
        self.expect(n as u64, 1)?;
        self.at += n;
        Ok(&self.section.bytes[self.at - n..self.at])
    }

    pub(super) fn u32(&mut self) -> Result<u32, DecodeError> {
        Ok(u32::from_le_bytes(array(self.take(4)?, 0)))
    }

    pub(super) fn u64(&mut self) -> Result<u64, DecodeError> {
        Ok(u64::from_le_bytes(array(self.take(8)?, 0)))
    }

    /// A number in groups of seven bits per byte, the lowest first; refused if it is longer than necessary.
    pub(super) fn varint(&mut self) -> Result<u64, DecodeError> {
        let mut x = 0u64;
        for k in 0..10 {
            let byte = self.take(1)?[0];
            let bits = u64::from(byte & 0x7f);
            let fits = bits << (7 * k) >> (7 * k) == bits;
            if !fits || (k > 0 && byte == 0) {
                return Err(self.fail(k + 1, Kind::Number));
            }
            x |= bits << (7 * k);
            if byte & 0x80 == 0 {
                return Ok(x);
            }
        }
        Err(self.fail(10, Kind::Number))
    }

    pub(super) fn f64(&mut self) -> Result<f64, DecodeError> {
        Ok(f64::from_bits(self.u64()?))
    }

    /// A count of items that take at least `size` bytes each; checked to fit the section.
    pub(super) fn count(&mut self, size: usize) -> Result<usize, DecodeError> {
        let n = self.u32()?;
        self.expect(u64::from(n), size)?;
        // It fits: no slice has more than `usize::MAX` bytes, and `size` is at least 1.
        Ok(n as usize)
    }

    /// All words of a matrix, row by row; both numbers are below 2^32.
    pub(super) fn rows(&mut self, n_rows: usize, n_cols: usize) -> Result<BitMatrix, DecodeError> {
        self.expect(n_rows as u64 * n_cols.div_ceil(64) as u64, 8)?;
        let mut rows = BitMatrix::new(n_rows, n_cols);
        for i in 0..n_rows {
            for word in rows.row_mut(i) {
                *word = self.u64()?;
            }
        }
        Ok(rows)
    }

    /// `n` numbers; memory is allocated after a check.
    pub(super) fn u32s(&mut self, n: u64) -> Result<Vec<u32>, DecodeError> {
        self.expect(n, 4)?;
        (0..n).map(|_| self.u32()).collect()
    }

    /// A point with `d` coordinates; the others are 0.
    pub(super) fn point(&mut self, d: usize) -> Result<[f64; 3], DecodeError> {
        let mut p = [0.0; 3];
        for x in &mut p[..d] {
            *x = self.f64()?;
        }
        Ok(p)
    }

    pub(super) fn text(&mut self) -> Result<String, DecodeError> {
        let n = self.count(1)?;
        let bytes = self.take(n)?;
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(text.to_owned()),
            Err(error) => Err(self.fail(n - error.valid_up_to(), Kind::Text)),
        }
    }

    /// Checks that the section ends here.
    pub(super) fn finish(self) -> Result<(), DecodeError> {
        match self.left() {
            0 => Ok(()),
            left => Err(self.fail(0, Kind::Surplus { left: left as u64 })),
        }
    }
}

/// Reads a whole section.
pub(super) fn read<'a, T>(
    section: Section<'a>,
    parse: impl FnOnce(&mut Reader<'a>) -> Result<T, DecodeError>,
) -> Result<T, DecodeError> {
    let mut reader = Reader::new(section);
    let value = parse(&mut reader)?;
    reader.finish()?;
    Ok(value)
}
