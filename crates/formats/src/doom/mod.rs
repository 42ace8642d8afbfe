//! Doom maps inside WADs: which there are, what is in them, and their REJECT lumps.
//!
//! The reader takes binary maps of Doom and Hexen and maps as text (UDMF) of any namespace, and of them only what sight depends
//! on: vertices, lines, sides, the number of sectors, things. Lumps that node builders make are passed through,
//! whatever their format. Maps of the console games are recognised and refused by name.

mod content;
mod engine;
mod list;
mod lumps;
mod map;
mod records;
mod rmb;
mod source;
mod udmf;

pub use content::Game;
pub use content::{LineDef, Thing};
pub use list::{MapChoiceError, MapLumps, choose_map, list_maps};
pub use lumps::{MapFormat, MapLump};
pub use map::DoomMap;
pub use rmb::RmbFile;
pub use source::{DoomMapSource, SourceLine, SourceThing, write_doom_map};

use crate::wad::{Edit, LumpName, Wad, WadError};

/// Flag of a line that lets sight through: set on lines that open from one sector into another. See [`Game`].
pub const ML_TWOSIDED: u16 = 4;

/// Most sectors that a map can have: sides of binary maps name theirs by 16 bits. Maps as text with more are refused.
pub const MAX_SECTORS: u32 = 1 << 16;

impl Wad {
    /// The file with new REJECT lumps for some maps; all other lumps as [`Wad::with_edits`] says.
    ///
    /// A map without a REJECT lump gets one behind its SECTORS lump, where engines look for it; a map as text gets it before its
    /// ENDMAP lump, behind all others, of which engines look for each by its name.
    /// If one map is given twice, the later table counts.
    ///
    /// # Errors
    /// [`WadError::NoPlace`] for a map without any of them, [`WadError::NoSuchLump`] for one that was
    /// not listed from this file, [`WadError::TooLarge`].
    pub fn with_rejects(&self, rejects: &[(&MapLumps, Vec<u8>)]) -> Result<Vec<u8>, WadError> {
        let edit = |(map, bytes): &(&MapLumps, Vec<u8>)| {
            let bytes = bytes.clone();
            match (map.lump(MapLump::Reject), map.before_reject()) {
                (Some(lump), _) => Ok(Edit::Replace { lump, bytes }),
                (None, Some(lump)) => Ok(Edit::InsertAfter { lump, name: REJECT, bytes }),
                (None, None) => Err(WadError::NoPlace { map: map.name() }),
            }
        };
        self.with_edits(&rejects.iter().map(edit).collect::<Result<Vec<_>, _>>()?)
    }
}

const REJECT: LumpName = LumpName::from_raw(*b"REJECT\0\0");
