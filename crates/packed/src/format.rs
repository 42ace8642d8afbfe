//! The bytes of a packed table.
//!
//! All numbers are little-endian, coordinates are IEEE doubles, bit for bit. A *varint* has seven bits per byte, the
//! low ones first, and a top bit that is set if more follow.
//!
//! ```text
//! offset  size
//!      0     8  magic: 89 'P' 'V' 'P' 0D 0A 1A 0A
//!      8     2  major version; a reader refuses a larger one than its own
//!     10     2  minor version; a larger one only adds sections and stores
//!     12     4  n, the number of sections
//!     16     8  length of the whole in bytes
//!     24   24n  the section table, one entry per section:
//!                 4 id, 4 flags (1 = optional), 8 offset, 4 length, 4 CRC-32 of the section
//! 24+24n     4  CRC-32 of all bytes before
//! ```
//!
//! The sections follow in the order of the table, without gaps, and then the blocks of all stores, without gaps either.
//! Sections are resident: read and checked as a whole when the file is opened. Blocks are read on demand, each with a
//! CRC-32 of its own, kept in `BLKS`.
//!
//! | section | content |
//! | --- | --- |
//! | `HEAD` | twelve `u32`: dimension d; numbers of cells, objects, portals, nodes of stab trees (2^32 - 1: none); flags (1: numbers of polygons known, 2: own rows of objects); coding of `ROWS`, of `SEEN` (0: dense, the only one); cells in a page; numbers of classes of cells by rows, by rows of objects, of classes of objects |
//! | `BOXS` | for each cell min (d), max (d) |
//! | `POLY`, optional | for each cell, and once more, the corners before it (`u32`); then corners x, y |
//! | `LOCA` | number of nodes, number of entries (`u32`); nodes in preorder, 16 bytes each: axis, index of the high child, split — or 2^32 - 1, number of entries, first entry (`u64`) for a leaf; then the entries (`u32` cells) |
//! | `PLAN`, optional | slack; number of nodes (`u32`); for each: normal (3), offset, two children: 2 `u32`, kind (0 node, 1 cell, 2 nothing) and id |
//! | `MIRR`, optional | varint number; for each: varint cell, face, number of points; points (d each) |
//! | `KIND`, optional | as in a `.pvs` file of version 1.4; new in 1.2 here |
//! | `FRAM` | as in a `.pvs` file of version 1.5, and like there without leave to skip it; new in 1.3 here |
//! | `DGST`, optional | as in a `.pvs` file of version 1.6; new in 1.4 here |
//! | `OSRC`, optional | for each object a varint: its node plus 1, or 0 if it has no source; and if it has one, its primitive as a varint; new in 1.5 here |
//! | `DOOR`, optional | varint number; for each: varint object plus 1, or 0; name as varint number of bytes and UTF-8; portals; new in 1.5 here |
//! | `INFO` | varint number; for each: key, value, each as varint number of bytes and UTF-8 |
//! | `COAR` | pages by pages of cells, a bit if some cell of the one sees some cell of the other, rows of `u64` |
//! | `CLAS` | classes of cells in `ROWS`, counted by their first members; empty if each is its own, else the unpacked length (`u32`) and, packed by zstd, for each cell a varint: how far its class is below the least that no cell before has |
//! | `SCLR`, `SCLC`, optional | the same for rows and columns of `SEEN`: cells, objects |
//! | `BLKS` | number of stores (`u32`); for each: id, records, records per block (`u32`), then for each block: length in the file, length unpacked, CRC-32 in the file (`u32`) |
//!
//! A block is packed by zstd, or stored as it is if both lengths are equal.
//!
//! | store | record | content |
//! | --- | --- | --- |
//! | `ROWS` | class of cells | bits of the classes that it sees, words of `u64` |
//! | `SEEN`, optional | class of cells | the same with classes of objects |
//! | `CELL` | cell | varint group + 1 or 0; number of exits, for each: 2 portal + (0 if it leads from the portal's first cell to its second), to-cell; objects; if there are stab trees: varint 1 if the tree is cut at its root, else 0; roots |
//! | `PORT` | portal | varint both cells, both sides, number of points; points (d each) |
//! | `OBJS` | object | min (d), max (d); varint polygons (0 if not known); name to the end |
//! | `STAB`, optional | node | varint gate; number of children, twice, + 1 if the tree is cut there; differences less one from the node down to its last child, and on to its first |
//! | `CNAM`, optional | cell | its name in UTF-8; without the store (new in 1.1) cells have no names |
//!
//! Blocks of all stores but `ROWS` and `SEEN` begin with the ends of their records (`u32`, counted from
//! the end of this list). Ascending lists have their length and differences less one, as varints.

use sightlines_pvs::SectionId;

/// The first bytes of every file, chosen like [`sightlines_pvs::format::MAGIC`].
pub const MAGIC: [u8; 8] = *b"\x89PVP\r\n\x1a\n";
/// Major version that this crate writes, and the largest that it reads.
pub const MAJOR: u16 = 1;
/// Largest minor version that this crate writes. It writes the smallest version that supports the content of a table,
/// so that files without newer features stay unchanged.
pub const MINOR: u16 = 5;
/// Largest unpacked block that a reader accepts, in bytes, so that no file can demand more memory at once. The size of
/// *written* blocks is [`BLOCK_BYTES`] and [`ROW_BLOCK_BYTES`].
pub const MAX_UNPACKED_BLOCK: u32 = 1 << 24;
/// Approximate size of a written block of records, unpacked, in bytes: the unit that is read from a file at once.
pub const BLOCK_BYTES: usize = 16 << 10;
/// Largest size of a written block of rows of bits, unpacked, in bytes, though a block has at least 16 rows. Rows are
/// read one by one, but pack better together.
pub const ROW_BLOCK_BYTES: usize = 64 << 10;
/// Bytes that rows of bits may take in [`crate::Packed::to_table`]: a small file can describe a large table.
pub const MAX_TABLE: u64 = 1 << 32;

pub(crate) const HEAD: SectionId = SectionId(*b"HEAD");
pub(crate) const BOXES: SectionId = SectionId(*b"BOXS");
pub(crate) const POLYGONS: SectionId = SectionId(*b"POLY");
pub(crate) const LOCATOR: SectionId = SectionId(*b"LOCA");
pub(crate) const PLANES: SectionId = SectionId(*b"PLAN");
pub(crate) const MIRRORS: SectionId = SectionId(*b"MIRR");
pub(crate) const KIND: SectionId = SectionId(*b"KIND");
pub(crate) const FRAME: SectionId = SectionId(*b"FRAM");
pub(crate) const DIGEST: SectionId = SectionId(*b"DGST");
pub(crate) const SOURCES: SectionId = SectionId(*b"OSRC");
pub(crate) const DOORS: SectionId = SectionId(*b"DOOR");
pub(crate) const INFO: SectionId = SectionId(*b"INFO");
pub(crate) const COARSE: SectionId = SectionId(*b"COAR");
pub(crate) const CLASSES: SectionId = SectionId(*b"CLAS");
pub(crate) const SEEN_ROWS: SectionId = SectionId(*b"SCLR");
pub(crate) const SEEN_COLUMNS: SectionId = SectionId(*b"SCLC");
pub(crate) const BLOCKS: SectionId = SectionId(*b"BLKS");

/// The sections of this version, and whether readers may skip them.
pub(crate) const SECTIONS: [(SectionId, bool); 17] = [
    (HEAD, false),
    (BOXES, false),
    (POLYGONS, true),
    (LOCATOR, false),
    (PLANES, true),
    (MIRRORS, true),
    (KIND, true),
    (FRAME, false),
    (DIGEST, true),
    (SOURCES, true),
    (DOORS, true),
    (INFO, false),
    (COARSE, false),
    (CLASSES, false),
    (SEEN_ROWS, true),
    (SEEN_COLUMNS, true),
    (BLOCKS, false),
];

pub(crate) const ROWS: SectionId = SectionId(*b"ROWS");
pub(crate) const SEEN: SectionId = SectionId(*b"SEEN");
pub(crate) const CELLS: SectionId = SectionId(*b"CELL");
pub(crate) const PORTALS: SectionId = SectionId(*b"PORT");
pub(crate) const OBJECTS: SectionId = SectionId(*b"OBJS");
pub(crate) const STAB: SectionId = SectionId(*b"STAB");
pub(crate) const CELL_NAMES: SectionId = SectionId(*b"CNAM");

/// The minor version that added names of cells.
pub(crate) const SINCE_CELL_NAMES: u16 = 1;
/// The minor version that added the kind of a table.
pub(crate) const SINCE_KIND: u16 = 2;
/// The minor version that added frames.
pub(crate) const SINCE_FRAME: u16 = 3;
/// The minor version that added digests of the geometry.
pub(crate) const SINCE_DIGEST: u16 = 4;
/// The minor version that added sources of objects and doors.
pub(crate) const SINCE_SOURCES_DOORS: u16 = 5;

/// Bytes before the section table.
pub(crate) const FIXED: usize = 24;
/// Bytes of an entry of the section table.
pub(crate) const ENTRY: usize = 24;
/// Flag of a section that readers may skip.
pub(crate) const OPTIONAL: u32 = 1;
/// Bytes of `HEAD`.
pub(crate) const HEAD_LEN: usize = 48;
/// Flag of `HEAD`: objects have numbers of polygons.
pub(crate) const POLYGONS_KNOWN: u32 = 1;
/// Flag of `HEAD`: there are rows of objects.
pub(crate) const HAS_SEEN: u32 = 2;
/// Coding of rows: their plain bits; zstd finds the repetitions.
///
/// Rows xor their predecessors, and only the corners of rectangles, were tried: on every real table zstd compresses the
/// plain bits better (the chart `docs/charts/packed.md` has the figures).
pub(crate) const DENSE: u32 = 0;
/// Number that stands for "none".
pub(crate) const NONE: u32 = u32::MAX;
/// Cells in a page of the coarse table, unless there are many cells.
pub(crate) const PAGE: usize = 64;
/// Most pages of the coarse table before pages become larger: with this many it takes half a megabyte.
pub(crate) const MAX_PAGES: usize = 2048;

/// Cells in a page of the coarse table.
pub(crate) fn page_size(n_cells: usize) -> usize {
    let mut page = PAGE;
    while n_cells.div_ceil(page) > MAX_PAGES {
        page *= 2;
    }
    page
}
