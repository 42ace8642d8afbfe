//! Why bytes are not a table.

use crate::TableError;
use std::fmt;

/// The four characters that name a section.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SectionId(pub [u8; 4]);

impl fmt::Display for SectionId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.escape_ascii().fmt(f)
    }
}

impl fmt::Debug for SectionId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Why bytes are not a table, and where the defect is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DecodeError {
    /// The section; `None` for what precedes the sections.
    pub section: Option<SectionId>,
    /// Byte offset from the beginning of the file.
    pub offset: u64,
    /// The defect.
    pub kind: DecodeErrorKind,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.section {
            Some(section) => write!(f, "byte {}, section {section}: {}", self.offset, self.kind),
            None => write!(f, "byte {}: {}", self.offset, self.kind),
        }
    }
}

impl std::error::Error for DecodeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.kind)
    }
}

/// A defect in bytes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecodeErrorKind {
    /// The first bytes are not those of a table.
    #[error("this is no visibility table")]
    Magic,
    /// A version that is too new, or never existed.
    #[error("version {major} of the format; this reader knows version {}", super::MAJOR)]
    Major {
        /// The version found.
        major: u16,
    },
    /// The bytes end inside the header or the section table.
    #[error("the header needs {need} bytes, but there are {len}")]
    HeaderCut {
        /// Bytes needed.
        need: u64,
        /// Number of bytes.
        len: u64,
    },
    /// The bytes are truncated, or something follows them.
    #[error("the table says that it has {stated} bytes, but there are {len}")]
    Length {
        /// The length that the header states.
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
    /// A byte that must be zero is not.
    #[error("a byte that must be zero is not")]
    NotZero,
    /// A section that does not begin where the one before ended, or ends outside the file.
    #[error("the section does not lie where it must")]
    Misplaced,
    /// Flags that this version does not have, or not for this section.
    #[error("the section has flags {flags:#x}")]
    Flags {
        /// The flags.
        flags: u32,
    },
    /// A section that is neither optional nor known.
    #[error("the section is needed and unknown")]
    Unknown,
    /// A section that occurs twice.
    #[error("the section is there twice")]
    Repeated,
    /// A required section is missing.
    #[error("the section is missing")]
    Missing,
    /// A count implies more bytes than the section has left.
    #[error("{need} bytes are promised, but the section has {left} left")]
    Cut {
        /// Bytes needed.
        need: u64,
        /// Bytes left in the section.
        left: u64,
    },
    /// The section is longer than its counts imply.
    #[error("the section has {left} bytes too many")]
    Surplus {
        /// Bytes left over.
        left: u64,
    },
    /// A field has an invalid value.
    #[error("{value} is not possible here")]
    Value {
        /// The value.
        value: u32,
    },
    /// A text that is not UTF-8.
    #[error("the text is not UTF-8")]
    Text,
    /// A row has bits past the diagonal.
    #[error("row {row} has bits past the diagonal")]
    PastDiagonal {
        /// The row.
        row: u32,
    },
    /// A number that is longer than necessary, or too large.
    #[error("the number is not written as short as it can be, or is too large")]
    Number,
    /// A reference to a node of stab trees that does not exist yet.
    #[error("the node of the stab trees is not there")]
    NoNode,
    /// Stab trees that are not in their canonical form.
    #[error("the stab trees are not in order")]
    StabOrder,
    /// The content violates a rule of tables; the offset is that of the section.
    #[error(transparent)]
    Table(#[from] TableError),
}
