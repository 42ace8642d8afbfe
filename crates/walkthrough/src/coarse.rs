//! The part of a table that is available in every frame.

use sightlines_eye_to_cell::{CellSource, TableCells};
use sightlines_geometry::Aabb;
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

    /// A box around a cell, along the axes of the scene; `None` where none is at hand, and the cell counts as in view.
    fn cell_bounds(&self, _: CellId) -> Option<Aabb<3>> {
        None
    }

    /// The same of all places of an object.
    fn object_bounds(&self, _: ObjectId) -> Option<Aabb<3>> {
        None
    }
}

/// A box of a table along the axes of its scene, around where its corners may have been before they were taken along the table's frame.
fn in_scene(table: &Table, Ok(b): Result<Aabb<3>, Infallible>) -> Aabb<3> {
    let Some(frame) = table.frame() else { return b };
    let gap = frame.gap();
    let (min, max) = frame.around_in_scene(b.min.map(|x| x - gap), b.max.map(|x| x + gap));
    Aabb { min, max }
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

    fn cell_bounds(&self, cell: CellId) -> Option<Aabb<3>> {
        Some(in_scene(self.table(), self.cell_box(cell)))
    }

    fn object_bounds(&self, object: ObjectId) -> Option<Aabb<3>> {
        Some(in_scene(self.table(), self.object_box(object)))
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

    fn cell_bounds(&self, cell: CellId) -> Option<Aabb<3>> {
        (**self).cell_bounds(cell)
    }

    fn object_bounds(&self, object: ObjectId) -> Option<Aabb<3>> {
        (**self).object_bounds(object)
    }
}
