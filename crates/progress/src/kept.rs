//! Results of units of work as bytes: the one encoding of all that is kept.
//!
//! A value is its parts, one after the other. An integer has seven bits in a byte, the low ones first, and a top bit that is set if more
//! follow; a float has eight bytes, little-endian; a list begins with its length. What is read may come from anywhere: it is refused, or it
//! is a value.

use crate::{Halt, Units};

/// A part of a result of a unit. It takes one byte at least.
pub trait Kept: Sized {
    /// Appends it.
    fn write(&self, out: &mut Vec<u8>);

    /// Takes one from the front of `bytes`; `None` if there is none. Memory in proportion to the bytes.
    fn read(bytes: &mut &[u8]) -> Option<Self>;

    /// Appends several, without their number.
    fn write_all(all: &[Self], out: &mut Vec<u8>) {
        all.iter().for_each(|one| one.write(out));
    }

    /// Takes so many; `None` at once if there cannot be as many.
    fn read_all(bytes: &mut &[u8], n: usize) -> Option<Vec<Self>> {
        if n > bytes.len() { None } else { (0..n).map(|_| Self::read(bytes)).collect() }
    }

    /// It alone.
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.write(&mut out);
        out
    }

    /// It, if that is all there is.
    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        read_whole(bytes, Self::read)
    }
}

/// What `read` takes from the front of `bytes`, if nothing is left behind it.
pub fn read_whole<T>(mut bytes: &[u8], read: impl FnOnce(&mut &[u8]) -> Option<T>) -> Option<T> {
    read(&mut bytes).filter(|_| bytes.is_empty())
}

/// Appends a list: its length, and its entries.
pub fn write_list<T: Kept>(list: &[T], out: &mut Vec<u8>) {
    list.len().write(out);
    T::write_all(list, out);
}

impl Units<'_> {
    /// The value of a unit as [`Self::get`] has its bytes, and whether it was not computed; no value of one that is for another process.
    ///
    /// * `of`: what it is a result of, for people
    /// * `write`: the value as bytes; called only if results are kept
    /// * `read`: the value of bytes; `None` if they are none of this unit
    ///
    /// # Errors
    /// [`Halt`] of the store or of bytes that are no value, or an error of `compute`.
    pub fn value<T, E: From<Halt>>(
        &self,
        (phase, unit, of): (&'static str, usize, &str),
        compute: impl FnOnce() -> Result<T, E>,
        write: impl FnOnce(&T) -> Vec<u8>,
        read: impl FnOnce(&[u8]) -> Option<T>,
    ) -> Result<(Option<T>, bool), E> {
        let mut computed = None;
        let result = self.get(phase, unit, || {
            let value = computed.insert(compute()?);
            Ok::<_, E>(if self.are_kept() { write(value) } else { Vec::new() })
        })?;
        match (computed, result) {
            (None, Some(bytes)) => Ok((Some(read(&bytes).ok_or_else(|| Halt::unfit(phase, unit, of))?), true)),
            (computed, _) => {
                let is_kept = computed.is_none();
                Ok((computed, is_kept))
            }
        }
    }
}

impl Kept for u64 {
    fn write(&self, out: &mut Vec<u8>) {
        let mut x = *self;
        while x >= 0x80 {
            out.push(x as u8 | 0x80);
            x >>= 7;
        }
        out.push(x as u8);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let mut x = 0;
        for shift in (0..Self::BITS).step_by(7) {
            let byte = u8::read(bytes)?;
            let part = Self::from(byte & 0x7F);
            if part << shift >> shift != part {
                return None;
            }
            x |= part << shift;
            if byte < 0x80 {
                return Some(x);
            }
        }
        None
    }
}

impl Kept for u32 {
    fn write(&self, out: &mut Vec<u8>) {
        u64::from(*self).write(out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u64::read(bytes)?.try_into().ok()
    }
}

impl Kept for usize {
    fn write(&self, out: &mut Vec<u8>) {
        (*self as u64).write(out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u64::read(bytes)?.try_into().ok()
    }
}

/// As it is.
impl Kept for u8 {
    fn write(&self, out: &mut Vec<u8>) {
        out.push(*self);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        Some(byte)
    }

    fn write_all(all: &[Self], out: &mut Vec<u8>) {
        out.extend_from_slice(all);
    }

    fn read_all(bytes: &mut &[u8], n: usize) -> Option<Vec<Self>> {
        let (all, rest) = bytes.split_at_checked(n)?;
        *bytes = rest;
        Some(all.to_vec())
    }
}

/// 0 or 1.
impl Kept for bool {
    fn write(&self, out: &mut Vec<u8>) {
        out.push(u8::from(*self));
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        u8::read(bytes).filter(|byte| *byte < 2).map(|byte| byte == 1)
    }
}

/// All of its bits.
impl Kept for f64 {
    fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.to_le_bytes());
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let (x, rest) = bytes.split_first_chunk()?;
        *bytes = rest;
        Some(Self::from_le_bytes(*x))
    }
}

/// Whether there is one, and it.
impl<T: Kept> Kept for Option<T> {
    fn write(&self, out: &mut Vec<u8>) {
        self.is_some().write(out);
        self.iter().for_each(|one| one.write(out));
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        if bool::read(bytes)? { T::read(bytes).map(Some) } else { Some(None) }
    }
}

impl<T: Kept> Kept for Vec<T> {
    fn write(&self, out: &mut Vec<u8>) {
        write_list(self, out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let n = usize::read(bytes)?;
        T::read_all(bytes, n)
    }
}

impl<T: Kept> Kept for Box<[T]> {
    fn write(&self, out: &mut Vec<u8>) {
        write_list(self, out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Vec::read(bytes).map(Vec::into_boxed_slice)
    }
}

impl<T: Kept, const N: usize> Kept for [T; N] {
    fn write(&self, out: &mut Vec<u8>) {
        T::write_all(self, out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        T::read_all(bytes, N)?.try_into().ok()
    }
}

impl<T: Kept, U: Kept> Kept for (T, U) {
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
        self.1.write(out);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Some((T::read(bytes)?, U::read(bytes)?))
    }
}

/// Keeps a struct: all of its fields, in the order in which they stand here.
#[macro_export]
macro_rules! kept_struct {
    ($name:ty { $($field:ident),+ $(,)? }) => {
        impl $crate::Kept for $name {
            fn write(&self, out: &mut Vec<u8>) {
                let Self { $($field),+ } = self;
                $($crate::Kept::write($field, out);)+
            }

            fn read(bytes: &mut &[u8]) -> Option<Self> {
                $(let $field = $crate::Kept::read(bytes)?;)+
                Some(Self { $($field),+ })
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pass, Phase, UnitStore};

    #[derive(Debug, Clone, PartialEq)]
    struct Both {
        flags: Vec<Option<bool>>,
        name: Box<[u8]>,
        pairs: Vec<([u32; 2], usize)>,
        share: f64,
    }
    kept_struct!(Both { flags, name, pairs, share });

    #[test]
    fn values_come_back_and_nothing_else_is_one() {
        let both = Both {
            flags: vec![None, Some(false), Some(true)],
            name: Box::from(*b"abc"),
            pairs: vec![([0, u32::MAX], 300), ([127, 128], 0)],
            share: f64::NEG_INFINITY,
        };
        let bytes = both.to_bytes();
        assert_eq!(Both::from_bytes(&bytes), Some(both));
        assert!((0..bytes.len()).all(|n| Both::from_bytes(&bytes[..n]).is_none()));
        assert_eq!(Both::from_bytes(&[&bytes[..], &[0]].concat()), None, "something is left");
        assert_eq!((bool::from_bytes(&[2]), Option::<u8>::from_bytes(&[2, 0])), (None, None));
    }

    #[test]
    fn lengths_that_are_too_large_are_refused_at_once() {
        let most = u64::MAX.to_bytes();
        assert_eq!(Vec::<u8>::from_bytes(&most), None);
        assert_eq!(Vec::<Vec<u64>>::from_bytes(&[&most[..], &[0; 9]].concat()), None);
        assert_eq!(Vec::<u32>::from_bytes(&[3, 1, 1]), None);
    }

    #[test]
    fn integers_have_their_bits() {
        for x in [0, 127, 128, 1 << 21, u32::MAX] {
            assert_eq!((u32::from_bytes(&x.to_bytes()), u64::from_bytes(&x.to_bytes())), (Some(x), Some(u64::from(x))));
        }
        let mut bytes = u64::MAX.to_bytes();
        assert_eq!((u64::from_bytes(&bytes), u32::from_bytes(&bytes)), (Some(u64::MAX), None));
        bytes[9] = 2;
        assert_eq!(
            (u64::from_bytes(&bytes), u64::from_bytes(&[0x80; 11]), u64::from_bytes(&[0x80])),
            (None, None, None)
        );
        assert_eq!(u32::from_bytes(&[0xFF, 0xFF, 0xFF, 0xFF, 0x1F]), None);
    }

    #[test]
    fn values_are_computed_or_read() {
        /// Has the result of one unit, and wants the others but for one.
        struct Store(u8);
        impl UnitStore for Store {
            fn begin(&self, _: &Phase<'_>) -> Result<(), Halt> {
                Ok(())
            }
            fn wants(&self, _: &'static str, unit: usize) -> bool {
                unit != 1
            }
            fn load(&self, _: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
                Ok((unit == 2).then(|| vec![self.0]))
            }
            fn save(&self, _: &'static str, _: usize, result: &[u8]) -> Result<(), Halt> {
                assert_eq!(result, 300_u64.to_bytes());
                Ok(())
            }
            fn end(&self, _: &'static str) -> Result<Pass, Halt> {
                Ok(Pass::Last)
            }
        }
        let value = |units: Units<'_>, unit: usize| {
            let read = |bytes: &[u8]| u64::from_bytes(bytes).filter(|x| *x > 0);
            units.value(("numbers", unit, "this test"), || Ok::<_, Halt>(300), u64::to_bytes, read)
        };
        let found = [0, 1, 2].map(|unit| value(Units(Some(&Store(7))), unit));
        assert_eq!(found, [(Some(300), false), (None, true), (Some(7), true)].map(Ok));
        let unfit = "the kept result of unit 2 of the phase 'numbers' does not fit this test";
        assert_eq!(value(Units(Some(&Store(0))), 2).map_err(|halt| halt.to_string()), Err(unfit.to_owned()));
        assert_eq!(value(Units::default(), 2), Ok((Some(300), false)));
    }
}
