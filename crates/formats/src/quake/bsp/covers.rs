//! Which faces of a map's world hide what is behind them.

use super::leaf::MODELS;
use super::tree::PLANES;
use super::{Bsp, BspError, BspFormat, i32_at, u16_at, u32_at};
use sightlines_geometry::Point3;

/// Bytes of a plane.
const PLANE_LEN: usize = 20;
/// Bytes of the record of a face's texture: Quake's, and Quake II's.
const TEXINFO_LEN: [usize; 2] = [40, 76];
/// Where it names the texture, and where it has the flags of the surface: behind 8 floats.
const TEXTURE: usize = 32;
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
    /// How the faces of the world hide, in the order of [`Bsp::world_faces`]. O(file).
    ///
    /// # Errors
    /// [`BspError`] for lumps that are not a whole number of records, and for a face, plane or texture record that is not there.
    ///
    /// # Source
    /// As [`Bsp::parse`]; that engines draw textures whose names begin with `{` with holes, and those with `*` as liquids, is a convention of
    /// theirs.
    pub fn face_covers(&self) -> Result<Vec<FaceCover>, BspError> {
        let is_quake2 = self.format() == BspFormat::Quake2;
        let is_wide = matches!(self.format(), BspFormat::Bsp2 | BspFormat::Bsp2Psb);
        let (faces_lump, info_lump) = if is_quake2 { (6, 5) } else { (7, 6) };
        let face_len = if is_wide { 28 } else { 20 };
        let info_len = TEXINFO_LEN[usize::from(is_quake2)];
        let (faces, infos) = (self.records(faces_lump, face_len)?, self.records(info_lump, info_len)?);
        let planes = self.records(PLANES, PLANE_LEN)?;
        let n_infos = infos.len() / info_len;
        let cover = |k: usize| -> Result<FaceCover, BspError> {
            let face = &faces[k * face_len..][..face_len];
            let (plane, side, info) = match is_wide {
                true => (i64::from(i32_at(face, 0)), i32_at(face, 4), i64::from(i32_at(face, 16))),
                false => (i64::from(u16_at(face, 0)), i32::from(u16_at(face, 2)), i64::from(u16_at(face, 10))),
            };
            let plane = self.named((faces_lump, k), plane, PLANES, planes.len() / PLANE_LEN)?;
            let info = self.named((faces_lump, k), info, info_lump, n_infos)?;
            let record = &infos[info * info_len..][..info_len];
            let is_opaque = if is_quake2 {
                u32_at(record, TEXTURE) & SEE_THROUGH == 0
            } else {
                self.is_opaque_texture(i32_at(record, TEXTURE))
            };
            let number = |k: usize| f64::from(f32::from_bits(u32_at(planes, PLANE_LEN * plane + 4 * k)));
            Ok(FaceCover {
                normal: [number(0), number(1), number(2)],
                distance: number(3),
                side: u8::from(side != 0),
                is_opaque,
            })
        };
        let model = self.world_model()?;
        let at = if is_quake2 { 40 } else { 56 };
        let run = [i32_at(model, at), i32_at(model, at + 4)].map(i64::from);
        let models = if is_quake2 { 13 } else { MODELS };
        self.run((models, 0), run, faces_lump, faces.len() / face_len)?.map(cover).collect()
    }

    /// Whether a texture of Quake hides what is behind it, by its name.
    fn is_opaque_texture(&self, index: i32) -> bool {
        let lump = self.lump_bytes(2);
        let name = || {
            let index = usize::try_from(index).ok()?;
            let n = usize::try_from(i32::from_le_bytes(*lump.first_chunk::<4>()?)).ok()?;
            let place = lump.get(4 + 4 * index..8 + 4 * index).filter(|_| index < n)?;
            let start = usize::try_from(i32_at(place, 0)).ok()?;
            lump.get(start..start.checked_add(NAME_LEN)?)
        };
        let begins =
            |name: &[u8], with: &str| name.get(..with.len()).is_some_and(|n| n.eq_ignore_ascii_case(with.as_bytes()));
        !name().is_some_and(|name| ["{", "*", "!", "skip"].into_iter().any(|with| begins(name, with)))
    }
}
