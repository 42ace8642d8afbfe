//! The bytes of a packed table.
//!
//! There are two size classes: small files have major version 1, large ones version 2. A reader of version 1 refuses large
//! files; this one reads both. What this page describes first is the small class; the [large one](#the-large-class) follows.
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
//! | `OPRT`, optional | varint number of parts of objects; for each: varint object, number of triangles; new in 1.6 here |
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
//! | `PSEN`, optional | cell | the parts that it sees, as objects in `SEEN` of the large class; new in 1.6 here |
//! | `CELL` | cell | varint group + 1 or 0; number of exits, for each: 2 portal + (0 if it leads from the portal's first cell to its second), to-cell; objects; if there are stab trees: varint 1 if the tree is cut at its root, else 0; roots |
//! | `PORT` | portal | varint both cells, both sides, number of points; points (d each) |
//! | `OBJS` | object | min (d), max (d); varint polygons (0 if not known); name to the end |
//! | `STAB`, optional | node | varint gate; number of children, twice, + 1 if the tree is cut there; differences less one from the node down to its last child, and on to its first |
//! | `CNAM`, optional | cell | its name in UTF-8; without the store (new in 1.1) cells have no names |
//!
//! Blocks of all stores but dense `ROWS` and `SEEN` begin with the ends of their records (`u32`, counted from
//! the end of this list). Ascending lists have their length and differences less one, as varints.
//!
//! # The large class
//!
//! Whatever grows with the number of cells is in blocks that are read on demand. The file is written in one pass: first the
//! blocks, then sections, section table and an end that says where they are.
//!
//! ```text
//! offset  size
//!      0    12  magic and versions, as above
//!     12    12  zero
//!     24        the blocks
//!      b        the sections, in the order of the table, without gaps
//!      t   24n  the section table, as above
//!  t+24n    32  8 b, 8 length of the whole in bytes, 4 n, 4 CRC-32 of the first 24 bytes, the section table and the 20 bytes
//!               before this number; 8 the end: 89 'P' 'V' 'E' 0D 0A 1A 0A
//! ```
//!
//! `BOXS`, `POLY`, `LOCA`, `CLAS`, `SCLR`, `SCLC` are not there as sections. In `HEAD` the coding of `ROWS` and `SEEN` is 1
//! (masks), and the numbers of classes are 0. Instead there are:
//!
//! | section | content |
//! | --- | --- |
//! | `LOCT` | the top of the locator: number of nodes, number of pages (`u32`); nodes as in `LOCA`, but a leaf is 2^32 - 1, 0, number of a page (`u64`): pages in the order of the leaves |
//! | `BLKS` | number of stores (`u32`), for each: id, records (`u32`); number of blocks (`u32`), for each in the order of the file: store, records (`u16`), length in the file, length unpacked, CRC-32 in the file (`u32`) |
//!
//! | store | record | content |
//! | --- | --- | --- |
//! | `ROWS` | cell | the cells that it sees, as bits in bytes of eight cells: for each byte that is not 0, a varint of the bytes of 0 before it, and the byte |
//! | `SEEN`, optional | cell | the same with objects |
//! | `BOXS` | cell | min (d), max (d), then the corners of its polygon |
//! | `PLAC` | page | numbers of nodes, entries, cells, corners (`u32`); nodes as in `LOCA`, a subtree in preorder; entries (`u32` indices of cells of the page); cells (`u32`); the corners before each cell, and once more (`u32`); boxes as in `BOXS`; corners |
//! | `CELL`, `PORT`, `OBJS`, `STAB`, `CNAM`, `PSEN` | | as above |
//!
//! Blocks of all these stores begin with the ends of their records. A page repeats the boxes of its cells, so that a point is
//! located with one block beside what is resident.
//!
//! ## Codings of rows that were tried
//!
//! Bytes for each row, unpacked and in blocks of 16 KiB through zstd at level 3, on tables of real maps and buildings and of a
//! generated tower (cells, mean number of cells seen, runs of consecutive cells):
//!
//! | coding | e1m1 (1167, 134, 29) | freedoom1 E1M6 (1184, 126, 77) | office (2139, 100, 58) | tower (2294, 61, 16) |
//! | --- | --: | --: | --: | --: |
//! | bytes that are not 0 (this) | 54, **18.2** | 110, **25.6** | 79, **16.0** | 33, **10.9** |
//! | words of 64 bits that are not 0 | 52, **17.3** | 103, **24.4** | 112, **19.0** | 41, **11.0** |
//! | runs of cells: gap, length | 59, **18.7** | 155, **31.4** | 119, **19.0** | 33, **10.9** |
//! | gaps between cells | 135, **23.9** | 127, **27.7** | 102, **17.1** | 62, **13.1** |
//! | runs, first all gaps, then all lengths | 60, **22.8** | 156, **37.7** | 120, **23.4** | 34, **13.3** |
//! | ends of runs that differ from the row above | 48, **20.6** | 176, **54.8** | 137, **29.3** | 26, **12.0** |
//! | cells that differ from the row above | 63, **21.4** | 154, **49.5** | 117, **26.7** | 35, **12.6** |
//! | nodes of a binary hierarchy: empty, full, mixed | 47, **27.8** | 111, **50.0** | 88, **34.7** | 32, **17.4** |
//!
//! Gaps from the row above and hierarchies are short before zstd, but hide the repetitions that zstd finds. Bytes are within
//! 6 % of the best on each table, and need no look at other rows. At level 15 they take 8 to 11 % less,
//! and 16 to 41 times as long to pack.

use sightlines_pvs::SectionId;

/// How a file is laid out, by the size of its table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SizeClass {
    /// Boxes, locator and classes of rows stay in memory; rows are bits. Major version [`MAJOR`].
    Small,
    /// All that grows with the number of cells is read on demand; rows are lists. Major version [`MAJOR_LARGE`].
    Large,
}

impl SizeClass {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Small, Self::Large];

    /// Lower-case name for options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Small => "small",
            Self::Large => "large",
        }
    }
}

/// The first bytes of every file, chosen like [`sightlines_pvs::format::MAGIC`].
pub const MAGIC: [u8; 8] = *b"\x89PVP\r\n\x1a\n";
/// The last bytes of a large file.
pub const END: [u8; 8] = *b"\x89PVE\r\n\x1a\n";
/// Major version of small files.
pub const MAJOR: u16 = 1;
/// Major version of large files, and the largest that this crate reads.
pub const MAJOR_LARGE: u16 = 2;
/// Most cells that [`crate::pack`] puts into a small file unless it is told otherwise.
pub const MAX_SMALL_CELLS: usize = 1 << 16;
/// Largest minor version that this crate writes, of both classes. It writes the smallest version that supports the content of a table,
/// so that files without newer features stay unchanged.
pub const MINOR: u16 = 6;
/// Largest unpacked block that a reader accepts, in bytes, so that no file can demand more memory at once. The size of
/// *written* blocks is [`BLOCK_BYTES`] and [`ROW_BLOCK_BYTES`].
pub const MAX_UNPACKED_BLOCK: u32 = 1 << 24;
/// Approximate size of a written block of records, unpacked, in bytes: the unit that is read from a file at once.
pub const BLOCK_BYTES: usize = 16 << 10;
/// Largest size of a written block of rows of bits, unpacked, in bytes, though a block has at least 16 rows. Rows are
/// read one by one, but pack better together.
pub const ROW_BLOCK_BYTES: usize = 64 << 10;
/// Approximate size of a written block of rows or of pages of a large file, unpacked, in bytes: what a query reads.
pub const LARGE_ROW_BLOCK_BYTES: usize = 16 << 10;
/// Approximate size of a written block of anything else in a large file, unpacked, in bytes.
pub const LARGE_BLOCK_BYTES: usize = 32 << 10;
/// Largest size of a page of the locator in bytes, unless one leaf takes more.
pub const PAGE_BYTES: usize = 16 << 10;
/// Bytes that rows of bits may take in [`crate::Packed::to_table`]: a small file can describe a large table.
pub const MAX_TABLE: u64 = 1 << 32;

pub(crate) const HEAD: SectionId = SectionId(*b"HEAD");
pub(crate) const BOXES: SectionId = SectionId(*b"BOXS");
pub(crate) const POLYGONS: SectionId = SectionId(*b"POLY");
pub(crate) const LOCATOR: SectionId = SectionId(*b"LOCA");
pub(crate) const LOCATOR_TOP: SectionId = SectionId(*b"LOCT");
pub(crate) const PLANES: SectionId = SectionId(*b"PLAN");
pub(crate) const MIRRORS: SectionId = SectionId(*b"MIRR");
pub(crate) const KIND: SectionId = SectionId(*b"KIND");
pub(crate) const FRAME: SectionId = SectionId(*b"FRAM");
pub(crate) const DIGEST: SectionId = SectionId(*b"DGST");
pub(crate) const SOURCES: SectionId = SectionId(*b"OSRC");
pub(crate) const DOORS: SectionId = SectionId(*b"DOOR");
pub(crate) const OBJECT_PARTS: SectionId = SectionId(*b"OPRT");
pub(crate) const INFO: SectionId = SectionId(*b"INFO");
pub(crate) const COARSE: SectionId = SectionId(*b"COAR");
pub(crate) const CLASSES: SectionId = SectionId(*b"CLAS");
pub(crate) const SEEN_ROWS: SectionId = SectionId(*b"SCLR");
pub(crate) const SEEN_COLUMNS: SectionId = SectionId(*b"SCLC");
pub(crate) const BLOCKS: SectionId = SectionId(*b"BLKS");

/// The sections of this version, and whether readers may skip them.
pub(crate) const SECTIONS: [(SectionId, bool); 19] = [
    (HEAD, false),
    (BOXES, false),
    (POLYGONS, true),
    (LOCATOR, false),
    (LOCATOR_TOP, false),
    (PLANES, true),
    (MIRRORS, true),
    (KIND, true),
    (FRAME, false),
    (DIGEST, true),
    (SOURCES, true),
    (DOORS, true),
    (OBJECT_PARTS, true),
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
pub(crate) const PARTS_SEEN: SectionId = SectionId(*b"PSEN");
pub(crate) const PLACES: SectionId = SectionId(*b"PLAC");

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
/// The minor version that added parts of objects.
pub(crate) const SINCE_OBJECT_PARTS: u16 = 6;

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
/// Coding of rows: bytes of their bits that are not 0.
pub(crate) const MASKS: u32 = 1;
/// Bytes behind the section table of a large file.
pub(crate) const TAIL: usize = 32;
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
