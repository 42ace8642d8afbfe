//! Writing maps: from lines and sectors to lumps, for generators and tests.

use super::MapFormat;
use crate::wad::{LumpName, WadBuilder, WadError, WadKind};

/// A line of a map to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceLine {
    /// Index of the vertex it starts at.
    pub v1: u16,
    /// Index of the vertex it ends at.
    pub v2: u16,
    /// Flags; see [`super::ML_TWOSIDED`].
    pub flags: u16,
    /// The sector on the right hand going from `v1` to `v2`, if the line has that side.
    pub right: Option<u16>,
    /// The sector on the left hand, if the line has that side.
    pub left: Option<u16>,
}

/// A thing of a map to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceThing {
    /// Where it stands, in map units.
    pub x: i16,
    /// Where it stands, in map units.
    pub y: i16,
    /// Its number among the things of its game.
    pub kind: u16,
}

/// A map to be written. Nothing is checked: wrong maps can be made as well.
///
/// What sight does not depend on (heights, textures) is written as zeros and dashes, nodes and
/// blockmap as empty lumps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoomMapSource {
    /// Points x, y in map units.
    pub vertices: Vec<[i16; 2]>,
    /// Lines between them.
    pub lines: Vec<SourceLine>,
    /// Number of sectors.
    pub n_sectors: u16,
    /// Things.
    pub things: Vec<SourceThing>,
    /// Bytes of the REJECT lump; no lump at all for `None`.
    pub reject: Option<Vec<u8>>,
    /// Whether to write the map as [`MapFormat::Hexen`]; otherwise it is written as [`MapFormat::Doom`].
    pub hexen: bool,
}

/// A WAD with one map in it, named `name`.
///
/// # Errors
/// As [`DoomMapSource::add_to`].
pub fn write_doom_map(name: LumpName, source: &DoomMapSource) -> Result<Vec<u8>, WadError> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    source.add_to(&mut builder, name)?;
    builder.finish()
}

impl DoomMapSource {
    /// Appends the map to a WAD: a marker named `name`, then its lumps in the order that engines expect.
    ///
    /// # Errors
    /// [`WadError::TooManySides`] from 65,535 sides on, [`WadError::TooLarge`].
    pub fn add_to(&self, builder: &mut WadBuilder, name: LumpName) -> Result<(), WadError> {
        let n_sides = self.lines.iter().flat_map(|l| [l.right, l.left]).flatten().count();
        if n_sides >= 0xFFFF {
            return Err(WadError::TooManySides { map: name, n_sides });
        }
        let (lines, sides) = self.lines_and_sides();
        builder.lump_named(name, b"")?;
        builder.lump("THINGS", &self.thing_bytes())?.lump("LINEDEFS", &lines)?.lump("SIDEDEFS", &sides)?;
        let vertices: Vec<u8> = self.vertices.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        builder.lump("VERTEXES", &vertices)?.lump("SEGS", b"")?.lump("SSECTORS", b"")?.lump("NODES", b"")?;
        builder.lump("SECTORS", &vec![0; 26 * usize::from(self.n_sectors)])?;
        if let Some(reject) = &self.reject {
            builder.lump("REJECT", reject)?;
        }
        builder.lump("BLOCKMAP", b"")?;
        if self.hexen {
            builder.lump("BEHAVIOR", b"")?;
        }
        Ok(())
    }

    fn lines_and_sides(&self) -> (Vec<u8>, Vec<u8>) {
        let (mut lines, mut sides) = (Vec::new(), Vec::new());
        let mut side = |sector: Option<u16>| {
            let Some(sector) = sector else { return u16::MAX };
            let index = u16::try_from(sides.len() / 30).expect("fewer than 65,535 sides, as checked");
            sides.extend_from_slice(&[0; 4]);
            sides.extend_from_slice(b"-\0\0\0\0\0\0\0-\0\0\0\0\0\0\0-\0\0\0\0\0\0\0");
            sides.extend_from_slice(&sector.to_le_bytes());
            index
        };
        for line in &self.lines {
            let special: &[u8] = if self.hexen { &[0; 6] } else { &[0; 4] };
            lines.extend([line.v1, line.v2, line.flags].iter().flat_map(|n| n.to_le_bytes()));
            lines.extend_from_slice(special);
            lines.extend([side(line.right), side(line.left)].iter().flat_map(|n| n.to_le_bytes()));
        }
        (lines, sides)
    }

    fn thing_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for thing in &self.things {
            let [x, y, kind] = [thing.x.to_le_bytes(), thing.y.to_le_bytes(), thing.kind.to_le_bytes()];
            let record = if self.hexen {
                [&[0; 2], &x[..], &y, &[0; 4], &kind, &[0; 8]].concat()
            } else {
                [&x[..], &y, &[0; 2], &kind, &[0; 2]].concat()
            };
            bytes.extend(record);
        }
        bytes
    }

    /// How the map is written.
    pub fn format(&self) -> MapFormat {
        if self.hexen { MapFormat::Hexen } else { MapFormat::Doom }
    }
}
