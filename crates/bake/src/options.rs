//! How to bake any input: options with the names that the program has for them.

use crate::gap::Gap;
use crate::methods::{BufferOptions, OcclusionMethod};
use crate::region::CellsFrom;
use crate::scene::PortalMode;
use crate::subdivide::Subdivide;
use sightlines_kdtree::SceneOptions;
use sightlines_multifocal::Split;
use sightlines_progress::{Budget, Observer, Units};
use sightlines_pvs::{Frame, GeometryDigest};
use sightlines_stabtree::SearchOptions;
use std::fmt;
use std::str::FromStr;

/// What decides which cells and objects of a scene are visible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SceneMethod {
    /// Chosen by the properties of the scene: see [`auto`](crate::auto).
    Auto,
    /// Sightlines alone.
    #[default]
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

/// How to bake, whatever the input is. What means nothing for an input is ignored.
#[derive(Clone)]
pub struct BakeOptions<'a> {
    /// Plans: how to cut.
    pub subdivide: Subdivide,
    /// Plans cut by a k-d tree, and scenes: `tau`. Scenes: all the rest.
    pub cut: SceneOptions,
    /// Plans: chords shot through each exit before the search. Changes nothing but the time.
    pub chords: u32,
    /// Scenes: how precise their coordinates are, which decides whether walls that are nearly across an axis, of the file or of the
    /// building, are taken to be so.
    pub gap: Gap,
    /// Scenes: the frame that the scene is in already, with its cells and view region; the table states it. [`Framed`](crate::Framed)
    /// sets it.
    pub frame: Option<Frame>,
    /// Scenes in a frame: the digests of the scene as its file has it; the table states them in place of those of the scene that was moved.
    pub digest: Option<GeometryDigest>,
    /// Scenes: which portals sightlines go through.
    pub portals: PortalMode,
    /// Scenes: what decides.
    pub method: SceneMethod,
    /// Scenes: the cells.
    pub cells: CellsFrom,
    /// Scenes by multifocal buffers and sheets: how they are made.
    pub buffers: BufferOptions,
    /// Scenes by a from-region method: when cells are cut into smaller volumes.
    pub split: Split,
    /// Portal files and Quake maps: only the first, coarse bound; quick, and shows much that is hidden.
    pub fast: bool,
    /// Number of threads; 0 for one for each core. Changes nothing but the time.
    pub threads: usize,
    /// Receives reports, and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// Scenes: what may be spent, such as time. What is not decided then counts as visible, and the table depends on when that was; see
    /// [`LimitReport`](crate::LimitReport). Without a budget the table is always the same.
    pub budget: Option<&'a dyn Budget>,
    /// Where results of units of work are kept, to go on after a stop or to share a bake among processes. Changes nothing but who computes what.
    pub units: Units<'a>,
}

impl Default for BakeOptions<'_> {
    fn default() -> Self {
        Self {
            subdivide: Subdivide::Auto,
            cut: SceneOptions::default(),
            chords: SearchOptions::default().chords,
            gap: Gap::default(),
            frame: None,
            digest: None,
            portals: PortalMode::default(),
            method: SceneMethod::default(),
            cells: CellsFrom::default(),
            buffers: BufferOptions::default(),
            split: Split::default(),
            fast: false,
            threads: 0,
            progress: None,
            budget: None,
            units: Units::default(),
        }
    }
}

impl fmt::Debug for BakeOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BakeOptions")
            .field("subdivide", &self.subdivide)
            .field("cut", &self.cut)
            .field("gap", &self.gap)
            .field("frame", &self.frame)
            .field("digest", &self.digest)
            .field("portals", &self.portals)
            .field("method", &self.method)
            .field("cells", &self.cells)
            .field("buffers", &self.buffers)
            .field("split", &self.split)
            .field("fast", &self.fast)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

impl BakeOptions<'_> {
    /// Whether the cells of a scene are given boxes, and not those of a k-d tree.
    pub fn has_given_cells(&self) -> bool {
        self.cells != CellsFrom::KdTree
    }

    /// Whether a scene takes from-region queries: for any method but sightlines alone, and for given cells.
    pub fn takes_regions(&self) -> bool {
        self.method.region_method().is_some() || self.has_given_cells()
    }
}
