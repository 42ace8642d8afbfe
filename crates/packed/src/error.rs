//! Why bytes are not a packed table, and why a table cannot be packed.

use sightlines_pvs::{CellId, ObjectId, PortalId, SectionId, TableError};
use std::{fmt, io};

/// Why a query to a packed table failed, and where in the file.
#[derive(Debug)]
pub struct PackedError {
    /// The section or store; `None` for what precedes them, and for queries about things that do not exist.
    pub section: Option<SectionId>,
    /// Byte offset from the beginning of the file; inside a block, that of the block.
    pub offset: u64,
    /// What is wrong.
    pub kind: PackedErrorKind,
}

impl PackedError {
    pub(crate) fn new(section: Option<SectionId>, offset: u64, kind: PackedErrorKind) -> Self {
        Self { section, offset, kind }
    }

    /// A query about something that the table does not have.
    pub(crate) fn asked(kind: PackedErrorKind) -> Self {
        Self { section: None, offset: 0, kind }
    }
}

impl fmt::Display for PackedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.section, &self.kind) {
            (_, kind) if kind.is_question() => kind.fmt(f),
            (Some(section), kind) => write!(f, "byte {}, section {section}: {kind}", self.offset),
            (None, kind) => write!(f, "byte {}: {kind}", self.offset),
        }
    }
}

impl std::error::Error for PackedError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.kind)
    }
}

/// What is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackedErrorKind {
    /// The bytes could not be read.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The first bytes are not those of a packed table.
    #[error("this is no packed visibility table")]
    Magic,
    /// A version that is too new, or never existed.
    #[error(
        "version {major} of the packed format; this reader knows versions {} to {}",
        crate::format::MAJOR,
        crate::format::MAJOR_LARGE
    )]
    Major {
        /// The version found.
        major: u16,
    },
    /// The bytes are truncated, or something follows them.
    #[error("the packed table says that it has {stated} bytes, but there are {len}")]
    Length {
        /// The length that the file states.
        stated: u64,
        /// Number of bytes.
        len: u64,
    },
    /// A checksum is wrong: something has changed.
    #[error("the checksum is {computed:08x} instead of {stored:08x}")]
    Checksum {
        /// The stored checksum.
        stored: u32,
        /// The checksum of the bytes.
        computed: u32,
    },
    /// A section that does not begin where the one before ended, or ends outside the file.
    #[error("the section does not lie where it must")]
    Misplaced,
    /// A section that occurs twice.
    #[error("the section is there twice")]
    Repeated,
    /// A required section is missing.
    #[error("the section is missing")]
    Missing,
    /// A section that is neither optional nor known.
    #[error("the section is needed and unknown")]
    Unknown,
    /// Something has the wrong size.
    #[error("{found} bytes instead of {needed}")]
    Size {
        /// The required size.
        needed: u64,
        /// The actual size.
        found: u64,
    },
    /// An invalid number.
    #[error("{value} is not possible here")]
    Value {
        /// The number.
        value: u64,
    },
    /// The bytes end inside something.
    #[error("the bytes end inside something")]
    Cut,
    /// More bytes than expected.
    #[error("{left} bytes too many")]
    Surplus {
        /// Bytes left over.
        left: u64,
    },
    /// A text that is not UTF-8.
    #[error("the text is not UTF-8")]
    Text,
    /// A block that zstd cannot unpack to the size in the index.
    #[error("the block does not unpack to {raw} bytes")]
    Unpack {
        /// The expected number of bytes.
        raw: u32,
    },
    /// More memory than [`crate::format::MAX_TABLE`] allows.
    #[error("{bytes} bytes would be needed, more than this reader takes")]
    TooLarge {
        /// Bytes needed.
        bytes: u64,
    },
    /// A page of the coarse table does not agree with the rows.
    #[error("page {page} of the coarse table is not what its cells see")]
    Coarse {
        /// The page.
        page: u32,
    },
    /// A page of the locator has another box or polygon of a cell than the cell itself.
    #[error("page {page} of the locator has another place of cell {cell}")]
    Page {
        /// The page.
        page: u32,
        /// The cell.
        cell: CellId,
    },
    /// The exits of a cell are not its portals.
    #[error("the exits of cell {cell} are not its portals")]
    Exits {
        /// The cell.
        cell: CellId,
    },
    /// The content is not a valid table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A query about a cell that the table does not have.
    #[error("there is no cell {cell}, only {n_cells}")]
    NoCell {
        /// The cell.
        cell: CellId,
        /// Number of cells.
        n_cells: u32,
    },
    /// A query about an object that the table does not have.
    #[error("there is no object {object}, only {n_objects}")]
    NoObject {
        /// The object.
        object: ObjectId,
        /// Number of objects.
        n_objects: u32,
    },
    /// A query about a portal that the table does not have.
    #[error("there is no portal {portal}, only {n_portals}")]
    NoPortal {
        /// The portal.
        portal: PortalId,
        /// Number of portals.
        n_portals: u32,
    },
    /// A query about a node that the stab trees do not have.
    #[error("there is no node {node}, only {n_nodes}")]
    NoNode {
        /// The node.
        node: u32,
        /// Number of nodes.
        n_nodes: u32,
    },
}

impl PackedErrorKind {
    /// Whether the query was wrong and not the file.
    fn is_question(&self) -> bool {
        use PackedErrorKind::{NoCell, NoNode, NoObject, NoPortal};
        matches!(self, NoCell { .. } | NoObject { .. } | NoPortal { .. } | NoNode { .. })
    }
}

/// Why a table cannot be packed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// Even the coarsest table is larger than the budget.
    #[error("a budget of {budget} bytes cannot be kept: {smallest} bytes is the least that was reached")]
    Budget {
        /// The budget.
        budget: u64,
        /// The size after all merges.
        smallest: u64,
    },
    /// One record (the row or the lists of a cell, an object, a portal) is larger than a block may be.
    #[error(
        "a record of store {store} has {bytes} bytes; a block holds no more than {}",
        crate::format::MAX_UNPACKED_BLOCK
    )]
    Record {
        /// The store.
        store: SectionId,
        /// Size of the record.
        bytes: u64,
    },
    /// More entries than 32 bits count.
    #[error("store {store} has more entries than 32 bits can count")]
    TooMany {
        /// The store.
        store: SectionId,
    },
    /// zstd failed.
    #[error("zstd cannot pack a block of store {store}")]
    Zstd {
        /// The store.
        store: SectionId,
    },
}

/// Why a table cannot be written row by row.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The file cannot be written.
    #[error("cannot write: {0}")]
    Io(#[from] io::Error),
    /// The parts are not valid.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Something cannot be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// More or fewer rows than cells.
    #[error("{n_rows} rows do not fit {n_cells} cells")]
    NumberOfRows {
        /// Number of rows.
        n_rows: u64,
        /// Number of cells.
        n_cells: u32,
    },
    /// A row with a cell or an object that does not exist.
    #[error("a row of cell {cell} has an entry that does not exist")]
    Unknown {
        /// The cell.
        cell: CellId,
    },
    /// A row that is not ascending.
    #[error("a row of cell {cell} is not ascending")]
    Order {
        /// The cell.
        cell: CellId,
    },
    /// A cell that does not see itself.
    #[error("cell {cell} does not see itself")]
    NotReflexive {
        /// The cell.
        cell: CellId,
    },
    /// A row of objects where there are none, or none where there are.
    #[error("cell {cell} {} a row of objects", if *.expected { "lacks" } else { "must not have" })]
    RowOfObjects {
        /// The cell.
        cell: CellId,
        /// Whether there are rows of objects.
        expected: bool,
    },
    /// A cell that does not see an object that touches it.
    #[error("cell {cell} does not see object {object}, which touches it")]
    Unseen {
        /// The cell.
        cell: CellId,
        /// The object.
        object: ObjectId,
    },
}
