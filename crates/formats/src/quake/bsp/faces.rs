//! What can be heard in a leaf: its faces of water, sky and lava.

use super::Bsp;
use crate::bytes::{begins_with, i32_at, u16_at, u32_at};
use crate::error::{Malformed, malformed};

/// The lump of textures.
pub(super) const TEXTURES: usize = 2;
const TEXINFO: usize = 6;
/// Bytes of a texinfo; the texture's index is behind 8 floats.
const TEXINFO_LEN: usize = 40;
const TEXINFO_TEXTURE: usize = 32;
const NAME_LEN: usize = 16;

/// A sound that faces make, by the place of its loudness in a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AmbientKind {
    /// Water and slime.
    Water = 0,
    /// Wind.
    Sky = 1,
    /// Lava. Place 2 is slime's own, and nothing sets it: slime sounds like water.
    Lava = 3,
}

impl AmbientKind {
    const ALL: [Self; 3] = [Self::Water, Self::Sky, Self::Lava];

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// A texture that makes a sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AmbientTexture {
    /// Water, which sounds like itself.
    Water,
    /// Slime, which sounds like water.
    Slime,
    /// Sky, from which wind comes.
    Sky,
    /// Lava.
    Lava,
}

impl AmbientTexture {
    /// All that make a sound.
    pub const ALL: [Self; 4] = [Self::Water, Self::Slime, Self::Sky, Self::Lava];

    /// The kind of a texture, by the beginning of its name, in any case of letters.
    ///
    /// # Source
    /// The manual of ericw-tools' vis (its options that turn sounds off) names the beginnings.
    pub fn of_name(name: &[u8]) -> Option<Self> {
        const BEGINNINGS: [(&str, AmbientTexture); 5] = [
            ("sky", AmbientTexture::Sky),
            ("*lava", AmbientTexture::Lava),
            ("*slime", AmbientTexture::Slime),
            ("*water", AmbientTexture::Water),
            ("*04water", AmbientTexture::Water),
        ];
        BEGINNINGS.into_iter().find(|(with, _)| begins_with(name, with)).map(|(_, texture)| texture)
    }

    /// What it sounds like.
    pub const fn sound(self) -> AmbientKind {
        match self {
            Self::Water | Self::Slime => AmbientKind::Water,
            Self::Sky => AmbientKind::Sky,
            Self::Lava => AmbientKind::Lava,
        }
    }
}

/// Which textures may make sounds; all of them, unless some are turned off.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AmbientTextures {
    off: u8,
}

impl AmbientTextures {
    /// All.
    pub const ALL: Self = Self { off: 0 };

    /// The same without one of them.
    #[must_use]
    pub const fn without(self, texture: AmbientTexture) -> Self {
        Self { off: self.off | 1 << texture as u8 }
    }

    /// Whether a texture may make its sound.
    pub const fn has(self, texture: AmbientTexture) -> bool {
        self.off >> texture as u8 & 1 == 0
    }
}

/// What a face, or an entry of the list of faces, turns out to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Face {
    /// It makes the sounds of these bits.
    Sounds(u8),
    /// Its texture cannot be looked up.
    NoTexture,
    Missing,
}

impl Bsp {
    /// Which sounds the faces of each visible leaf make: bit `k` is set for the [`AmbientKind`] of place `k`.
    /// Zeros in formats [without such sounds](super::BspFormat::has_sounds). O(file).
    ///
    /// A map whose lump of textures is empty makes no sounds.
    ///
    /// # Errors
    /// [`Malformed`] for a list of faces, a face or a texture of a visible leaf that is not there.
    pub fn leaf_sounds(&self) -> Result<Vec<u8>, Malformed> {
        self.leaf_sounds_of(AmbientTextures::ALL)
    }

    /// As [`Self::leaf_sounds`], by some textures only.
    ///
    /// # Errors
    /// As there.
    pub fn leaf_sounds_of(&self, textures: AmbientTextures) -> Result<Vec<u8>, Malformed> {
        if !self.format().has_sounds() {
            return Ok(vec![0; self.n_visible_leafs()]);
        }
        let faces = self.face_sounds(textures);
        let marks = self.marks();
        let is_sound = |mark: &u32| faces.get(*mark as usize).copied().unwrap_or(Face::Missing);
        let marked: Vec<Face> = marks.iter().map(is_sound).collect();
        let runs = Runs::new(&marked);
        let leafs = self.visible_leafs().iter().zip(1..);
        leafs
            .map(|(leaf, index)| {
                let (first, count, n_listed) = (leaf.first_face, leaf.n_faces, marks.len());
                let end = u64::from(first) + u64::from(count);
                if count == 0 {
                    return Ok(0);
                }
                if end > n_listed as u64 {
                    let what = format_args!("faces {first} to {first} + {count} of the list");
                    return Err(malformed!("leaf {index}: {what} are not among its {n_listed}"));
                }
                let range = first as usize..end as usize;
                if runs.has_errors(range.clone()) {
                    return Err(self.first_error(index, &marks[range.clone()], &marked[range]));
                }
                Ok(runs.sounds(range))
            })
            .collect()
    }

    /// The first face of a leaf that cannot be used, where there is one.
    fn first_error(&self, leaf: usize, marks: &[u32], marked: &[Face]) -> Malformed {
        let bad = marked.iter().position(|face| !matches!(face, Face::Sounds(_)));
        let k = bad.expect("the caller counted faces with errors");
        let face = marks[k];
        match marked[k] {
            Face::Missing => malformed!("leaf {leaf}: there is no face {face} among {}", self.n_faces()),
            _ => malformed!("leaf {leaf}: face {face} has a texture that is not in the file"),
        }
    }

    fn n_faces(&self) -> usize {
        let faces = self.format().layout().faces;
        self.lump_bytes(faces.lump).len() / faces.len
    }

    /// The faces that leafs list, without the rest of a lump that is no whole number of records.
    pub(super) fn marks(&self) -> Vec<u32> {
        let marks = self.format().layout().marks;
        let bytes = self.lump_bytes(marks.lump).chunks_exact(marks.len);
        if marks.len == 2 {
            bytes.map(|mark| u32::from(u16_at(mark, 0))).collect()
        } else {
            bytes.map(|mark| u32_at(mark, 0)).collect()
        }
    }

    fn face_sounds(&self, textures: AmbientTextures) -> Vec<Face> {
        let textures = self.texture_sounds(textures);
        let texinfos = self.lump_bytes(TEXINFO).chunks_exact(TEXINFO_LEN);
        let texture = |info: &[u8]| usize::try_from(i32_at(info, TEXINFO_TEXTURE)).ok();
        let of_texinfo: Vec<Face> = texinfos
            .map(|info| match &textures {
                None => Face::Sounds(0),
                Some(sounds) => texture(info).and_then(|k| sounds.get(k).copied()).unwrap_or(Face::NoTexture),
            })
            .collect();
        let layout = self.format().layout();
        let texinfo = |face: &[u8]| layout.face_texinfo.map_or(0, |number| number.count_of(face) as usize);
        let faces = self.lump_bytes(layout.faces.lump).chunks_exact(layout.faces.len);
        faces.map(|face| of_texinfo.get(texinfo(face)).copied().unwrap_or(Face::NoTexture)).collect()
    }

    /// The sounds of all textures; `None` if the map has no lump of them.
    fn texture_sounds(&self, textures: AmbientTextures) -> Option<Vec<Face>> {
        let lump = self.lump_bytes(TEXTURES);
        let count = lump.first_chunk::<4>().map(|&count| i32::from_le_bytes(count))?;
        let places = lump[4..].chunks_exact(4).take(usize::try_from(count).unwrap_or(0));
        let sound = |place: &[u8]| match i32_at(place, 0) {
            // A texture that was not found when the map was made.
            -1 => Face::Sounds(0),
            start => {
                let loud = |name| AmbientTexture::of_name(name).filter(|&texture| textures.has(texture));
                texture_name(lump, start)
                    .map_or(Face::NoTexture, |name| Face::Sounds(loud(name).map_or(0, |texture| texture.sound().bit())))
            }
        };
        Some(places.map(sound).collect())
    }
}

/// The name of a texture that begins at a place of its lump, if it is inside.
pub(super) fn texture_name(lump: &[u8], start: i32) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    lump.get(start..start.checked_add(NAME_LEN)?)
}

/// For each sound, and for errors, how many there are before each place of a list: leafs may share their
/// places as they like, and each is still answered in O(1).
struct Runs {
    before: Vec<[u32; AmbientKind::ALL.len() + 1]>,
}

impl Runs {
    fn new(marked: &[Face]) -> Self {
        let mut before = Vec::with_capacity(marked.len() + 1);
        let mut sum = [0; AmbientKind::ALL.len() + 1];
        before.push(sum);
        for face in marked {
            match face {
                Face::Sounds(bits) => {
                    let counts = AmbientKind::ALL.iter().zip(&mut sum);
                    counts.for_each(|(kind, n)| *n += u32::from(bits & kind.bit() != 0));
                }
                _ => sum[AmbientKind::ALL.len()] += 1,
            }
            before.push(sum);
        }
        Self { before }
    }

    fn any(&self, k: usize, range: std::ops::Range<usize>) -> bool {
        self.before[range.end][k] > self.before[range.start][k]
    }

    fn has_errors(&self, range: std::ops::Range<usize>) -> bool {
        self.any(AmbientKind::ALL.len(), range)
    }

    fn sounds(&self, range: std::ops::Range<usize>) -> u8 {
        let heard = AmbientKind::ALL.iter().enumerate().filter(|(k, _)| self.any(*k, range.clone()));
        heard.fold(0, |bits, (_, kind)| bits | kind.bit())
    }
}
