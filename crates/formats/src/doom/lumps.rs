//! The lumps of a map, and the formats that maps are stored in.

use std::fmt;

/// A lump of a map that is read or written here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapLump {
    /// Where monsters, players and things stand.
    Things,
    /// Lines between vertices.
    Linedefs,
    /// What lines show to each side.
    Sidedefs,
    /// Points.
    Vertexes,
    /// Floors and ceilings.
    Sectors,
    /// Which sectors cannot see each other.
    Reject,
}

impl MapLump {
    pub(super) const ALL: [Self; 6] =
        [Self::Things, Self::Linedefs, Self::Sidedefs, Self::Vertexes, Self::Sectors, Self::Reject];

    /// The lump's name.
    pub const fn name(self) -> &'static str {
        ["THINGS", "LINEDEFS", "SIDEDEFS", "VERTEXES", "SECTORS", "REJECT"][self as usize]
    }
}

impl fmt::Display for MapLump {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How a map is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapFormat {
    /// Binary, lines of 14 bytes.
    Doom,
    /// Binary, lines of 16 bytes, recognized by a BEHAVIOR lump.
    Hexen,
    /// Text, recognized by a TEXTMAP lump.
    Udmf,
    /// Binary with other records, recognized by a LEAFS lump: Doom 64 and the PlayStation.
    Console,
}

impl fmt::Display for MapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["Doom", "Hexen", "UDMF", "console"][*self as usize])
    }
}
