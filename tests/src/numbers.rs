//! Bytes as numbers, for scenes that are made of bytes.

/// Numbers of a byte string, one after the other; zeros at its end.
pub(crate) struct Numbers<'a>(std::slice::Iter<'a, u8>);

impl<'a> Numbers<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes.iter())
    }

    /// The next byte.
    pub(crate) fn byte(&mut self) -> u8 {
        *self.0.next().unwrap_or(&0)
    }

    /// Whether there are no more.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.len() == 0
    }
}
