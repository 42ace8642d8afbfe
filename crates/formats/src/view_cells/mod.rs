//! View cells: boxes in space where a viewer can be, each with a name, given instead of cut.
//!
//! ```json
//! {"axes":[[0.8,0,0.6],[0,1,0],[-0.6,0,0.8]],
//!  "cells":[{"id":"kitchen","min":[0.5,0.1,10.4],"max":[6.1,2.5,12.6]}]}
//! ```
//!
//! Corners are x, y and z in the units and axes of the scene that the cells are for. With `axes`, which may be left out, the
//! boxes stand along these instead: three unit vectors of the scene at right angles, to within a thousandth. A corner is then
//! x times the first, y times the second, and z times the third. Every cell needs an id of its
//! own, at least one character long. Boxes may touch, overlap, leave gaps and be flat. Members that are not shown
//! here mean nothing, in the whole as in a cell. There is at least one cell.

mod read;

pub use read::{parse_view_cells, read_view_cells};

use sightlines_geometry::Aabb;

/// View cells as a file has them, checked: at least one, ids not empty and all different, corners that
/// [`check_coordinate`](sightlines_geometry::check_coordinate) accepts, no lower corner above the upper one.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewCells {
    /// The cells, in the order of the file.
    pub cells: Vec<ViewCell>,
    /// The axes of the boxes, as unit vectors of the scene; `None`: those of the scene.
    pub axes: Option<[[f64; 3]; 3]>,
}

/// A box where a viewer can be.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewCell {
    /// What users call it.
    pub id: String,
    /// Where it is, in scene units, along the axes of the cells.
    pub bounds: Aabb<3>,
}
