//! Why bytes are no packed table, and why a table cannot be packed.

use sightlines_pvs::{CellId, ObjectId, PortalId, SectionId, TableError};
use std::{fmt, io};

/// Why a question to a packed table has no answer, and where that shows.
#[derive(Debug)]
pub struct PackedError {
    /// The section or store; `None` for what stands before them, and for questions about what is not there.
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

    /// A question about something that the table does not have.
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
    /// A version that is too new, or was never there.
    #[error("version {major} of the packed format; this reader knows version {}", crate::format::MAJOR)]
    Major {
        /// The version found.
        major: u16,
    },
    /// The bytes are cut, or something follows them.
    #[error("the packed table says that it has {stated} bytes, but there are {len}")]
    Length {
        /// What the file says.
        stated: u64,
        /// Bytes there are.
        len: u64,
    },
    /// A checksum is wrong: something was changed.
    #[error("the checksum is {computed:08x} instead of {stored:08x}")]
    Checksum {
        /// What was written.
        stored: u32,
        /// What the bytes give.
        computed: u32,
    },
    /// A section that does not begin where the one before ended, or ends outside the file.
    #[error("the section does not lie where it must")]
    Misplaced,
    /// A section that is there twice.
    #[error("the section is there twice")]
    Repeated,
    /// A section that must be there is not.
    #[error("the section is missing")]
    Missing,
    /// A section that is not optional and not known.
    #[error("the section is needed and unknown")]
    Unknown,
    /// Something has another size than it must have.
    #[error("{found} bytes instead of {needed}")]
    Size {
        /// What it must be.
        needed: u64,
        /// What it is.
        found: u64,
    },
    /// A number that cannot stand here.
    #[error("{value} is not possible here")]
    Value {
        /// The number.
        value: u64,
    },
    /// The bytes end inside something.
    #[error("the bytes end inside something")]
    Cut,
    /// More bytes than there is something to say.
    #[error("{left} bytes too many")]
    Surplus {
        /// Bytes left over.
        left: u64,
    },
    /// A text that is not UTF-8.
    #[error("the text is not UTF-8")]
    Text,
    /// A block that zstd cannot unpack to what the index says.
    #[error("the block does not unpack to {raw} bytes")]
    Unpack {
        /// Bytes that it should have.
        raw: u32,
    },
    /// More memory than [`crate::format::MAX_TABLE`] allows.
    #[error("{bytes} bytes would be needed, more than this reader takes")]
    TooLarge {
        /// Bytes needed.
        bytes: u64,
    },
    /// The pages of the coarse table are not what the rows say.
    #[error("page {page} of the coarse table is not what its cells see")]
    Coarse {
        /// The page.
        page: u32,
    },
    /// The exits of a cell are not its portals.
    #[error("the exits of cell {cell} are not its portals")]
    Exits {
        /// The cell.
        cell: CellId,
    },
    /// What was read is no table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A cell that the table does not have was asked for.
    #[error("there is no cell {cell}, only {n_cells}")]
    NoCell {
        /// The cell.
        cell: CellId,
        /// Number of cells.
        n_cells: u32,
    },
    /// An object that the table does not have was asked for.
    #[error("there is no object {object}, only {n_objects}")]
    NoObject {
        /// The object.
        object: ObjectId,
        /// Number of objects.
        n_objects: u32,
    },
    /// A portal that the table does not have was asked for.
    #[error("there is no portal {portal}, only {n_portals}")]
    NoPortal {
        /// The portal.
        portal: PortalId,
        /// Number of portals.
        n_portals: u32,
    },
    /// A node that the stab trees do not have was asked for.
    #[error("there is no node {node}, only {n_nodes}")]
    NoNode {
        /// The node.
        node: u32,
        /// Number of nodes.
        n_nodes: u32,
    },
}

impl PackedErrorKind {
    /// Whether the question was wrong and not the file.
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
        /// The size with nothing left to merge.
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
    /// zstd refuses.
    #[error("zstd cannot pack a block of store {store}")]
    Zstd {
        /// The store.
        store: SectionId,
    },
}
