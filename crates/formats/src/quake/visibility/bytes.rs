//! Numbers and rows among the bytes of a lump.

/// Puts bytes of a row, of at least `n` bits, into a row of a matrix. Bits past the last cluster mean nothing.
pub(super) fn put_row(bytes: &mut [u8], n: usize, row: &mut [u64]) {
    let bytes = &mut bytes[..n.div_ceil(8)];
    if let (Some(last), true) = (bytes.last_mut(), !n.is_multiple_of(8)) {
        *last &= (1 << (n % 8)) - 1;
    }
    for (word, bytes) in row.iter_mut().zip(bytes.chunks(8)) {
        *word = bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
    }
}

/// Four bytes of a lump as a number; `None` if there are none.
pub(super) fn number(lump: &[u8], at: usize) -> Option<u32> {
    lump.get(at..at + 4).map(|b| b.iter().rev().fold(0, |n, &b| n << 8 | u32::from(b)))
}
