//! A row of bits that grows.

/// Bits, in the order in which they were added.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Bits {
    bytes: Vec<u8>,
    len: usize,
}

impl Bits {
    pub(crate) fn push(&mut self, bit: bool) {
        if self.len.is_multiple_of(8) {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= u8::from(bit) << (self.len % 8);
        }
        self.len += 1;
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn get(&self, at: usize) -> Option<bool> {
        (at < self.len).then(|| self.bytes[at / 8] >> (at % 8) & 1 == 1)
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// `None` unless there are as many bytes as the bits need, and no ones after the last bit.
    pub(crate) fn of(bytes: &[u8], len: usize) -> Option<Self> {
        let is_whole = len.is_multiple_of(8) || bytes.last().is_some_and(|last| last >> (len % 8) == 0);
        (bytes.len() == len.div_ceil(8) && is_whole).then(|| Self { bytes: bytes.to_vec(), len })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_back() {
        let mut bits = Bits::default();
        (0..19usize).for_each(|k| bits.push(k.is_multiple_of(3)));
        assert!((0..19usize).all(|k| bits.get(k) == Some(k.is_multiple_of(3))) && bits.get(19).is_none());
        assert_eq!(Bits::of(bits.bytes(), 19).as_ref(), Some(&bits));
        assert!(Bits::of(bits.bytes(), 18).is_none() && Bits::of(bits.bytes(), 25).is_none());
        assert_eq!(Bits::of(&[], 0), Some(Bits::default()));
    }
}
