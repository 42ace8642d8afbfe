//! What programs ask of tables of either kind besides visibility.

use sightlines_eye_to_cell::{CellSource, TableCells};
use sightlines_pvs::{Axis, CellId, DoorRecord, ObjectId, ObjectSource, Table, TriangleRange};
use std::borrow::Borrow;
use std::convert::Infallible;

/// What a table stores of itself, of its cells and of its objects, whether it is in memory or read on demand. Ids are below the numbers of
/// [`CellSource`].
pub trait TableFacts: CellSource {
    /// The axis that points up, if it is known.
    fn up(&self) -> Option<Axis>;

    /// Whether cells can be found at points.
    fn has_places(&self) -> bool;

    /// Number of portals.
    fn n_portals(&self) -> usize;

    /// The doors.
    fn doors(&self) -> &[DoorRecord];

    /// The name of an object.
    ///
    /// # Errors
    /// If the table cannot be read, as for all that follow.
    fn object_name(&self, object: ObjectId) -> Result<String, Self::Error>;

    /// Where an object is in the file that the table was made of; `None` if that is not known.
    ///
    /// # Errors
    /// As [`TableFacts::object_name`].
    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, Self::Error>;

    /// What a cell may see: ranges of the triangles of objects that were cut into parts, and no range for all of an object that was not.
    ///
    /// # Errors
    /// As [`TableFacts::object_name`].
    fn visible_ranges(&self, cell: CellId) -> Result<Vec<TriangleRange>, Self::Error>;

    /// The name of a cell; `None` if the cells of the table have no names.
    ///
    /// # Errors
    /// As [`TableFacts::object_name`].
    fn cell_name(&self, cell: CellId) -> Result<Option<String>, Self::Error>;

    /// The polygons of an object; 1 if the table does not know.
    ///
    /// # Errors
    /// As [`TableFacts::object_name`].
    fn polygons_of(&self, object: ObjectId) -> Result<u32, Self::Error>;

    /// Bytes that stay in memory, and bytes of the blocks that are kept now; `None` for a table that is wholly in memory.
    fn bytes_in_memory(&self) -> Option<(usize, usize)>;
}

impl<T: Borrow<Table>> TableFacts for TableCells<T> {
    fn up(&self) -> Option<Axis> {
        self.table().up()
    }

    fn has_places(&self) -> bool {
        self.table().has_places()
    }

    fn n_portals(&self) -> usize {
        self.table().portals().len()
    }

    fn doors(&self) -> &[DoorRecord] {
        self.table().doors()
    }

    fn object_name(&self, object: ObjectId) -> Result<String, Infallible> {
        Ok(self.table().objects()[object.idx()].name.clone())
    }

    fn source_of(&self, object: ObjectId) -> Result<Option<ObjectSource>, Infallible> {
        Ok(self.table().source_of(object))
    }

    fn visible_ranges(&self, cell: CellId) -> Result<Vec<TriangleRange>, Infallible> {
        Ok(self.table().visible_ranges(cell))
    }

    fn cell_name(&self, cell: CellId) -> Result<Option<String>, Infallible> {
        Ok(self.table().cell_name(cell).map(str::to_owned))
    }

    fn polygons_of(&self, object: ObjectId) -> Result<u32, Infallible> {
        Ok(self.table().polygons_of(object))
    }

    fn bytes_in_memory(&self) -> Option<(usize, usize)> {
        None
    }
}
