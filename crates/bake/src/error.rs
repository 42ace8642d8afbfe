//! Why nothing was baked.

use crate::eye_level::EyeLevelError;
use crate::methods::MethodError;
use crate::places::PlacesError;
use crate::quake::PrtBakeError;
use crate::region::GridError;
use sightlines_cells::PlanError;
use sightlines_frame::MoveError;
use sightlines_kdtree::KdError;
use sightlines_multifocal::{BackendError, VolumeError};
use sightlines_progress::{Cancelled, Halt};
use sightlines_pvs::TableError;
use sightlines_triangulation::TriangulationError;

/// Why an input could not be baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// An option that means nothing for what is baked.
    #[error(transparent)]
    Meaningless(#[from] Meaningless),
    /// The triangulation has nothing to cut.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// The k-d tree refused the plan, the scene or its options.
    #[error(transparent)]
    KdTree(#[from] KdError),
    /// The lines of a map do not make a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// More parts of objects than there is room for.
    #[error(
        "{n_parts} parts of objects and {n_cells} cells are too many pairs: cut objects into larger parts, or take fewer cells"
    )]
    TooManyParts {
        /// Parts.
        n_parts: usize,
        /// Cells.
        n_cells: usize,
    },
    /// The scene cannot be taken to be as imprecise as was stated.
    #[error(transparent)]
    Move(#[from] MoveError),
    /// A grid of view cells with none or too many.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Places cannot be cut.
    #[error(transparent)]
    Places(#[from] PlacesError),
    /// Cells at the height of eyes cannot be cut.
    #[error(transparent)]
    EyeLevel(#[from] EyeLevelError),
    /// A view cell is not a volume.
    #[error("view cell {cell}: {error}")]
    Cell {
        /// Its index.
        cell: usize,
        /// What is wrong with it.
        error: VolumeError,
    },
    /// The from-region method cannot be prepared.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The from-region method failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// The portals of a Quake map, or the map, cannot be baked.
    #[error(transparent)]
    Prt(#[from] PrtBakeError),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the bake: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(Halt),
    /// The parts of the table do not fit together: a defect of this crate.
    #[error("the table is inconsistent: {0}")]
    Table(#[from] TableError),
}

/// An option of a request that means nothing for what is baked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{option} is for {meant}, and this is {found}")]
pub struct Meaningless {
    /// Its name; the program writes `-` for `_`.
    pub option: &'static str,
    /// What it is for.
    pub meant: &'static str,
    /// What was found.
    pub found: &'static str,
}

impl From<Halt> for BakeError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Cancelled(cancelled) => cancelled.into(),
            halt => Self::Halted(halt),
        }
    }
}
