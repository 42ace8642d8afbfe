//! What a user puts on a camera, and what they find there.

use crate::asset::PvsTable;
use crate::follow::Follow;
use crate::tie::{PvsMisfit, Tie};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use sightlines_eye_to_cell::{Method, StepBudget, View};
use sightlines_pvs::CellId;
use std::fmt;
use std::sync::Mutex;
use std::time::Duration;

/// How much is asked of the table in a frame: each method draws no more than the one before, and costs more.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum PvsMethod {
    /// What the table says the cell may see, in view or not. Knows nothing of doors.
    CellToCell,
    /// Of that, what is in cells whose boxes are in view. Knows nothing of doors.
    DisjointCell,
    /// Of that, what is reached through cells whose boxes are in view.
    ConnectedComponent,
    /// Of that, what is reached through portals in view.
    IncidentPortals,
    /// Of that, what a line from the eye reaches through portals in view.
    #[default]
    Exact,
}

impl From<PvsMethod> for Method {
    fn from(method: PvsMethod) -> Self {
        match method {
            PvsMethod::CellToCell => Self::CellToCell,
            PvsMethod::DisjointCell => Self::DisjointCell,
            PvsMethod::ConnectedComponent => Self::ConnectedComponent,
            PvsMethod::IncidentPortals => Self::IncidentPortals,
            PvsMethod::Exact => Self::Exact,
        }
    }
}

/// A camera for which what cannot be seen from where it is is not drawn.
///
/// Only this camera's list of visible meshes gets shorter: shadows, other cameras and `ViewVisibility` keep what they had. Meshes with
/// `NoCpuCulling` are in no such list, and are always drawn. A camera without a perspective draws everything.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component, Clone)]
#[require(PvsView, Walker)]
pub struct PvsCamera {
    /// The table.
    pub table: Handle<PvsTable>,
    /// The level, where several scenes fit the table: the entity with `WorldAssetRoot`, or one below it that holds the scene's nodes.
    /// `None`: the first scene that fits.
    pub level: Option<Entity>,
    /// How much is asked of the table.
    pub method: PvsMethod,
    /// Work that the exact method may do in a frame; beyond it, what is farther away is that of the incident portals. `None`: no bound.
    pub steps: Option<u64>,
    /// Whether the next cells are prepared by another thread, which is the default. Otherwise a frame that comes to a new cell
    /// prepares it and waits, some milliseconds in large levels. Targets without threads never have one.
    pub prepares_ahead: bool,
    /// Bytes that what is prepared may take.
    pub prepared_bytes: usize,
    /// Whether anything is culled. Otherwise everything else goes on.
    pub culls: bool,
}

impl PvsCamera {
    /// The exact method, with a bound on its work that a frame does not notice.
    pub fn new(table: Handle<PvsTable>) -> Self {
        Self {
            table,
            level: None,
            method: PvsMethod::Exact,
            steps: Some(StepBudget::FRAME.n_steps()),
            prepares_ahead: true,
            prepared_bytes: 64 << 20,
            culls: true,
        }
    }

    /// The same by another method.
    #[must_use]
    pub const fn with_method(mut self, method: PvsMethod) -> Self {
        self.method = method;
        self
    }

    /// The same for one of several scenes that fit.
    #[must_use]
    pub const fn in_level(mut self, level: Entity) -> Self {
        self.level = Some(level);
        self
    }

    /// The same without another thread: every frame has the method's answer, and may wait for it.
    #[must_use]
    pub const fn without_thread(mut self) -> Self {
        self.prepares_ahead = false;
        self
    }
}

/// On a camera with [`PvsCamera`]: keeps the set of what is drawn as it is, while the camera flies on. To look at the set from outside.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct PvsLock;

/// What a camera's last frame was based on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect)]
#[reflect(Default, Clone, PartialEq)]
#[non_exhaustive]
pub enum PvsState {
    /// The table has not been loaded yet: everything is drawn.
    #[default]
    Loading,
    /// The table could not be loaded: everything is drawn.
    NoTable,
    /// There is no scene that the table was made of: everything is drawn.
    NoLevel,
    /// The camera has no perspective, or the level no volume: everything is drawn.
    NoEye,
    /// The eye is outside every cell: everything is drawn.
    Outside,
    /// What the cell sees is still being prepared: some things are drawn in vain.
    Late,
    /// The answer of the method.
    Inside,
}

/// What a camera's last frame came to. Added with [`PvsCamera`], and written by the plugin.
#[derive(Component, Debug, Clone, Default, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct PvsView {
    /// What it was based on.
    pub state: PvsState,
    /// Entities left in the camera's lists.
    pub drawn: u32,
    /// Entities taken out of them: those in the picture that cannot be seen.
    pub culled: u32,
    /// Time of the query alone, without taking entities out.
    pub query: Duration,
    /// Time of all that the plugin did for this camera.
    pub all: Duration,
    /// Whether the exact method came to the end of its steps.
    pub fell_back: bool,
    /// The root of the scene that the table belongs to.
    pub level: Option<Entity>,
    #[reflect(ignore)]
    pub(crate) at: Vec<CellId>,
    #[reflect(ignore)]
    pub(crate) cells: Vec<CellId>,
}

impl PvsView {
    /// The cells of the eye: several on a border, none outside.
    pub fn at(&self) -> &[CellId] {
        &self.at
    }

    /// The cells that are seen, in no particular order; none in frames that draw everything.
    pub fn cells(&self) -> &[CellId] {
        &self.cells
    }
}

/// Something a user should hear of a camera's table. Sent once for each table of each camera, and logged as a warning.
#[derive(Message, Debug, Clone, PartialEq)]
pub struct PvsProblem {
    /// The camera.
    pub camera: Entity,
    /// The table.
    pub table: AssetId<PvsTable>,
    /// What is wrong.
    pub what: PvsProblemKind,
}

/// What is wrong with a camera's table.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum PvsProblemKind {
    /// It could not be loaded; Bevy logs why.
    NotLoaded,
    /// Of the scenes that are there, none is the one that the table was made of; this is why the largest one is not.
    NoLevel(PvsMisfit),
    /// The camera has no perspective.
    NoPerspective,
    /// A part of a packed table could not be read.
    Read(String),
    /// It was made for engines that draw the backs of single-sided faces (`build --backs drawn`), and the level has materials with one side, of
    /// which Bevy draws no backs: what is seen through them may be missing.
    BacksDrawn,
}

impl fmt::Display for PvsProblemKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotLoaded => f.write_str("it could not be loaded; everything is drawn"),
            Self::NoLevel(misfit) => write!(f, "it was not made of this level: {misfit}; everything is drawn"),
            Self::NoPerspective => f.write_str("the camera has no perspective; everything is drawn"),
            Self::BacksDrawn => f.write_str(
                "it was made for engines that draw the backs of single-sided faces, and the level has such faces: where the game does not set \
                 their `cull_mode` to None, what is seen through their backs may be missing; build it without --backs drawn",
            ),
            Self::Read(error) => write!(f, "{error}; more is drawn than has to be"),
        }
    }
}

/// Sent when what may be seen from where a camera is has changed, because it came to another cell: all that the table says, in view or not,
/// and whatever doors are shut. For what thinks, sounds or is sent over a network.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct PvsChanged {
    /// The camera.
    pub camera: Entity,
    /// The cells of the eye, ascending; none outside, where everything may be seen, whatever `left` has.
    pub at: Vec<CellId>,
    /// Cells that may be seen now and could not before, ascending.
    pub entered: Vec<CellId>,
    /// Cells that could be seen before and cannot now, ascending.
    pub left: Vec<CellId>,
}

/// What a camera keeps from frame to frame.
#[derive(Component, Default)]
pub(crate) struct Walker(pub(crate) Mutex<Walk>);

/// The content of a [`Walker`].
#[derive(Default)]
pub(crate) struct Walk {
    /// The table that all of this is of, and which of its versions.
    pub(crate) of: Option<(AssetId<PvsTable>, u64)>,
    pub(crate) follower: Option<Box<dyn Follow>>,
    /// Options that the follower was made with.
    pub(crate) made_with: Option<(Option<u64>, bool, usize)>,
    pub(crate) doors: Option<u64>,
    /// The scene, and how the table is tied to it.
    pub(crate) tie: Option<(Entity, Tie)>,
    /// Scenes that do not fit, with their numbers of meshes.
    pub(crate) misfits: HashMap<Entity, (usize, PvsMisfit)>,
    /// Frames in which no scene fitted.
    pub(crate) frames_without: u32,
    pub(crate) has_warned: bool,
    /// Whether the table's view of backs was compared with the level's.
    pub(crate) has_compared_backs: bool,
    /// The last view, for locked sets.
    pub(crate) view: Option<View>,
    /// The cells of the eye, and what may be seen from there.
    pub(crate) at: Vec<CellId>,
    pub(crate) may_see: Vec<CellId>,
}
