//! Parameters of movers.

use sightlines_geometry::Aabb;

/// Parameters of [`Movers`](super::Movers).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoverOptions {
    /// Shortest duration of a volume, in the units of [`Movers::frame`](super::Movers::frame); longer ones last twice, four times, … as long.
    /// Making and registering a volume costs as much as querying a mover in some fifty frames, so shorter durations do
    /// not pay. If this is not positive and finite, only movers whose region is out of sight sleep.
    pub least: f64,
    /// Longest duration; regions that are out of sight last forever.
    pub most: f64,
    /// Maximum number of cells in which a volume is registered; a volume that touches more is not made.
    pub cells: usize,
    /// Number of frames out of sight before a volume is made for a mover, and between attempts, so that a view that
    /// turns back finds it awake.
    pub patience: u32,
    /// Maximum number of movers for which volumes are attempted in a frame; the others stay awake until their turn.
    pub tries: usize,
    /// Within this box, space outside every cell is solid and nothing there is visible; beyond it everything may be
    /// visible from everywhere. `None`: the box around all cells, or no box if they [may leave gaps](super::CellLocator::leaves_gaps), as given
    /// boxes and places do. The box is correct if the cells fill it except for solids, or if walls enclose them. It is wrong for cells
    /// whose border is open to space outside every cell, such as the hull of a plan without outer walls.
    pub solid_within: Option<Aabb<3>>,
}

impl Default for MoverOptions {
    /// For times in seconds.
    fn default() -> Self {
        Self { least: 0.5, most: 120.0, cells: 64, patience: 8, tries: 2000, solid_within: None }
    }
}
