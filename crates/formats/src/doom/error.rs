//! What can be wrong with a Doom map.

use super::{MAX_SECTORS, MapFormat, MapLump, TextError};
use crate::wad::{LumpName, WadError};

/// A map that cannot be used, shown as `map MAP01: LINEDEFS 12: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("map {map}: {kind}")]
pub struct DoomError {
    /// The map's marker.
    pub map: LumpName,
    /// What is wrong with it.
    #[source]
    pub kind: DoomErrorKind,
}

/// What is wrong with a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DoomErrorKind {
    /// A format that is recognised but not read.
    #[error("maps in {0} format are not supported")]
    Unsupported(MapFormat),
    /// A lump that every map needs is not there.
    #[error("{0}: there is no such lump")]
    MissingLump(MapLump),
    /// A lump is there twice, so that it is open which one counts.
    #[error("{lump}: there are two such lumps, {} and {}", indices[0], indices[1])]
    RepeatedLump {
        /// Which lump.
        lump: MapLump,
        /// The two in the directory.
        indices: [usize; 2],
    },
    /// The size of a lump is not a multiple of its records' size.
    #[error("{lump}: {size} bytes do not divide into records of {record}; record {index} is cut short")]
    RecordSize {
        /// Which lump.
        lump: MapLump,
        /// Its bytes.
        size: usize,
        /// Bytes per record.
        record: usize,
        /// Index of the record that is cut short.
        index: usize,
    },
    /// The text of a map is wrong somewhere.
    #[error("TEXTMAP: {0}")]
    Text(#[from] TextError),
    /// A map as text has no last lump.
    #[error("ENDMAP: there is no such lump behind TEXTMAP")]
    NoEnd,
    /// The map has no lines of any length, or no sectors.
    #[error("{0}: the map is empty")]
    Empty(MapLump),
    /// More sectors than binary maps can name.
    #[error("SECTORS: {0} sectors are more than the {MAX_SECTORS} that a map can have")]
    TooManySectors(usize),
    /// A line ends at a vertex that is not there.
    #[error("LINEDEFS {line}: vertex {vertex} is not among the {n_vertices} there are")]
    Vertex {
        /// Index of the line.
        line: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        n_vertices: usize,
    },
    /// A line has a side that is not there.
    #[error("LINEDEFS {line}: side {side} is not among the {n_sides} there are")]
    Side {
        /// Index of the line.
        line: usize,
        /// The side it names.
        side: u32,
        /// How many there are.
        n_sides: usize,
    },
    /// A side faces a sector that is not there.
    #[error("SIDEDEFS {side}: sector {sector} is not among the {n_sectors} there are")]
    Sector {
        /// Index of the side.
        side: usize,
        /// The sector it names.
        sector: u32,
        /// How many there are.
        n_sectors: u32,
    },
    /// More sides than lines can name, when writing.
    #[error("SIDEDEFS: {0} sides are more than lines can name")]
    TooManySides(usize),
    /// The WAD cannot be written.
    #[error(transparent)]
    Wad(#[from] WadError),
}

impl From<DoomError> for crate::ReadErrorKind {
    fn from(error: DoomError) -> Self {
        Self::content(error)
    }
}
