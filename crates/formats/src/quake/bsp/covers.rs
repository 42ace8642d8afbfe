//! Which faces of a map's world hide what is behind them.

use super::Bsp;
use super::layout::FaceForm;
use crate::bytes::{i32_at, u16_at, u32_at};
use crate::error::Malformed;
use sightlines_geometry::Point3;

/// What tells whether a face is opaque: the records of textures, and what they say.
struct Textures {
    lump: usize,
    len: usize,
    says: Says,
}

#[derive(Clone, Copy)]
enum Says {
    /// The index of a texture, whose name tells (Quake, Half-Life, Hexen II).
    Name,
    /// Flags (Quake II).
    Flags,
}

/// Where both are in a record: behind 8 floats.
const SAID: usize = 32;
/// How the names of textures of Quake and Half-Life begin that are seen through, or not drawn.
const NOT_OPAQUE: [&str; 11] =
    ["{", "*", "!", "skip", "hint", "null", "clip", "nodraw", "trigger", "aaatrigger", "origin"];
/// Bytes of a texture's name.
const NAME_LEN: usize = 16;

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
        let textures = match self.format().has_clusters() {
            true => Textures { lump: 5, len: 76, says: Says::Flags },
            false => Textures { lump: 6, len: 40, says: Says::Name },
        };
        let (own, len) = (layout.faces.lump, layout.faces.len);
        let is_wide = len == 28;
        let faces = self.records(own, len)?;
        let infos = self.records(textures.lump, textures.len)?;
        let planes = self.records(layout.planes.lump, layout.planes.len)?;
        let (n_planes, n_infos) = (planes.len() / layout.planes.len, infos.len() / textures.len);
        let cover = |k: usize| -> Result<FaceCover, Malformed> {
            let face = &faces[k * len..][..len];
            let (plane, side, info) = match is_wide {
                true => (i64::from(i32_at(face, 0)), i32_at(face, 4), i64::from(i32_at(face, 16))),
                false => (i64::from(u16_at(face, 0)), i32::from(u16_at(face, 2)), i64::from(u16_at(face, 10))),
            };
            let plane = self.named((own, k), plane, layout.planes.lump, n_planes)?;
            let info = self.named((own, k), info, textures.lump, n_infos)?;
            let record = &infos[info * textures.len..][..textures.len];
            let is_opaque = match textures.says {
                Says::Flags => u32_at(record, SAID) & SEE_THROUGH == 0,
                Says::Name => self.is_opaque_texture(i32_at(record, SAID)),
            };
            let number = |k: usize| f64::from(f32::from_bits(u32_at(planes, layout.planes.len * plane + 4 * k)));
            let normal = [number(0), number(1), number(2)];
            Ok(FaceCover { normal, distance: number(3), side: u8::from(side != 0), is_opaque })
        };
        let (model, at) = (self.world_model()?, layout.model_faces);
        let run = [i32_at(model, at), i32_at(model, at + 4)].map(i64::from);
        let world = self.run((layout.models.lump, 0), run, own, faces.len() / len)?;
        world.map(cover).collect::<Result<_, _>>().map(Some)
    }

    /// Whether a texture of Quake hides what is behind it, by its name.
    fn is_opaque_texture(&self, index: i32) -> bool {
        let lump = self.lump_bytes(2);
        let name = || {
            let n = usize::try_from(i32::from_le_bytes(*lump.first_chunk::<4>()?)).ok()?;
            let index = usize::try_from(index).ok().filter(|&index| index < n)?;
            let place = lump[4..].chunks_exact(4).nth(index)?;
            let start = usize::try_from(i32_at(place, 0)).ok()?;
            lump.get(start..start.checked_add(NAME_LEN)?)
        };
        let begins =
            |name: &[u8], with: &str| name.get(..with.len()).is_some_and(|n| n.eq_ignore_ascii_case(with.as_bytes()));
        !name().is_some_and(|name| NOT_OPAQUE.into_iter().any(|with| begins(name, with)))
    }
}
