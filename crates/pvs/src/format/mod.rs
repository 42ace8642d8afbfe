//! The bytes of a `.pvs` file.
//!
//! All numbers are little-endian; floating-point numbers are IEEE doubles, bit for bit.
//!
//! ```text
//! offset  size
//!      0     8  magic: 89 'P' 'V' 'S' 0D 0A 1A 0A
//!      8     2  major version; a reader refuses a larger one than its own
//!     10     2  minor version; a larger one only adds optional sections
//!     12     4  n, the number of sections
//!     16     8  length of the whole in bytes
//!     24   32n  the section table, one entry per section:
//!                 4 id, 4 flags (1 = optional), 8 offset, 8 length, 4 CRC-32 of the section, 4 zero
//! 24+32n     4  CRC-32 of all bytes before
//! 28+32n     4  zero
//! ```
//!
//! The sections follow in the order of the table, without gaps: each begins at the next multiple of 8,
//! and so does the end; the bytes between are zero. So every byte is under a checksum or has one value
//! only. (CRC-32 tells every change within 32 consecutive bits.) A reader skips a section that it does
//! not know if it is optional, and refuses the file otherwise.
//!
//! With `d` the dimension, counts in `u32` and coordinates in `f64`:
//!
//! | id | content |
//! | --- | --- |
//! | `CELL` | d, number of cells; for each: min (d), max (d), 1 or 0 for a group or none (`u32`), the group or 0 (`u32`) |
//! | `POLY`, optional | for each cell its number of corners; then the corners x, y of all cells |
//! | `PORT`, optional | number of portals; for each: two cells, two sides (`u32`), number of points, points (d each) |
//! | `ROWS` | for row i = 0, 1, …: `u64` words 0 to i / 64 of the row, without the bits past column i |
//! | `LOCA` | number of nodes, number of entries; nodes in preorder, 16 bytes each: axis, index of the high child, split — or 2^32 - 1, number of entries, eight zeros for a leaf; then the entries of all leaves (`u32` cells) |
//! | `OBJS` | number of objects; for each: min (d), max (d), number of bytes of the name, the name in UTF-8 |
//! | `COBJ` | for each cell its number of objects; then the objects (`u32`) of all cells |
//! | `SEEN`, optional | for each cell, `u64` words of the bits of the objects that it sees |
//! | `INFO` | number of entries; for each: key, value, each as number of bytes and UTF-8 |
//!
//! Half of the rows is enough, because they are symmetric. A missing `POLY` means that the cells are
//! their boxes, a missing `PORT` that there are no portals, a missing `SEEN` (new in 1.1) that a cell sees
//! the objects that touch any cell that it sees.

mod container;
mod decode;
mod encode;
mod error;
mod reader;

pub use error::{DecodeError, DecodeErrorKind, SectionId};

/// The first bytes of every file.
///
/// The first is no ASCII, and two kinds of line ends follow the name, so that programs that take the
/// file for a text spoil the magic.
pub const MAGIC: [u8; 8] = *b"\x89PVS\r\n\x1a\n";
/// Major version that this crate writes, and the largest that it reads.
pub const MAJOR: u16 = 1;
/// Largest minor version that this crate writes: 1 if there are rows of objects, else 0.
pub const MINOR: u16 = 1;

const CELLS: SectionId = SectionId(*b"CELL");
const POLYGONS: SectionId = SectionId(*b"POLY");
const PORTALS: SectionId = SectionId(*b"PORT");
const ROWS: SectionId = SectionId(*b"ROWS");
const LOCATOR: SectionId = SectionId(*b"LOCA");
const OBJECTS: SectionId = SectionId(*b"OBJS");
const CELL_OBJECTS: SectionId = SectionId(*b"COBJ");
const SEEN: SectionId = SectionId(*b"SEEN");
const INFO: SectionId = SectionId(*b"INFO");

/// The sections of this version, and whether they are optional.
const KNOWN: [(SectionId, bool); 9] = [
    (CELLS, false),
    (POLYGONS, true),
    (PORTALS, true),
    (ROWS, false),
    (LOCATOR, false),
    (OBJECTS, false),
    (CELL_OBJECTS, false),
    (SEEN, true),
    (INFO, false),
];

/// The first field of a leaf, where an inner node has its axis.
const LEAF: u32 = u32::MAX;
/// Flag of a section that readers may skip.
const OPTIONAL: u32 = 1;
/// Bytes before the section table.
const FIXED: usize = 24;
/// Bytes of an entry of the section table.
const ENTRY: usize = 32;

/// Number of words of `ROWS` for `n` cells.
fn n_row_words(n: u64) -> u64 {
    // 64 rows of one word, 64 of two, …, then the rest.
    let (full, rest) = (n / 64, n % 64);
    32 * full * (full + 1) + rest * (full + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_words_are_counted() {
        for n in 0..300 {
            assert_eq!(n_row_words(n), (0..n).map(|i| i / 64 + 1).sum::<u64>());
        }
        // No overflow, however many cells a file claims.
        assert!(n_row_words(u64::from(u32::MAX)) < u64::MAX / 8);
    }
}
