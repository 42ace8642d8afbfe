//! Which faces of a map's world hide what is behind them.

use super::Bsp;
use super::faces::{TEXTURES, texture_name};
use super::layout::{FaceForm, Records};
use crate::bytes::{begins_with, i32_at, u16_at, u32_at};
use crate::error::Malformed;
use sightlines_geometry::Point3;

/// Where a record of a texture has what tells whether faces are opaque, behind 8 floats: flags (Quake II), or the index of a texture, whose
/// name tells (Quake, Half-Life, Hexen II).
const SAID: usize = 32;
/// How the names of textures of Quake and Half-Life begin that are seen through, or not drawn.
const NOT_OPAQUE: [&str; 11] =
    ["{", "*", "!", "skip", "hint", "null", "clip", "nodraw", "trigger", "aaatrigger", "origin"];

/// Flags of Quake II's surfaces that light passes, or that are not drawn: two kinds of translucence, undrawn, hint, skip, and
/// the holes of textures that some engines know.
const SEE_THROUGH: u32 = 0x10 | 0x20 | 0x80 | 0x100 | 0x200 | 0x0200_0000;

/// A face, as far as it hides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceCover {
    /// Normal of the plane that it lies on, as a node of the tree has it.
    pub normal: Point3,
    /// The plane's distance, as a node of the tree has it.
    pub distance: f64,
    /// The side of that plane from which it is drawn: 0 in front, 1 behind.
    pub side: u8,
    /// Whether nothing is seen through it. Liquids, textures with holes (`{`) and surfaces that are not drawn are not opaque; a texture
    /// that the map does not have, is.
    pub is_opaque: bool,
}

impl Bsp {
    /// How the faces of the world hide, in the order of [`Bsp::world_faces`]; `None` for Quake III and its relatives, whose faces name no plane, and whose
    /// leafs are opaque or not as a whole. O(file).
    ///
    /// # Errors
    /// [`Malformed`] for lumps that are not a whole number of records, and for a face, plane or texture record that is not there.
    ///
    /// # Source
    /// As [`Bsp::parse`]; that engines draw textures whose names begin with `{` with holes, and those with `*` or `!` as liquids, is a convention of
    /// theirs.
    pub fn face_covers(&self) -> Result<Option<Vec<FaceCover>>, Malformed> {
        let layout = self.format().layout();
        if matches!(layout.face_form, FaceForm::Vertices { .. }) {
            return Ok(None);
        }
        let has_flags = self.format().has_clusters();
        let is_wide = layout.faces.len == 28;
        let faces = self.records(layout.faces)?;
        let infos =
            self.records(if has_flags { Records { lump: 5, len: 76 } } else { Records { lump: 6, len: 40 } })?;
        let planes = self.records(layout.planes)?;
        let cover = |k: usize| -> Result<FaceCover, Malformed> {
            let (face, by) = (faces.get(k), (faces.lump, k));
            let (plane, side, info) = match is_wide {
                true => (i64::from(i32_at(face, 0)), i32_at(face, 4), i64::from(i32_at(face, 16))),
                false => (i64::from(u16_at(face, 0)), i32::from(u16_at(face, 2)), i64::from(u16_at(face, 10))),
            };
            let plane = planes.get(planes.named(by, plane)?);
            let record = infos.get(infos.named(by, info)?);
            let is_opaque = match has_flags {
                true => u32_at(record, SAID) & SEE_THROUGH == 0,
                false => self.is_opaque_texture(i32_at(record, SAID)),
            };
            let number = |k: usize| f64::from(f32::from_bits(u32_at(plane, 4 * k)));
            let normal = [number(0), number(1), number(2)];
            Ok(FaceCover { normal, distance: number(3), side: u8::from(side != 0), is_opaque })
        };
        self.world_face_run(&faces)?.map(cover).collect::<Result<_, _>>().map(Some)
    }

    /// Whether a texture of Quake hides what is behind it, by its name.
    fn is_opaque_texture(&self, index: i32) -> bool {
        let lump = self.lump_bytes(TEXTURES);
        let name = || {
            let n = usize::try_from(i32::from_le_bytes(*lump.first_chunk::<4>()?)).ok()?;
            let index = usize::try_from(index).ok().filter(|&index| index < n)?;
            texture_name(lump, i32_at(lump[4..].chunks_exact(4).nth(index)?, 0))
        };
        !name().is_some_and(|name| NOT_OPAQUE.into_iter().any(|with| begins_with(name, with)))
    }
}
