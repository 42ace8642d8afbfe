//! What instructions are drawn from, and buffers that tell what was written.

use crate::{SL_ERROR_BUFFER, SL_NONE, SL_OK, SlStatus};
use std::ptr;

/// The bytes that are left.
pub(super) struct Bytes<'a> {
    pub(super) left: &'a [u8],
}

impl Bytes<'_> {
    pub(super) fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.left.split_first() else { return 0 };
        self.left = rest;
        first
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// Small as a rule, and sometimes anything.
    pub(super) fn number(&mut self) -> u32 {
        match self.byte() {
            255 => SL_NONE,
            254 => u32::from_le_bytes(std::array::from_fn(|_| self.byte())),
            small => u32::from(small % 24),
        }
    }

    /// Of a small grid as a rule, and sometimes anything.
    pub(super) fn real(&mut self) -> f64 {
        const SPECIAL: [f64; 8] =
            [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MAX, 1e-310, 1e18, std::f64::consts::PI];
        match self.byte() {
            byte @ 248.. => SPECIAL[usize::from(byte - 248)],
            byte @ 240.. => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))) * f64::from(byte),
            byte => f64::from(byte % 16) / 2.0 - 1.0,
        }
    }

    pub(super) fn reals<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.real())
    }
}

/// A buffer with marks behind it.
pub(super) struct Marked<T> {
    items: Vec<T>,
    mark: T,
    pub(super) capacity: usize,
    pub(super) count: usize,
    is_null: bool,
}

impl<T: Copy + PartialEq + std::fmt::Debug> Marked<T> {
    pub(super) fn new(bytes: &mut Bytes<'_>, mark: T) -> Self {
        let is_null = bytes.below(8) == 0;
        let capacity = [0, 1, 2, 5, 64, 4096][bytes.below(6)];
        Self { items: vec![mark; capacity + 8], mark, capacity, count: usize::MAX, is_null }
    }

    pub(super) fn place(&mut self) -> *mut T {
        if self.is_null { ptr::null_mut() } else { self.items.as_mut_ptr() }
    }

    pub(super) fn check(&self, status: SlStatus) {
        let written = if status == SL_OK && !self.is_null { self.count.min(self.capacity) } else { 0 };
        // A text has a zero behind it.
        let is_text = size_of::<T>() == 1;
        let written = written + usize::from(is_text && written < self.capacity && status == SL_OK && !self.is_null);
        assert!(self.items[written..].iter().all(|item| *item == self.mark), "written beyond {written} items");
        if status == SL_OK && !self.is_null {
            assert!(self.count <= self.capacity, "{} items in a buffer for {}", self.count, self.capacity);
        }
        if status == SL_ERROR_BUFFER {
            assert!(self.count >= self.capacity, "a buffer for {} has room for {}", self.capacity, self.count);
        }
    }
}
