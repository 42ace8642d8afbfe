//! Memory that the methods work in.

use crate::marks::{Decided, Marks};
use crate::method::{Clipper, Frame, Missing, Pieces};
use crate::side::Side;

/// Room to work in, kept from frame to frame: once warm, a query allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    /// The sides of the view.
    pub(crate) view: Vec<Side>,
    /// Cells of the outlook: whether the view meets them.
    pub(crate) cell_in_view: Decided,
    /// Objects of the outlook: whether the view meets them.
    pub(crate) object_in_view: Decided,
    /// Ways of the outlook: whether the view meets them.
    pub(crate) way_in_view: Decided,
    /// Cells of the outlook that were kept with all that is in them.
    pub(crate) kept: Marks,
    /// Cells of the outlook that were reached.
    pub(crate) reached: Marks,
    /// Nodes of stab trees that were reached.
    pub(crate) reached_nodes: Marks,
    /// What is to be followed.
    pub(crate) pending: Vec<u32>,
    /// Nodes of stab trees that are to be followed.
    pub(crate) nodes: Vec<u32>,
    /// For each cell of the outlook, whether it is on the way from the eye.
    pub(crate) on_way: Vec<bool>,
    /// The cones of sight on the way from the eye, one behind the other.
    pub(crate) sides: Vec<Side>,
    /// Cells that the exact method may find.
    pub(crate) wanted: Marks,
    /// Boxes of what it has not found yet.
    pub(crate) missing: Vec<Missing>,
    pub(crate) clipper: Clipper,
    /// What the exact method puts together.
    pub(crate) pieces: Pieces,
    /// The cone that is being made.
    pub(crate) cone: Vec<Side>,
    pub(crate) frames: Vec<Frame>,
    /// Steps of the exact method since this was made.
    pub(crate) n_steps: u64,
}

impl Scratch {
    /// Not warm yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Portals that the exact method has looked at, of all queries together.
    pub fn n_steps(&self) -> u64 {
        self.n_steps
    }
}
