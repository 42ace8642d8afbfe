//! The bytes of a `.pvs` file.
//!
//! All numbers are little-endian; floating-point numbers are IEEE doubles, bit for bit.
//!
//! ```text
//! offset  size
//!      0     8  magic: 89 'P' 'V' 'S' 0D 0A 1A 0A
//!      8     2  major version; a reader refuses a larger one than its own
//!     10     2  minor version; a larger one only adds sections
//!     12     4  n, the number of sections
//!     16     8  length of the whole in bytes
//!     24   32n  the section table, one entry per section:
//!                 4 id, 4 flags (1 = optional), 8 offset, 8 length, 4 CRC-32 of the section, 4 zero
//! 24+32n     4  CRC-32 of all bytes before
//! 28+32n     4  zero
//! ```
//!
//! The sections follow in the order of the table, without gaps: each begins at the next multiple of 8, and so does the
//! end; the bytes between are zero. So every byte either is covered by a checksum or has a fixed value. (CRC-32 detects
//! every change within 32 consecutive bits.) A reader skips an unknown section if it is optional, and refuses the file
//! otherwise.
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
//! | `MIRR`, optional | number of parts of mirrors; for each: cell, face (`u32`), number of points, points (d each) |
//! | `OPOL`, optional | for each object its number of polygons (`u32`) |
//! | `PLNS`, optional, only in space | slack (`f64`), number of nodes; for each: normal (3), offset, two children (`u32`): 0 for nothing, the number of a node, or 2^31 plus a cell |
//! | `STAB`, optional | the stab trees, see below |
//! | `CNAM`, optional | for each cell its name, as number of bytes and UTF-8 |
//! | `KIND`, optional | what kind of table it is (`u32`): 0 not stated, 1 plan by k-d tree, 2 plan by triangulation, 3 scene by k-d tree, 4 scene with given cells, 5 Quake portal file, 6 Quake map; for scenes, what found the hidden (`u32`): 1 sight lines, plus 2 a from-region method, plus 4 if nothing is promised for eyes inside solid matter; the axis that points up (`u32`): 0 not known, 1 to 3 |
//! | `FRAM` | the axes of the frame (3 each), the gap |
//! | `DGST`, optional | digests of what hides and of what is seen in what the table was made of, 16 bytes each |
//! | `OSRC`, optional | for each object its node and its primitive (`u32`), or 2^32 - 1 twice |
//! | `DOOR`, optional | number of doors; for each: the object plus 1, or 0 (`u32`), number of bytes of the name, the name in UTF-8, number of portals, portals (`u32`) |
//! | `OPRT`, optional | number of parts of objects; for each: object, first triangle, the one behind its last triangle (`u32`); for each cell, `u64` words of the bits of the parts that it sees |
//! | `INFO` | number of entries; for each: key, value, each as number of bytes and UTF-8 |
//!
//! Half of the rows is enough, because they are symmetric. A missing `POLY` means that the cells are their boxes, a
//! missing `PORT` that there are no portals, a missing `SEEN` (new in 1.1) that a cell sees the objects that touch any
//! cell that it sees. Of the sections new in 1.2, a missing `MIRR` means that there are no mirrors, a missing `OPOL`
//! that the numbers of polygons are unknown, a missing `PLNS` that the cells' outlines locate points, a missing `STAB`
//! that the stab trees are unknown. A missing `CNAM` (new in 1.3) means that the cells have no names. Without a `KIND`
//! (new in 1.4), kind and axis are those that older programs left in `INFO` under the keys `source`, `subdivide`,
//! `method` and `up` ([`kind_from_info`]), or unknown; a later minor version may add kinds, which a reader treats as
//! not stated. Without a `FRAM` (new in 1.5) all coordinates are along the axes of the scene. Because it changes what coordinates mean,
//! `FRAM` is not optional for a reader: one that does not have it refuses the file. Files without it are as before. A missing
//! `DGST` (new in 1.6) means that the digests are unknown, a missing `OSRC` (new in 1.7) that the places of objects in their file are, and a
//! missing `DOOR` (new in 1.7) that there are no doors, a missing `OPRT` (new in 1.8) that no object was cut into parts.
//!
//! # Stab trees
//!
//! The graph of [`crate::StabTrees`], in its order, which is the only one accepted. A *varint* is a number of up to 64
//! bits in groups of seven bits per byte, the lowest first; the high bit is set if another byte follows; the shortest
//! form is required. A *gate* is twice the number of a portal, and 1 more if it is crossed from its second cell into
//! its first; the *entries* of a cell are the gates into it, ascending. All numbers are varints.
//!
//! ```text
//! for each level of the graph, the nodes without children first:
//!     number of groups, at least 1
//!     for each group, ascending by its key, twice the cell that its nodes lead into, plus 1 if they are open:
//!         key - key of the group before - 1, or the key
//!         for each list of children in the group, ascending:
//!             header, children
//! 0
//! for each cell: twice the number of roots, plus 1 if it is open; roots
//! ```
//!
//! A header lists the nodes with these children. With at most 16 entries it is one number: bit 0 is set if another list
//! follows in the group, bit `1 + i` if a node crosses entry `i`, the rest is the number of children, minus 1 except on
//! the first level. With more entries it is several: the number of children (minus 1 likewise) above the bit for
//! another list; the number of nodes; and for each the number of entries skipped since the one before.
//!
//! Children, and roots, are nodes out of one cell. Of the nodes out of this cell on the levels before (for roots, on
//! all) they are stored from the last to the first, each as the number of skipped nodes.

mod container;
mod decode;
mod doors;
mod encode;
mod error;
mod kind;
mod object_parts;
mod planes;
mod reader;
mod stab;
mod writer;

pub use error::{DecodeError, DecodeErrorKind, SectionId};
pub use kind::{KIND_LEN, kind_from_bytes, kind_from_info, kind_section, kind_to_bytes};

/// The first bytes of every file.
///
/// The first byte is not ASCII, and two kinds of line ends follow the name, so that programs that treat the file as
/// text corrupt the magic.
pub const MAGIC: [u8; 8] = *b"\x89PVS\r\n\x1a\n";
/// Major version that this crate writes, and the largest that it reads.
pub const MAJOR: u16 = 1;
/// Largest minor version that this crate writes. It writes the smallest version with all the sections of a table, so
/// that files without newer sections stay unchanged.
pub const MINOR: u16 = 8;

const CELLS: SectionId = SectionId(*b"CELL");
const POLYGONS: SectionId = SectionId(*b"POLY");
const PORTALS: SectionId = SectionId(*b"PORT");
const ROWS: SectionId = SectionId(*b"ROWS");
const LOCATOR: SectionId = SectionId(*b"LOCA");
const OBJECTS: SectionId = SectionId(*b"OBJS");
const CELL_OBJECTS: SectionId = SectionId(*b"COBJ");
const SEEN: SectionId = SectionId(*b"SEEN");
const MIRRORS: SectionId = SectionId(*b"MIRR");
const OBJECT_POLYGONS: SectionId = SectionId(*b"OPOL");
const PLANES: SectionId = SectionId(*b"PLNS");
const STAB: SectionId = SectionId(*b"STAB");
const CELL_NAMES: SectionId = SectionId(*b"CNAM");
const KIND: SectionId = SectionId(*b"KIND");
const FRAME: SectionId = SectionId(*b"FRAM");
const DIGEST: SectionId = SectionId(*b"DGST");
const SOURCES: SectionId = SectionId(*b"OSRC");
const DOORS: SectionId = SectionId(*b"DOOR");
const OBJECT_PARTS: SectionId = SectionId(*b"OPRT");
const INFO: SectionId = SectionId(*b"INFO");

/// The minor version that added rows of objects.
const SINCE_SEEN: u16 = 1;
/// The minor version that added mirrors, numbers of polygons, planes and stab trees.
const SINCE_MIRRORS_PLANES_STAB: u16 = 2;
/// The minor version that added names of cells.
const SINCE_CELL_NAMES: u16 = 3;
/// The minor version that added the kind of a table.
const SINCE_KIND: u16 = 4;
/// The minor version that added frames.
const SINCE_FRAME: u16 = 5;
/// The minor version that added digests of the geometry.
const SINCE_DIGEST: u16 = 6;
/// The minor version that added sources of objects and doors.
const SINCE_SOURCES_DOORS: u16 = 7;
/// The minor version that added parts of objects.
const SINCE_OBJECT_PARTS: u16 = 8;

/// The sections of this version, whether readers may skip them, and the minor version that added each, which is a constant.
const KNOWN: [(SectionId, bool, u16); 20] = [
    (CELLS, false, 0),
    (POLYGONS, true, 0),
    (PORTALS, true, 0),
    (ROWS, false, 0),
    (LOCATOR, false, 0),
    (OBJECTS, false, 0),
    (CELL_OBJECTS, false, 0),
    (SEEN, true, SINCE_SEEN),
    (MIRRORS, true, SINCE_MIRRORS_PLANES_STAB),
    (OBJECT_POLYGONS, true, SINCE_MIRRORS_PLANES_STAB),
    (PLANES, true, SINCE_MIRRORS_PLANES_STAB),
    (STAB, true, SINCE_MIRRORS_PLANES_STAB),
    (CELL_NAMES, true, SINCE_CELL_NAMES),
    (KIND, true, SINCE_KIND),
    (FRAME, false, SINCE_FRAME),
    (DIGEST, true, SINCE_DIGEST),
    (SOURCES, true, SINCE_SOURCES_DOORS),
    (DOORS, true, SINCE_SOURCES_DOORS),
    (OBJECT_PARTS, true, SINCE_OBJECT_PARTS),
    (INFO, false, 0),
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
