//! Cells, portals, objects and mirrors as a table stores them.

use crate::{CellId, MirrorId};

/// A convex cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellRecord {
    /// Lower corner of a box around the cell, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
    /// The group of the cell, such as a Doom sector.
    pub group: Option<u32>,
    /// In a plane: the cell's corners, convex, counter-clockwise, inside the box. Empty if the cell is
    /// the box itself, always so in space.
    pub polygon: Vec<[f64; 2]>,
}

/// An opening between two cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PortalRecord {
    /// The two cells, different from each other.
    pub cells: [CellId; 2],
    /// The side of each cell that the portal lies on; not checked.
    pub sides: [u32; 2],
    /// Its corners in scene units. In a plane (z is 0) two: the left end, then the right end, as seen
    /// going from the first cell to the second. In space at least three, counter-clockwise as seen so.
    pub points: Vec<[f64; 3]>,
}

/// Something that is visible or not, and hides nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectRecord {
    /// The name of the object for users.
    pub name: String,
    /// Lower corner of a box around the object, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
}

/// The part of a mirror that lies in a cell or on its border.
#[derive(Debug, Clone, PartialEq)]
pub struct MirrorRecord {
    /// The closed cell that the part lies in or on; it reflects what comes from there.
    pub cell: CellId,
    /// The mirror, of which there may be parts in several cells; not checked.
    pub mirror: MirrorId,
    /// Its corners in scene units. In a plane (z is 0) two: the left end, then the right end, as seen
    /// looking from the cell towards the mirror. In space at least three, counter-clockwise as seen so.
    pub points: Vec<[f64; 3]>,
}
