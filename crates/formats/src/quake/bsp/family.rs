//! Formats that begin alike, told apart by what follows.

use super::tree::plane_of;
use super::{BspFormat, lump_range};
use crate::bytes::i32_at;
use crate::error::{Malformed, malformed};

const BLUE_SHIFT: &str = "lump 0 has planes and lump 1 has none, as in maps of Half-Life: Blue Shift, which are not read; with the first \
                          two entries of the directory exchanged this is a map of Half-Life";

const ENTRY: usize = 8;

/// The format of a file whose first bytes are those of `begins`, and which has all of its header.
pub(super) fn told_apart(begins: BspFormat, bytes: &[u8]) -> Result<BspFormat, Malformed> {
    match begins {
        BspFormat::Bsp29 if is_hexen2(bytes) => Ok(BspFormat::Hexen2),
        BspFormat::HalfLife if is_blue_shift(bytes)? => Err(malformed!("{BLUE_SHIFT}")),
        BspFormat::Wolfenstein => refuse_more_lumps(begins, bytes).map(|()| begins),
        _ => Ok(begins),
    }
}

/// Whether a map of version 29 has models of 80 bytes, as Hexen II, rather than 64, as Quake.
///
/// A lump that is a whole number of only one of the two decides. Where it is of both, which takes a multiple of four
/// models of Hexen II or of five of Quake, the faces of models do: compilers give each model the faces behind those of
/// the one before, and the world some. What is read at other places would have to be so by chance. Where neither or both of them
/// have such runs, the map counts as Quake's: for one of Hexen II the tree is the same, and the number of visible leafs is another, which
/// a portal file then contradicts; portals that are made from the map take the leafs beyond that number for parts of passages.
fn is_hexen2(bytes: &[u8]) -> bool {
    let [quake, hexen] = [BspFormat::Bsp29, BspFormat::Hexen2].map(BspFormat::layout);
    let range = |lump: usize| lump_range(BspFormat::Bsp29, bytes, lump);
    // Lumps outside of the file are named by who reads them.
    let (Ok(models), Ok(faces)) = (range(quake.models.lump), range(quake.faces.lump)) else { return false };
    let (models, n_faces) = (&bytes[models], faces.len() / quake.faces.len);
    if models.is_empty() {
        return false;
    }
    let [is_quake, is_hexen] = [quake, hexen].map(|l| models.len().is_multiple_of(l.models.len));
    let has_runs = |layout: &super::layout::Layout| {
        let mut end = 0;
        let records = models.chunks_exact(layout.models.len).map(|m| [0, 4].map(|k| i32_at(m, layout.model_faces + k)));
        let mut follow = records.map(|[first, count]| {
            let follows = i64::from(first) == end && count >= 0;
            end += i64::from(count);
            follows
        });
        follow.all(|follows| follows) && (1..=n_faces as i64).contains(&end)
    };
    is_hexen && (!is_quake || (has_runs(hexen) && !has_runs(quake)))
}

/// Whether a map of version 30 has planes where entities should be. A text is no plane: its bytes as floats are of no unit length.
fn is_blue_shift(bytes: &[u8]) -> Result<bool, Malformed> {
    let is_plane = |lump: usize| -> Result<bool, Malformed> {
        let lump = &bytes[lump_range(BspFormat::HalfLife, bytes, lump)?];
        Ok(lump.len() >= 20 && plane_of(lump).is_some())
    };
    Ok(is_plane(0)? && !is_plane(1)?)
}

/// Refuses an entry behind the directory that names bytes of the file: with it unknown, another lump would move its bytes away.
/// The compilers of version 47 put a text there, whose letters are no place in any file.
fn refuse_more_lumps(format: BspFormat, bytes: &[u8]) -> Result<(), Malformed> {
    let (at, n) = (format.header_len(), format.lump_names().len());
    let starts = (0..n).map(|lump| lump_range(format, bytes, lump));
    let starts = starts.collect::<Result<Vec<_>, _>>()?;
    let first = starts.iter().filter(|range| !range.is_empty()).map(|range| range.start).min();
    if first.unwrap_or(0) < at + ENTRY {
        return Ok(());
    }
    let (offset, len) = (i32_at(bytes, at), i32_at(bytes, at + 4));
    let is_inside = i64::from(offset) >= (at + ENTRY) as i64 && len > 0;
    if is_inside && i64::from(offset) + i64::from(len) <= bytes.len() as i64 {
        let version = i32_at(bytes, 4);
        return Err(malformed!(
            "the directory has an entry for lump {n}, which version {version} does not have: {len} bytes at byte {offset}; \
             such maps (of Quake Live) are not read"
        ));
    }
    Ok(())
}
