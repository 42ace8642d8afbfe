//! Numbers as bytes, and a reader that never reads past the end.

use crate::error::{PackedError, PackedErrorKind as Kind};
use sightlines_pvs::SectionId;

/// Writes little-endian numbers.
#[derive(Default)]
pub(crate) struct Writer(pub(crate) Vec<u8>);

impl Writer {
    pub(crate) fn u32(&mut self, x: u32) {
        self.0.extend(x.to_le_bytes());
    }

    pub(crate) fn u64(&mut self, x: u64) {
        self.0.extend(x.to_le_bytes());
    }

    pub(crate) fn floats(&mut self, xs: &[f64]) {
        xs.iter().for_each(|x| self.u64(x.to_bits()));
    }

    /// Seven bits per byte, the low ones first; the top bit is set if more follow.
    pub(crate) fn varint(&mut self, mut x: u64) {
        while x >= 0x80 {
            self.0.push(x as u8 | 0x80);
            x >>= 7;
        }
        self.0.push(x as u8);
    }

    /// An ascending list: its length, then its differences minus one.
    pub(crate) fn ascending(&mut self, list: impl ExactSizeIterator<Item = u32>) {
        self.varint(list.len() as u64);
        let mut next = 0;
        for x in list {
            self.varint(u64::from(x) - next);
            next = u64::from(x) + 1;
        }
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.varint(text.len() as u64);
        self.0.extend_from_slice(text.as_bytes());
    }
}

/// The origin of bytes, for errors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin {
    pub(crate) section: SectionId,
    pub(crate) offset: u64,
}

impl Origin {
    pub(crate) fn fail(self, kind: Kind) -> PackedError {
        PackedError::new(Some(self.section), self.offset, kind)
    }
}

/// Reads the output of [`Writer`].
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    place: Origin,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8], place: Origin) -> Self {
        Self { bytes, place }
    }

    pub(crate) fn fail(&self, kind: Kind) -> PackedError {
        self.place.fail(kind)
    }

    fn impossible(&self, value: u64) -> PackedError {
        self.fail(Kind::Value { value })
    }

    pub(crate) fn left(&self) -> usize {
        self.bytes.len()
    }

    pub(crate) fn take(&mut self, n: usize) -> Result<&'a [u8], PackedError> {
        let (head, rest) = self.bytes.split_at_checked(n).ok_or_else(|| self.fail(Kind::Cut))?;
        self.bytes = rest;
        Ok(head)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, PackedError> {
        Ok(u32_at(self.take(4)?, 0))
    }

    pub(crate) fn f64(&mut self) -> Result<f64, PackedError> {
        Ok(f64_at(self.take(8)?, 0))
    }

    /// A point with `d` coordinates; the others are 0.
    pub(crate) fn point(&mut self, d: usize) -> Result<[f64; 3], PackedError> {
        let mut p = [0.0; 3];
        for x in &mut p[..d] {
            *x = self.f64()?;
        }
        Ok(p)
    }

    pub(crate) fn varint(&mut self) -> Result<u64, PackedError> {
        let mut x = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.take(1)?[0];
            let bits = u64::from(byte & 0x7F);
            if shift == 63 && bits > 1 {
                break;
            }
            x |= bits << shift;
            if byte < 0x80 {
                return Ok(x);
            }
        }
        Err(self.impossible(u64::MAX))
    }

    /// A number below `limit`.
    pub(crate) fn below(&mut self, limit: u64) -> Result<u32, PackedError> {
        let x = self.varint()?;
        u32::try_from(x).ok().filter(|_| x < limit).ok_or_else(|| self.impossible(x))
    }

    /// The number of items that follow, each of at least `size` bytes; they fit the remaining bytes.
    pub(crate) fn count(&mut self, size: usize) -> Result<usize, PackedError> {
        let n = self.varint()?;
        if n.saturating_mul(size.max(1) as u64) > self.left() as u64 {
            return Err(self.fail(Kind::Cut));
        }
        Ok(n as usize)
    }

    /// Calls `visit` for each number of an ascending list of numbers below `limit`.
    pub(crate) fn ascending(&mut self, limit: u64, mut visit: impl FnMut(u32)) -> Result<(), PackedError> {
        let n = self.count(1)?;
        let mut next = 0u64;
        for _ in 0..n {
            let x = next.saturating_add(self.varint()?);
            visit(u32::try_from(x).ok().filter(|_| x < limit).ok_or_else(|| self.impossible(x))?);
            next = x + 1;
        }
        Ok(())
    }

    pub(crate) fn text(&mut self) -> Result<&'a str, PackedError> {
        let n = self.count(1)?;
        std::str::from_utf8(self.take(n)?).map_err(|_| self.fail(Kind::Text))
    }

    /// Checks that no bytes are left.
    pub(crate) fn finish(self) -> Result<(), PackedError> {
        match self.left() {
            0 => Ok(()),
            left => Err(self.fail(Kind::Surplus { left: left as u64 })),
        }
    }
}

/// The number at byte `at`, which must exist.
#[inline]
pub(crate) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]))
}

/// The number at byte `at`, which must exist.
#[inline]
pub(crate) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]))
}

/// The number at byte `at`, which must exist.
#[inline]
pub(crate) fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_bits(u64_at(bytes, at))
}

/// Words as little-endian bytes.
pub(crate) fn bytes_of(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// Little-endian bytes as words; an incomplete last word is dropped.
pub(crate) fn words_of(bytes: &[u8]) -> Vec<u64> {
    bytes.chunks_exact(8).map(|word| u64_at(word, 0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PLACE: Origin = Origin { section: SectionId(*b"TEST"), offset: 7 };

    proptest! {
        #[test]
        fn numbers_and_lists_come_back(x in any::<u64>(), shift in 0u32..64, list in prop::collection::btree_set(any::<u32>(), 0..9)) {
            let list: Vec<u32> = list.into_iter().collect();
            let mut out = Writer::default();
            out.varint(x >> shift);
            out.ascending(list.iter().copied());
            out.text("ä");
            let mut r = Reader::new(&out.0, PLACE);
            prop_assert_eq!(r.varint().unwrap(), x >> shift);
            let mut read = Vec::new();
            r.ascending(1 << 32, |x| read.push(x)).unwrap();
            prop_assert_eq!(&read, &list);
            prop_assert_eq!(r.text().unwrap(), "ä");
            r.finish().unwrap();
            // The twin: the list is refused if its last number is too large.
            if let Some(&last) = list.last() {
                let mut r = Reader::new(&out.0, PLACE);
                r.varint().unwrap();
                let cut = r.ascending(u64::from(last), |_| ());
                prop_assert!(cut.is_err());
            }
            for n in 0..out.0.len() {
                let mut r = Reader::new(&out.0[..n], PLACE);
                let all = r.varint().and_then(|_| r.ascending(1 << 32, |_| {})).and_then(|()| r.text().map(drop));
                prop_assert!(all.is_err());
            }
        }

        #[test]
        fn garbage_is_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
            let mut r = Reader::new(&bytes, PLACE);
            let mut n = 0;
            let _ = r.ascending(1 << 32, |_| n += 1);
            prop_assert!(n <= bytes.len());
            let mut r = Reader::new(&bytes, PLACE);
            while let Ok(x) = r.varint() {
                prop_assert!(x < u64::MAX || bytes.len() >= 10);
            }
        }
    }

    #[test]
    fn numbers_of_more_than_64_bits_are_refused() {
        let mut bytes = vec![0xFF; 9];
        bytes.push(1);
        assert_eq!(Reader::new(&bytes, PLACE).varint().unwrap(), u64::MAX);
        bytes[9] = 2;
        assert!(Reader::new(&bytes, PLACE).varint().is_err());
        bytes[9] = 0x81;
        bytes.push(0);
        assert!(Reader::new(&bytes, PLACE).varint().is_err());
    }
}
