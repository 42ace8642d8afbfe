//! Files with the visibility of maps that stay as they are (VisPatch, `.vis`): engines of Quake read one beside the map in the place of what the map has.
//!
//! A file has a part for each map, one behind the other; numbers are little-endian and have 32 bits:
//!
//! ```text
//! 32  the name of the map's file in ASCII, such as e1m1.bsp, and zeros
//!  4  bytes of the rest of the part
//!  4  bytes of the visibility lump, and the lump
//!  4  bytes of the lump of leafs, and the lump
//! ```
//!
//! Nothing in it says of which version of the map it is; [`VisPatch::put_into`] compares the leafs. Engines take such files for maps of Quake's version 29
//! only.
//!
//! Source: VisPatch 1.0 (2001), as current engines read its files.

use super::bsp::BspFormat;
use super::{Bsp, VisibilityLump};
use crate::bytes::{bytes_at, number_at};
use crate::error::{Malformed, malformed};

const NAME_LEN: usize = 32;
/// Bytes of a leaf, where it has the place of its row, and where its loudness.
const LEAF_LEN: usize = 28;
const LEAF_ROW: usize = 4;
const LEAF_AMBIENT: usize = 24;

/// The visibility of one map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VisPatch {
    /// The name of the map's file, such as `e1m1.bsp`; engines compare it without case.
    pub map: String,
    /// The visibility lump.
    pub visibility: Vec<u8>,
    /// The lump of leafs, with the places of their rows.
    pub leafs: Vec<u8>,
}

impl VisPatch {
    /// What a map has, for a file of that name.
    ///
    /// # Errors
    /// [`Malformed`] for a format other than Quake's version 29, for a map without visibility, and for a name that is not ASCII, empty, or longer than 31
    /// letters.
    pub fn of_map(map: &str, bsp: &Bsp) -> Result<Self, Malformed> {
        Self::check(map, bsp)?;
        if bsp.visibility().is_empty() {
            return Err(malformed!("the map has no visibility"));
        }
        let leafs = bsp.lump_bytes(bsp.format().leaf_lump()).to_vec();
        Ok(Self { map: map.to_owned(), visibility: bsp.visibility().to_vec(), leafs })
    }

    /// Refuses what [`VisPatch::of_map`] would refuse, but for the visibility.
    ///
    /// # Errors
    /// As there.
    pub fn check(map: &str, bsp: &Bsp) -> Result<(), Malformed> {
        check_format(bsp)?;
        match !map.is_empty() && map.len() < NAME_LEN && map.bytes().all(|byte| byte.is_ascii_graphic()) {
            true => Ok(()),
            false => Err(malformed!("{map:?} is no name for a VisPatch file, which takes 31 letters of ASCII")),
        }
    }

    /// The map with this visibility; all else of it keeps its bytes.
    ///
    /// # Errors
    /// [`Malformed`] for a map of another format, and for one whose leafs differ in more than rows and loudness: another map, or another version of it.
    pub fn put_into(&self, bsp: &Bsp) -> Result<Vec<u8>, Malformed> {
        check_format(bsp)?;
        let own = bsp.lump_bytes(bsp.format().leaf_lump());
        let differ = |(a, b): (&[u8], &[u8])| {
            a[..LEAF_ROW] != b[..LEAF_ROW] || a[LEAF_ROW + 4..LEAF_AMBIENT] != b[LEAF_ROW + 4..LEAF_AMBIENT]
        };
        let mut pairs = own.chunks_exact(LEAF_LEN).zip(self.leafs.chunks_exact(LEAF_LEN));
        if own.len() != self.leafs.len() || pairs.any(differ) {
            return Err(malformed!("the visibility for {} is of another map, or of another version of it", self.map));
        }
        let leafs = self.leafs.chunks_exact(LEAF_LEN).skip(1).take(bsp.n_visible_leafs());
        bsp.with_visibility(&VisibilityLump {
            bytes: self.visibility.clone(),
            leaf_rows: leafs.clone().map(|leaf| u32::from_le_bytes(bytes_at(leaf, LEAF_ROW))).collect(),
            ambient: leafs.map(|leaf| bytes_at(leaf, LEAF_AMBIENT)).collect(),
        })
    }
}

fn check_format(bsp: &Bsp) -> Result<(), Malformed> {
    match bsp.format() {
        BspFormat::Bsp29 => Ok(()),
        other => Err(malformed!(
            "engines take VisPatch files for maps of Quake's version 29 only, and this is {}",
            other.name()
        )),
    }
}

/// Reads all parts of a file. O(length).
///
/// # Errors
/// [`Malformed`] with the byte of the part that is wrong.
pub fn parse_vis_patches(bytes: &[u8]) -> Result<Vec<VisPatch>, Malformed> {
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() || found.is_empty() {
        let cut = || malformed!("the part at byte {at} is cut short, or this is no VisPatch file");
        let name = bytes.get(at..at + NAME_LEN).ok_or_else(cut)?;
        let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
        if !(1..NAME_LEN).contains(&name.len()) || !name.iter().all(u8::is_ascii_graphic) {
            return Err(malformed!("the part at byte {at} has no name of a map: this is no VisPatch file"));
        }
        let lump = |begin: usize| {
            let len = number_at(bytes, begin).ok_or_else(cut)? as usize;
            let end = (begin + 4).checked_add(len).ok_or_else(cut)?;
            Ok::<_, Malformed>((bytes.get(begin + 4..end).ok_or_else(cut)?, end))
        };
        let (_, end) = lump(at + NAME_LEN)?;
        let (visibility, between) = lump(at + NAME_LEN + 4)?;
        let (leafs, behind) = lump(between)?;
        if behind != end || !leafs.len().is_multiple_of(LEAF_LEN) {
            return Err(malformed!("the lengths of the part at byte {at} contradict each other"));
        }
        let map = String::from_utf8_lossy(name).into_owned();
        found.push(VisPatch { map, visibility: visibility.to_vec(), leafs: leafs.to_vec() });
        at = end;
    }
    Ok(found)
}

/// The bytes of a file with these parts.
///
/// # Errors
/// [`Malformed`] for lumps of more than 2^31 bytes together.
pub fn write_vis_patches(patches: &[VisPatch]) -> Result<Vec<u8>, Malformed> {
    let mut out = Vec::new();
    for VisPatch { map, visibility, leafs } in patches {
        let mut name = [0; NAME_LEN];
        // The last byte stays zero.
        name[..NAME_LEN - 1].iter_mut().zip(map.bytes()).for_each(|(to, from)| *to = from);
        out.extend_from_slice(&name);
        let len =
            |n: usize| i32::try_from(n).map_err(|_| malformed!("{n} bytes are more than a VisPatch file can have"));
        out.extend(len(8 + visibility.len() + leafs.len())?.to_le_bytes());
        for lump in [visibility, leafs] {
            out.extend(len(lump.len())?.to_le_bytes());
            out.extend_from_slice(lump);
        }
    }
    Ok(out)
}
