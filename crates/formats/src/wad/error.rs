//! What can be wrong with a WAD.

use super::LumpName;
use std::fmt;

/// A lump in an error message, shown as `lump 3 (LINEDEFS)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LumpId {
    /// Its index in the directory.
    pub index: usize,
    /// Its name.
    pub name: LumpName,
}

impl fmt::Display for LumpId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "lump {} ({})", self.index, self.name)
    }
}

/// Why bytes are not a WAD, or a WAD cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WadError {
    /// Fewer bytes than a header has.
    #[error("not a WAD: {len} bytes are less than a header")]
    NoHeader {
        /// Bytes there are.
        len: usize,
    },
    /// The first four bytes are neither `IWAD` nor `PWAD`.
    #[error("not a WAD: it begins with \"{}\", not IWAD or PWAD", found.escape_ascii())]
    Magic {
        /// The bytes there.
        found: [u8; 4],
    },
    /// The directory is not inside the file.
    #[error("the directory ({count} lumps at byte {offset}) is not inside the file of {file_len} bytes")]
    Directory {
        /// Where it is according to the header.
        offset: i32,
        /// How many entries it has according to the header.
        count: i32,
        /// Length of the file.
        file_len: u64,
    },
    /// A lump is not inside the file.
    #[error("{lump}: {size} bytes at byte {offset} are not inside the file of {file_len} bytes")]
    LumpRange {
        /// The lump.
        lump: LumpId,
        /// Its place, as the directory has it.
        offset: i32,
        /// Its size, as the directory has it.
        size: i32,
        /// Length of the file.
        file_len: u64,
    },
    /// A lump lies over the header.
    #[error("{lump} overlaps the header")]
    OverlapsHeader {
        /// The lump.
        lump: LumpId,
    },
    /// A lump lies over the directory.
    #[error("{lump} overlaps the directory")]
    OverlapsDirectory {
        /// The lump.
        lump: LumpId,
    },
    /// Two lumps share some bytes, but not all.
    #[error("{first} and {second} overlap")]
    Overlap {
        /// The one that comes first in the directory.
        first: LumpId,
        /// The other.
        second: LumpId,
    },
    /// A name that is empty, longer than eight characters, or not ASCII.
    #[error("\"{}\" cannot be the name of a lump: it takes 1 to 8 ASCII characters", name.escape_debug())]
    Name {
        /// The name.
        name: String,
    },
    /// The file to be written would be larger than its 32-bit places can say.
    #[error("lump {lump} would end at byte {end}, past what a WAD can hold")]
    TooLarge {
        /// Index of the lump, or the number of lumps for the directory.
        lump: usize,
        /// Where it would end.
        end: u64,
    },
    /// An edit names a lump that is not there.
    #[error("there is no lump {lump} among {n_lumps}")]
    NoSuchLump {
        /// The index.
        lump: usize,
        /// How many there are.
        n_lumps: usize,
    },
    /// A map has neither a REJECT lump to replace nor a SECTORS or, as text, ENDMAP lump to put one beside.
    #[error("map {map} has no SECTORS or ENDMAP lump beside which REJECT could stand")]
    NoPlace {
        /// The map's marker.
        map: LumpName,
    },
}

impl From<WadError> for crate::ReadErrorKind {
    fn from(error: WadError) -> Self {
        Self::content(error)
    }
}
