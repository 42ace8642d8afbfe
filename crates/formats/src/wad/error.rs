//! Why a WAD cannot be written.

use super::LumpName;

/// Why a WAD cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WadError {
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
    /// A map has more sides than lines can name.
    #[error("map {map}: SIDEDEFS: {n_sides} sides are more than lines can name")]
    TooManySides {
        /// The map's marker.
        map: LumpName,
        /// How many it has.
        n_sides: usize,
    },
}
