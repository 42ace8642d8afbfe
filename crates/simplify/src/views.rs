//! The places from which a scene is viewed.

use sightlines_geometry::Aabb;
use sightlines_multifocal::{Volume, VolumeError};
use sightlines_pvs::{CellId, Table};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A box of eyes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewBox {
    /// Where the eye can be, a closed box.
    pub volume: Volume,
    /// The table's cell that it is in, if it comes from one.
    pub cell: Option<CellId>,
}

/// All places of the eye: closed boxes, which may overlap.
///
/// Bounds are computed for each box and hold in it, so many small boxes give better bounds than one large one.
#[derive(Debug, Clone, PartialEq)]
pub struct Views(Vec<ViewBox>);

/// Why views are invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewsError {
    /// The list is empty.
    #[error("there is no place for the eye: no view volume is given")]
    None,
    /// The table is of a plan.
    #[error("the table's cells are flat; a scene in space is looked at from boxes")]
    Flat,
    /// The table has no such cell.
    #[error("the table has no cell {cell}; it has {n_cells}, numbered from 0")]
    NoCell {
        /// The requested cell.
        cell: u32,
        /// Number of cells.
        n_cells: usize,
    },
    /// The cells are along axes of their own.
    #[error("the table has a frame; take it and the scene along its axes first")]
    Frame,
    /// The table has no box for a cell.
    #[error("cell {cell} of the table is no box, or its shape is not known")]
    NoBox {
        /// The cell.
        cell: u32,
    },
    /// A box that is not a valid volume.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

/// Whether the cells of a table are equal to their boxes.
fn has_boxes(table: &Table) -> bool {
    table.planes().is_none() && table.kind().has_box_cells()
}

impl Views {
    /// The largest number of boxes.
    pub const MOST: usize = 1 << 16;

    /// Eyes in boxes.
    ///
    /// # Errors
    /// [`ViewsError::None`] for an empty list.
    pub fn new(volumes: impl IntoIterator<Item = Volume>) -> Result<Self, ViewsError> {
        let views: Vec<ViewBox> = volumes.into_iter().map(|volume| ViewBox { volume, cell: None }).collect();
        if views.is_empty() { Err(ViewsError::None) } else { Ok(Self(views)) }
    }

    /// Eyes in cells of a table whose cells are boxes.
    ///
    /// # Errors
    /// [`ViewsError`]
    pub fn of_cells(table: &Table, cells: &[CellId]) -> Result<Self, ViewsError> {
        if table.dimension() != 3 {
            return Err(ViewsError::Flat);
        }
        if table.frame().is_some() {
            return Err(ViewsError::Frame);
        }
        let view = |&cell: &CellId| {
            let n_cells = table.n_cells();
            let record = table.cells().get(cell.idx()).ok_or(ViewsError::NoCell { cell: cell.0, n_cells })?;
            let bounds = Aabb { min: record.min, max: record.max };
            if bounds.is_empty() || !has_boxes(table) {
                return Err(ViewsError::NoBox { cell: cell.0 });
            }
            Ok(ViewBox { volume: Volume::new(bounds)?, cell: Some(cell) })
        };
        let views: Vec<ViewBox> = cells.iter().map(view).collect::<Result<_, _>>()?;
        if views.is_empty() { Err(ViewsError::None) } else { Ok(Self(views)) }
    }

    /// The same places in at least `n` boxes, as far as doubles permit: the box with the longest side is halved until
    /// there are enough.
    #[must_use]
    pub fn cut(mut self, n: usize) -> Self {
        // Non-negative lengths have the order of their bits.
        let longest = |v: &ViewBox| {
            let b = v.volume.bounds();
            (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max).to_bits()
        };
        let mut heap: BinaryHeap<(u64, Reverse<usize>)> =
            self.0.iter().enumerate().map(|(at, v)| (longest(v), Reverse(at))).collect();
        while self.0.len() < n.min(Self::MOST) {
            // The first of equals.
            let Some((_, Reverse(at))) = heap.pop() else { break };
            let Some([low, high]) = self.0[at].volume.halves() else { break };
            self.0[at].volume = low;
            self.0.push(ViewBox { volume: high, ..self.0[at] });
            heap.extend([at, self.0.len() - 1].map(|at| (longest(&self.0[at]), Reverse(at))));
        }
        self
    }

    /// The boxes.
    pub fn parts(&self) -> &[ViewBox] {
        &self.0
    }
}
