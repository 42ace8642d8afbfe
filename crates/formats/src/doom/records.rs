//! The records of binary maps.

use super::content::{Content, LineDef, Numbering, Thing};
use super::{Game, MapFormat, MapLump, MapLumps};
use crate::bytes::{i16_at, u16_at};
use crate::error::{Malformed, malformed};
use crate::wad::Wad;

/// Reads the lumps of a map in a binary format.
pub(super) fn parse(wad: &Wad, lumps: &MapLumps) -> Result<Content, Malformed> {
    let read = Records { wad, lumps };
    let hexen = lumps.format() == MapFormat::Hexen;
    let point = |r| [f64::from(i16_at(r, 0)), f64::from(i16_at(r, 2))];
    let vertices = read.of(MapLump::Vertexes, 4)?.map(point).collect();
    let lines = read.of(MapLump::Linedefs, if hexen { 16 } else { 14 })?;
    let special = |r: &[u8]| if hexen { r[6].into() } else { u16_at(r, 6).into() };
    let specials = lines.clone().map(special).collect();
    let lines = lines.map(line_def).collect();
    let side_sectors = read.of(MapLump::Sidedefs, 30)?.map(|r| u32::from(u16_at(r, 28))).collect();
    let n_sectors = read.of(MapLump::Sectors, 26)?.len();
    let things = match (lumps.lump(MapLump::Things), hexen) {
        (None, _) => Vec::new(),
        (Some(_), false) => read.of(MapLump::Things, 10)?.map(|r| thing(r, 0, 6)).collect(),
        (Some(_), true) => read.of(MapLump::Things, 20)?.map(|r| thing(r, 2, 10)).collect(),
    };
    let game = hexen.then_some(Game::Hexen);
    let numbering = if hexen { Numbering::Hexen } else { Numbering::Doom };
    Ok(Content { vertices, lines, side_sectors, n_sectors, things, specials, numbering, game })
}

struct Records<'w> {
    wad: &'w Wad,
    lumps: &'w MapLumps,
}

impl<'w> Records<'w> {
    /// The records of a lump, each of `record` bytes.
    fn of(&self, lump: MapLump, record: usize) -> Result<std::slice::ChunksExact<'w, u8>, Malformed> {
        let bytes = self.wad.lump_bytes(self.lumps.require(lump)?);
        let (size, index) = (bytes.len(), bytes.len() / record);
        if size % record != 0 {
            let what = malformed!("{size} bytes do not divide into records of {record}; record {index} is cut short");
            return Err(what.within(lump));
        }
        Ok(bytes.chunks_exact(record))
    }
}

/// A line of either format: vertices and flags come first, sides last.
fn line_def(record: &[u8]) -> LineDef {
    let side = |at: usize| Some(u32::from(u16_at(record, at))).filter(|&s| s != 0xFFFF);
    LineDef {
        v1: u16_at(record, 0).into(),
        v2: u16_at(record, 2).into(),
        flags: u16_at(record, 4),
        right: side(record.len() - 4),
        left: side(record.len() - 2),
    }
}

fn thing(record: &[u8], place_at: usize, kind_at: usize) -> Thing {
    let [x, y] = [place_at, place_at + 2].map(|at| f64::from(i16_at(record, at)));
    Thing { x, y, kind: u16_at(record, kind_at).into() }
}
