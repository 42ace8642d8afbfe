//! The bytes of proofs: numbers with seven bits to a byte, doubles, lists, and a frame with a checksum around them.

use num_bigint::{BigInt, Sign};

/// The first bytes of every proof file.
const MAGIC: [u8; 8] = *b"SLPROOFS";
/// The newest version: with proofs about objects, which only scenes in space have, or with lines of two doubles, which only maps
/// have.
pub const VERSION: u32 = 2;
/// The version before: without these. Proofs that have none are written in it, and both are read.
pub(crate) const FIRST_VERSION: u32 = 1;
/// Magic, version, kind; then the body; then the checksum.
const HEAD: usize = 8 + 4 + 1;

/// Why bytes are not proofs, and where they are wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("byte {offset}: {kind}")]
pub struct ReadError {
    /// Byte offset from the beginning.
    pub offset: usize,
    /// What is wrong there.
    pub kind: ReadErrorKind,
}

/// What is wrong with bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// The first bytes are not those of proofs.
    #[error("these are no proofs of a table")]
    Magic,
    /// Another version.
    #[error("version {0} of the format; this reader knows versions 1 and 2")]
    Version(u32),
    /// Proofs for an unknown kind of table.
    #[error("proofs of kind {0}, which is not known")]
    Kind(u8),
    /// The bytes end too early, or announce more items than the rest can hold.
    #[error("{need} bytes are needed and {left} are left")]
    Cut {
        /// Bytes needed.
        need: u64,
        /// Bytes left.
        left: u64,
    },
    /// A number that is not written in the shortest form, or is out of range.
    #[error("a number is out of range")]
    Number,
    /// A double that is not a valid coordinate.
    #[error("a number is no coordinate")]
    Coordinate,
    /// An undefined code.
    #[error("code {0} means nothing here")]
    Code(u8),
    /// Bytes after the end.
    #[error("{0} bytes too many")]
    Trailing(u64),
    /// Damaged.
    #[error("the checksum is wrong: the file is damaged")]
    Checksum,
    /// Proofs that are nested deeper than the format allows.
    #[error("proofs are nested too deeply")]
    Depth,
}

/// Which kind of table proofs are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Of a plan: polygons joined by segments.
    Planar,
    /// Of a scene in space cut into boxes.
    Axial,
    /// Of convex cells in space, as Quake maps have them.
    Convex,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Planar, Self::Axial, Self::Convex];

    const fn code(self) -> u8 {
        match self {
            Self::Planar => 1,
            Self::Axial => 2,
            Self::Convex => 3,
        }
    }
}

/// Puts a frame around a body.
pub(crate) fn framed(kind: Kind, version: u32, body: Writer) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + body.0.len() + 4);
    bytes.extend(MAGIC);
    bytes.extend(version.to_le_bytes());
    bytes.push(kind.code());
    bytes.extend(body.0);
    let checksum = crc32fast::hash(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// The kind of proofs and a reader at the beginning of their body, after a check of frame and checksum.
pub(crate) fn unframed(bytes: &[u8]) -> Result<(Kind, Reader<'_>), ReadError> {
    let fail = |offset, kind| Err(ReadError { offset, kind });
    if bytes.len() < HEAD + 4 {
        let (need, left) = ((HEAD + 4) as u64, bytes.len() as u64);
        let is_ours = bytes.iter().zip(&MAGIC).all(|(a, b)| a == b);
        return fail(0, if is_ours { ReadErrorKind::Cut { need, left } } else { ReadErrorKind::Magic });
    }
    if bytes[..8] != MAGIC {
        return fail(0, ReadErrorKind::Magic);
    }
    let four = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let version = four(8);
    if !(FIRST_VERSION..=VERSION).contains(&version) {
        return fail(8, ReadErrorKind::Version(version));
    }
    let end = bytes.len() - 4;
    if crc32fast::hash(&bytes[..end]) != four(end) {
        return fail(end, ReadErrorKind::Checksum);
    }
    match Kind::ALL.into_iter().find(|kind| kind.code() == bytes[12]) {
        Some(kind) if version != FIRST_VERSION && kind == Kind::Planar => fail(8, ReadErrorKind::Version(version)),
        Some(kind) => Ok((kind, Reader { bytes: &bytes[..end], at: HEAD, version })),
        None => fail(12, ReadErrorKind::Kind(bytes[12])),
    }
}

/// Reads the frame of proofs of a kind: the checksum of their network, and a reader of what follows it.
pub(crate) fn unframed_of(kind: Kind, bytes: &[u8]) -> Result<(u32, Reader<'_>), ReadError> {
    let (own, mut reader) = unframed(bytes)?;
    if own != kind {
        return Err(ReadError { offset: 12, kind: ReadErrorKind::Kind(own.code()) });
    }
    let four = reader.bytes(4)?;
    Ok((u32::from_le_bytes([four[0], four[1], four[2], four[3]]), reader))
}

/// Something that can be written as bytes and read back.
pub(crate) trait Coded: Sized {
    /// The least number of bytes that it takes. This limits the length of lists that are read.
    const LEAST: usize;

    fn write(&self, writer: &mut Writer);

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError>;
}

/// Collects bytes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Writer(Vec<u8>);

impl Writer {
    /// A body that begins with the checksum of a network.
    pub(crate) fn for_network(checksum: u32) -> Self {
        Self(checksum.to_le_bytes().to_vec())
    }

    /// The bytes, without a frame.
    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    pub(crate) fn byte(&mut self, x: u8) {
        self.0.push(x);
    }

    pub(crate) fn number(&mut self, x: impl Into<u64>) {
        let mut x = x.into();
        while x > 0x7f {
            self.0.push(x as u8 | 0x80);
            x >>= 7;
        }
        self.0.push(x as u8);
    }

    pub(crate) fn size(&mut self, n: usize) {
        self.number(n as u64);
    }

    /// The number of items, then the items.
    pub(crate) fn list<T: Coded>(&mut self, items: &[T]) {
        self.size(items.len());
        for item in items {
            item.write(self);
        }
    }

    /// Ascending pairs: the difference to the first number of the pair before, then the second number or, if the first is
    /// the same, its difference.
    pub(crate) fn pairs(&mut self, pairs: &[[u32; 2]]) {
        self.size(pairs.len());
        let mut before = [0, 0];
        for &[a, b] in pairs {
            let step = a.wrapping_sub(before[0]);
            self.number(step);
            self.number(if step == 0 { b.wrapping_sub(before[1]) } else { b });
            before = [a, b];
        }
    }

    /// Coordinates, given by their bits, in eight bytes each if `wide`, else in four.
    pub(crate) fn coordinates(&mut self, bits: &[u64], wide: bool) {
        bits.iter().for_each(|&x| self.double(f64::from_bits(x), wide));
    }

    /// A double in eight bytes if `wide`, else in four.
    pub(crate) fn double(&mut self, x: f64, wide: bool) {
        if wide {
            self.0.extend(x.to_le_bytes());
        } else {
            self.0.extend((x as f32).to_le_bytes());
        }
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
    }

    pub(crate) fn whole(&mut self, x: &BigInt) {
        let bytes = x.magnitude().to_bytes_le();
        let n = if x.sign() == Sign::NoSign { 0 } else { bytes.len() };
        self.size(2 * n + usize::from(x.sign() == Sign::Minus));
        self.0.extend(&bytes[..n]);
    }
}

/// Whether four bytes hold a double without loss.
pub(crate) fn is_narrow(x: f64) -> bool {
    f64::from(x as f32) == x
}

/// Whether some coordinate, given by its bits, needs eight bytes.
pub(crate) fn is_wide(bits: &[u64]) -> bool {
    !bits.iter().all(|&x| is_narrow(f64::from_bits(x)))
}

/// Reads bytes, never past their end.
#[derive(Debug, Clone)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    version: u32,
}

impl<'a> Reader<'a> {
    /// Reads bytes without a frame, as [`Writer::into_bytes`] gives them, in the newest version.
    pub(crate) const fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, version: VERSION }
    }

    /// Whether the frame has the newest version, and not the first one.
    pub(crate) fn is_newer(&self) -> bool {
        self.version > FIRST_VERSION
    }

    /// An error at the offset `back` bytes before the current one.
    pub(crate) fn fail<T>(&self, back: usize, kind: ReadErrorKind) -> Result<T, ReadError> {
        Err(ReadError { offset: self.at - back, kind })
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        let left = self.bytes.len() - self.at;
        if n > left {
            return self.fail(0, ReadErrorKind::Cut { need: n as u64, left: left as u64 });
        }
        self.at += n;
        Ok(&self.bytes[self.at - n..self.at])
    }

    pub(crate) fn byte(&mut self) -> Result<u8, ReadError> {
        Ok(self.take(1)?[0])
    }

    /// A number below 2^32.
    pub(crate) fn number(&mut self) -> Result<u32, ReadError> {
        let mut x = 0u64;
        for k in 0..5 {
            let byte = self.byte()?;
            x |= u64::from(byte & 0x7f) << (7 * k);
            if byte & 0x80 == 0 {
                let is_short = k == 0 || byte != 0;
                return match u32::try_from(x) {
                    Ok(x) if is_short => Ok(x),
                    _ => self.fail(k + 1, ReadErrorKind::Number),
                };
            }
        }
        self.fail(5, ReadErrorKind::Number)
    }

    /// The number of items that follow, each of at least `size` bytes; refused if the rest is too short for them.
    pub(crate) fn count(&mut self, size: usize) -> Result<usize, ReadError> {
        let before = self.at;
        let n = self.number()? as usize;
        let (need, left) = ((n as u64).saturating_mul(size as u64), (self.bytes.len() - self.at) as u64);
        if need > left { self.fail(self.at - before, ReadErrorKind::Cut { need, left }) } else { Ok(n) }
    }

    /// The number of items, then the items.
    pub(crate) fn list<T: Coded>(&mut self) -> Result<Vec<T>, ReadError> {
        let n = self.count(T::LEAST)?;
        (0..n).map(|_| T::read(self)).collect()
    }

    /// Pairs as [`Writer::pairs`] writes them; refused unless they ascend.
    pub(crate) fn pairs(&mut self) -> Result<Vec<[u32; 2]>, ReadError> {
        let n = self.count(2)?;
        let mut before = [0u32, 0u32];
        let mut pairs = Vec::with_capacity(n);
        for k in 0..n {
            let [step, second] = [self.number()?, self.number()?];
            let base = if step == 0 { before[1] } else { 0 };
            let pair = before[0].checked_add(step).zip(base.checked_add(second)).map(|(a, b)| [a, b]);
            match pair.filter(|pair| k == 0 || *pair > before) {
                Some(pair) => pairs.push(pair),
                None => return self.fail(0, ReadErrorKind::Number),
            }
            before = pairs[k];
        }
        Ok(pairs)
    }

    /// Two points, by the bits of their coordinates, as [`Writer::coordinates`] writes them.
    pub(crate) fn points<const D: usize>(&mut self, wide: bool) -> Result<[[u64; D]; 2], ReadError> {
        let mut points = [[0; D]; 2];
        for x in points.as_flattened_mut() {
            *x = self.coordinate(wide)?.to_bits();
        }
        Ok(points)
    }

    /// A coordinate in eight bytes if `wide`, else in four.
    pub(crate) fn coordinate(&mut self, wide: bool) -> Result<f64, ReadError> {
        let n = if wide { 8 } else { 4 };
        let bytes = self.take(n)?;
        let x = if wide {
            f64::from_le_bytes(std::array::from_fn(|k| bytes[k]))
        } else {
            f64::from(f32::from_le_bytes(std::array::from_fn(|k| bytes[k])))
        };
        if crate::exact::is_coordinate(x) { Ok(x) } else { self.fail(n, ReadErrorKind::Coordinate) }
    }

    pub(crate) fn bytes(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        self.take(n)
    }

    pub(crate) fn whole(&mut self) -> Result<BigInt, ReadError> {
        let before = self.at;
        let n = self.number()? as usize;
        let bytes = self.take(n / 2)?;
        // Each number has one form only.
        if bytes.last() == Some(&0) || n == 1 {
            return self.fail(self.at - before, ReadErrorKind::Number);
        }
        let sign = if n % 2 == 1 { Sign::Minus } else { Sign::Plus };
        Ok(BigInt::from_bytes_le(sign, bytes))
    }

    /// Refuses bytes after the end.
    pub(crate) fn end(&self) -> Result<(), ReadError> {
        match self.bytes.len() - self.at {
            0 => Ok(()),
            n => self.fail(0, ReadErrorKind::Trailing(n as u64)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_come_back(x in any::<u32>(), y in any::<i128>(), z in -1e9f64..1e9) {
            let mut writer = Writer::default();
            writer.number(x);
            writer.whole(&BigInt::from(y));
            writer.double(z, true);
            writer.double(f64::from(z as f32), false);
            let bytes = framed(Kind::Axial, FIRST_VERSION, writer);
            let (kind, mut reader) = unframed(&bytes).unwrap();
            prop_assert_eq!(kind, Kind::Axial);
            prop_assert_eq!(reader.number().unwrap(), x);
            prop_assert_eq!(reader.whole().unwrap(), BigInt::from(y));
            prop_assert_eq!(reader.coordinate(true).unwrap(), z);
            prop_assert_eq!(reader.coordinate(false).unwrap(), f64::from(z as f32));
            prop_assert!(reader.end().is_ok());
        }
    }

    fn of(body: &[u8]) -> Vec<u8> {
        framed(Kind::Planar, FIRST_VERSION, Writer(body.to_vec()))
    }

    #[test]
    fn bad_numbers_are_refused_where_they_are() {
        let number = |body: &[u8]| unframed(&of(body)).unwrap().1.number().unwrap_err().to_string();
        assert_eq!(number(&[]), "byte 13: 1 bytes are needed and 0 are left");
        assert_eq!(number(&[0x80, 0]), "byte 13: a number is out of range");
        assert_eq!(number(&[0xff, 0xff, 0xff, 0xff, 0x1f]), "byte 13: a number is out of range");
        assert_eq!(number(&[0xff; 6]), "byte 13: a number is out of range");
        let bytes = of(&[9, 1, 2]);
        assert_eq!(
            unframed(&bytes).unwrap().1.count(4).unwrap_err().to_string(),
            "byte 13: 36 bytes are needed and 2 are left"
        );
        let bytes = of(&[2, 0]);
        assert_eq!(unframed(&bytes).unwrap().1.whole().unwrap_err().kind, ReadErrorKind::Number);
        let bytes = of(&f64::NAN.to_le_bytes());
        assert_eq!(unframed(&bytes).unwrap().1.coordinate(true).unwrap_err().kind, ReadErrorKind::Coordinate);
    }

    #[test]
    fn frames_that_are_none_are_refused() {
        let bytes = of(&[1, 2, 3]);
        let error = |bytes: &[u8]| unframed(bytes).unwrap_err().to_string();
        assert_eq!(error(b"GIF89a"), "byte 0: these are no proofs of a table");
        assert_eq!(error(&bytes[..9]), "byte 0: 17 bytes are needed and 9 are left");
        assert_eq!(error(b"this is some other kind of file"), "byte 0: these are no proofs of a table");
        let mut other = bytes.clone();
        other[8] = 7;
        assert_eq!(error(&other), "byte 8: version 7 of the format; this reader knows versions 1 and 2");
        let mut other = bytes.clone();
        other[14] ^= 1;
        assert_eq!(error(&other), "byte 16: the checksum is wrong: the file is damaged");
        let mut other = bytes[..bytes.len() - 4].to_vec();
        other[12] = 9;
        other.extend(crc32fast::hash(&other).to_le_bytes());
        assert_eq!(error(&other), "byte 12: proofs of kind 9, which is not known");
    }
}
