//! The part of a table that is available in every frame.

use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::{CellId, ObjectId, Place, PlaceBuffer, Table};
use std::borrow::Borrow;
use std::convert::Infallible;
use std::sync::Arc;

/// The part of a table that a frame can query without waiting: no disk, and no lock that another thread may hold for
/// long. The exception is a packed table of the large class, which reads a block when a point is located where none was
/// lately.
pub trait CoarseVisibility {
    /// Why a point cannot be located; [`std::convert::Infallible`] where all that takes is in memory.
    type PlaceError;

    /// Number of cells.
    fn n_cells(&self) -> usize;

    /// Number of objects.
    fn n_objects(&self) -> usize;

    /// The cells at a point (scene units; in a plane z does not count), ascending, in `buffer`.
    ///
    /// # Errors
    /// If the part of the table that decides cannot be read.
    fn cells_at<'b>(
        &'b self,
        eye: [f64; 3],
        buffer: &'b mut PlaceBuffer,
    ) -> Result<Place<&'b [CellId]>, Self::PlaceError>;

    /// Visits a superset of the cells that `cell` may see.
    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId));

    /// Visits a superset of the objects that `cell` may see; `false` if it is unknown.
    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(ObjectId)) -> bool;
}

impl<T: Borrow<Table>> CoarseVisibility for TableCells<T> {
    type PlaceError = Infallible;

    fn n_cells(&self) -> usize {
        self.table().n_cells()
    }

    fn n_objects(&self) -> usize {
        self.table().objects().len()
    }

    fn cells_at<'b>(&'b self, eye: [f64; 3], buffer: &'b mut PlaceBuffer) -> Result<Place<&'b [CellId]>, Infallible> {
        Ok(self.table().cells_at(eye, buffer))
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        self.table().visible(cell).for_each(show);
    }

    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(ObjectId)) -> bool {
        self.table().visible_objects(cell).into_iter().for_each(show);
        true
    }
}

impl<R: CoarseVisibility + ?Sized> CoarseVisibility for Arc<R> {
    type PlaceError = R::PlaceError;

    fn n_cells(&self) -> usize {
        (**self).n_cells()
    }

    fn n_objects(&self) -> usize {
        (**self).n_objects()
    }

    fn cells_at<'b>(
        &'b self,
        eye: [f64; 3],
        buffer: &'b mut PlaceBuffer,
    ) -> Result<Place<&'b [CellId]>, R::PlaceError> {
        (**self).cells_at(eye, buffer)
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        (**self).coarse(cell, show);
    }

    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(ObjectId)) -> bool {
        (**self).coarse_objects(cell, show)
    }
}
