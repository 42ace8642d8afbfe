//! Tables as SVG: plans, floor plans of scenes in space, isometric views.

mod drawing;
mod figure;
mod isometric;
mod legend;
mod order;
mod picture;
mod plan;
mod raster;
mod section;
mod slice;
mod space;
mod surfaces;
mod svg;
mod visible_set;

pub use drawing::Drawing;
pub use isometric::{IsometricOptions, isometric_drawing, isometric_svg};
pub use plan::{DrawOptions, plan_drawing, plan_svg};
pub use slice::{SliceOptions, slice_drawing, slice_svg};
pub use space::Up;
pub use surfaces::Surfaces;

use sightlines_geometry::Point2;
use sightlines_pvs::{CellId, ObjectId, Table};

/// Smallest longer side of a picture, in pixels.
pub const MIN_SIZE: u32 = 16;
/// Largest longer side of a picture, in pixels.
pub const MAX_SIZE: u32 = 8192;

/// What a picture shows besides the cells.
///
/// `P` is a point in scene units: a [`Point2`] of a plan, three coordinates in space.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum PictureSubject<P = Point2> {
    /// Nothing: cells and portals alone.
    #[default]
    Plan,
    /// The cells that this cell sees.
    Cell(CellId),
    /// What the cells that contain this point see. What a viewer at the point sees of that is for [`SeenFromEye`] to state.
    Eye(P),
}

/// What a viewer sees, which is part of what their cell sees: the answer of an eye-to-cell method, for a picture with [`PictureSubject::Eye`].
///
/// `P` is a direction in scene units: a [`Point2`] of a plan, three coordinates in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenFromEye<'a, P = Point2> {
    /// The cells, in any order.
    pub cells: &'a [CellId],
    /// The objects, in any order.
    pub objects: &'a [ObjectId],
    /// The direction of view and its angle in radians, to be marked; none for a viewer who looks all round.
    pub looks: Option<(P, f64)>,
}

/// Why a table cannot be drawn so.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The table is of a scene in space, and a plan was asked for.
    #[error("a table of dimension {0} is not a plan")]
    NotPlanar(u8),
    /// The table is of a plan, and a picture of a scene in space was asked for.
    #[error("a table of dimension {0} is not of a scene in space")]
    NotSpatial(u8),
    /// A cell that the table does not have.
    #[error("there is no cell {cell}: the table has {n_cells} cells")]
    NoSuchCell {
        /// The cell asked for.
        cell: u32,
        /// Number of cells of the table.
        n_cells: usize,
    },
    /// A portal that the table does not have.
    #[error("there is no portal {portal}: the table has {n_portals} portals")]
    NoSuchPortal {
        /// The portal asked for.
        portal: usize,
        /// Number of portals of the table.
        n_portals: usize,
    },
    /// A height at which there is nothing: outside of the scene, or all solid.
    #[error("there is no cell at height {height}: the cells reach from {low} to {high}")]
    NoCellAt {
        /// The height asked for, in scene units.
        height: f64,
        /// Where the lowest cell begins.
        low: f64,
        /// Where the highest cell ends.
        high: f64,
    },
    /// An object that the table does not have.
    #[error("there is no object {object}: the table has {n_objects} objects")]
    NoSuchObject {
        /// The object asked for.
        object: u32,
        /// Number of objects of the table.
        n_objects: usize,
    },
    /// A picture too small to show anything or too large for memory.
    #[error("a picture of {0} pixels is not from {MIN_SIZE} to {MAX_SIZE} pixels")]
    Size(u32),
    /// A point, a line or a height that is not finite.
    #[error("a point to be drawn has a coordinate that is not finite")]
    NotFinite,
}

/// Checks that a table has these cells.
fn check_cells(table: &Table, cells: impl IntoIterator<Item = CellId>) -> Result<(), DrawError> {
    let n_cells = table.n_cells();
    match cells.into_iter().find(|cell| cell.idx() >= n_cells) {
        Some(cell) => Err(DrawError::NoSuchCell { cell: cell.0, n_cells }),
        None => Ok(()),
    }
}

/// Checks that a table has what a viewer sees.
fn check_sight<P>(table: &Table, sight: Option<&SeenFromEye<'_, P>>) -> Result<(), DrawError> {
    let Some(sight) = sight else { return Ok(()) };
    check_cells(table, sight.cells.iter().copied())?;
    let n_objects = table.objects().len();
    match sight.objects.iter().find(|object| object.idx() >= n_objects) {
        Some(object) => Err(DrawError::NoSuchObject { object: object.0, n_objects }),
        None => Ok(()),
    }
}

/// Checks the longer side of a picture.
fn check_size(size: u32) -> Result<(), DrawError> {
    if (MIN_SIZE..=MAX_SIZE).contains(&size) { Ok(()) } else { Err(DrawError::Size(size)) }
}
