//! The part of a table that is available in every frame.

use sightlines_eye_to_cell::TableCells;
use sightlines_pvs::{CellId, Table};
use std::borrow::Borrow;
use std::sync::Arc;

/// The part of a table that a frame can query without waiting: no disk, and no lock that another thread may hold for
/// long.
pub trait Resident {
    /// Number of cells.
    fn n_cells(&self) -> usize;

    /// Number of objects.
    fn n_objects(&self) -> usize;

    /// Collects the cells at a point (z is 0 in the plane) into `out`, which is cleared first; ascending; none outside.
    /// `pending` is scratch space.
    fn locate(&self, eye: [f64; 3], pending: &mut Vec<u32>, out: &mut Vec<CellId>);

    /// Visits a superset of the cells that `cell` may see.
    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId));

    /// Visits a superset of the objects that `cell` may see; `false` if it is unknown.
    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(u32)) -> bool;
}

impl<T: Borrow<Table>> Resident for TableCells<T> {
    fn n_cells(&self) -> usize {
        self.table().n_cells()
    }

    fn n_objects(&self) -> usize {
        self.table().objects().len()
    }

    fn locate(&self, eye: [f64; 3], pending: &mut Vec<u32>, out: &mut Vec<CellId>) {
        let n = usize::from(self.table().dimension());
        self.table().locate_into(&eye[..n], pending, out);
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        self.table().visible(cell).for_each(show);
    }

    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(u32)) -> bool {
        self.table().visible_objects(cell).into_iter().for_each(show);
        true
    }
}

impl<R: Resident + ?Sized> Resident for Arc<R> {
    fn n_cells(&self) -> usize {
        (**self).n_cells()
    }

    fn n_objects(&self) -> usize {
        (**self).n_objects()
    }

    fn locate(&self, eye: [f64; 3], pending: &mut Vec<u32>, out: &mut Vec<CellId>) {
        (**self).locate(eye, pending, out);
    }

    fn coarse(&self, cell: CellId, show: &mut dyn FnMut(CellId)) {
        (**self).coarse(cell, show);
    }

    fn coarse_objects(&self, cell: CellId, show: &mut dyn FnMut(u32)) -> bool {
        (**self).coarse_objects(cell, show)
    }
}
