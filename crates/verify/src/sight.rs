//! A segment along which something is seen.

use sightlines_geometry::Point3;
use sightlines_pvs::CellId;

/// What is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// A cell.
    Cell(CellId),
    /// An object.
    Object(u32),
}

/// A segment from inside of a cell to something that is seen, in scene units; z is 0 in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SightSegment {
    /// The cell.
    pub from: CellId,
    /// What is seen.
    pub target: Target,
    /// From a place in the cell to one in or on the target, or just behind it.
    pub segment: [Point3; 2],
}
