//! The part of a table that is available in every frame.

use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::{CellId, ObjectId, Place, PlaceBuffer, Table};
use std::borrow::Borrow;
use std::sync::Arc;

/// The part of a table that a frame can query without waiting: no disk, and no lock that another thread may hold for
/// long.
pub trait CoarseVisibility {
    /// Number of cells.
    fn n_cells(&self) -> usize;

    /// Number of objects.
    fn n_objects(&self) -> usize;

    /// The cells at a point (scene units; in a plane z does not count), ascending, in `buffer`.
    fn cells_at<'b>(&'b self, eye: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<&'b [CellId]>;

    /// Visits a superset of the cells that `cell` may see.
    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId));

    /// Visits a superset of the objects that `cell` may see; `false` if it is unknown.
    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(ObjectId)) -> bool;
}

impl<T: Borrow<Table>> CoarseVisibility for TableCells<T> {
    fn n_cells(&self) -> usize {
        self.table().n_cells()
    }

    fn n_objects(&self) -> usize {
        self.table().objects().len()
    }

    fn cells_at<'b>(&'b self, eye: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<&'b [CellId]> {
        self.table().cells_at(eye, buffer)
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
    fn n_cells(&self) -> usize {
        (**self).n_cells()
    }

    fn n_objects(&self) -> usize {
        (**self).n_objects()
    }

    fn cells_at<'b>(&'b self, eye: [f64; 3], buffer: &'b mut PlaceBuffer) -> Place<&'b [CellId]> {
        (**self).cells_at(eye, buffer)
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        (**self).coarse(cell, show);
    }

    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(ObjectId)) -> bool {
        (**self).coarse_objects(cell, show)
    }
}
