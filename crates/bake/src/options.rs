//! Methods by name, and what was decided of a bake.

use crate::methods::{BufferOptions, OcclusionMethod};
use crate::region::CellsFrom;
use crate::subdivide::Subdivide;
use crate::surroundings::Surrounding;
use sightlines_kdtree::SceneOptions;
use sightlines_multifocal::Split;
use sightlines_pvs::{Frame, GeometryDigest};
use std::fmt;
use std::str::FromStr;

/// What decides which cells and objects of a scene are visible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SceneMethod {
    /// Chosen by the properties of the scene: see [`auto`](crate::auto).
    Auto,
    /// Sightlines alone.
    Sightlines,
    /// Sightlines and [`OcclusionMethod::Multifocal`]: hidden is what either proves hidden.
    Both,
    /// A from-region method alone.
    FromRegion(OcclusionMethod),
}

impl SceneMethod {
    /// All methods.
    pub fn all() -> Vec<Self> {
        let alone = OcclusionMethod::ALL.into_iter().map(Self::FromRegion);
        [Self::Auto, Self::Sightlines, Self::Both].into_iter().chain(alone).collect()
    }

    /// Lower-case name for options: what [`Display`](fmt::Display) writes and [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Sightlines => "sightlines",
            Self::Both => "both",
            Self::FromRegion(method) => method.name(),
        }
    }

    /// What it does, as one line of help.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Auto => "Chosen by the properties of the input",
            Self::Sightlines => "Lines through the portals between cells, past axis-aligned walls",
            Self::Both => "Sightlines and multifocal: hides what either hides",
            Self::FromRegion(method) => method.about(),
        }
    }

    /// The from-region method, if there is one.
    pub(crate) const fn region_method(self) -> Option<OcclusionMethod> {
        match self {
            Self::Auto | Self::Sightlines => None,
            Self::Both => Some(OcclusionMethod::Multifocal),
            Self::FromRegion(method) => Some(method),
        }
    }

    /// Whether it draws buffers.
    pub(crate) const fn has_buffers(self) -> bool {
        matches!(self, Self::Both | Self::FromRegion(OcclusionMethod::Multifocal))
    }

    /// Whether sightlines decide too.
    pub(crate) const fn by_sightlines(self) -> bool {
        !matches!(self, Self::FromRegion(_))
    }
}

impl fmt::Display for SceneMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Not the name of a method for scenes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no method for scenes")]
pub struct ParseSceneMethodError(pub String);

impl FromStr for SceneMethod {
    type Err = ParseSceneMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::all().into_iter().find(|method| method.name() == text);
        found.ok_or_else(|| ParseSceneMethodError(text.to_owned()))
    }
}

/// What was decided of a bake: nothing is left to choose. Made by [`BakeRequest::prepare`](crate::BakeRequest::prepare).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Recipe {
    /// Plans: how to cut.
    pub subdivide: Subdivide,
    /// Plans cut by a k-d tree, and scenes: `tau`. Scenes: all the rest.
    pub cut: SceneOptions,
    /// Scenes: the frame that the scene is in, with its cells and view region; the table states it.
    pub frame: Option<Frame>,
    /// Scenes in a frame, or with surroundings: the digests of the scene as its file has it; the table states them in place of those of the scene that is baked.
    pub digest: Option<GeometryDigest>,
    /// Scenes: what decides; never [`SceneMethod::Auto`].
    pub method: SceneMethod,
    /// Scenes: the cells.
    pub cells: CellsFrom,
    /// Scenes by multifocal buffers and sheets: how they are made.
    pub buffers: BufferOptions,
    /// Scenes by a from-region method: when cells are cut into smaller volumes.
    pub split: Split,
    /// Scenes: what is around the rest, which is baked without it; every cell sees it.
    pub surroundings: Vec<Surrounding>,
    /// Scenes: how many triangles an object has at most that is not cut into parts, and each part.
    pub parts: Option<u32>,
    /// Portal files and Quake maps: only the first, coarse bound.
    pub fast: bool,
}

impl Recipe {
    /// Whether the cells of a scene are boxes without portals, and not those of a k-d tree.
    pub fn has_given_cells(&self) -> bool {
        self.cells != CellsFrom::KdTree
    }

    /// Whether a scene takes from-region queries: for any method but sightlines alone, and for cells without portals.
    pub fn takes_regions(&self) -> bool {
        self.method.region_method().is_some() || self.has_given_cells()
    }

    /// All that decides the table but the input, in words: two recipes with the same key make the same table of the same input.
    pub fn key(&self) -> String {
        // A new option does not compile until it is decided whether it is part of the key. `warn` is an address.
        let Self { subdivide, cut, frame, digest, method, cells, buffers, split, surroundings, parts, fast } = self;
        let BufferOptions { measure, planes, texels, occluders, carry, sheets, line_space, backend, warn: _ } = buffers;
        let buffers = (measure, planes, texels, occluders, carry, sheets, line_space, backend);
        format!("{:?}", (subdivide, cut, frame, digest, (method, cells, buffers, split, surroundings, parts, fast)))
    }
}
