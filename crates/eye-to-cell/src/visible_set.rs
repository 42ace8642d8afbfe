//! What was seen.

use crate::epoch_set::EpochSet;
use crate::view::View;
use sightlines_pvs::{CellId, MirrorId, ObjectId};

/// The cells and objects that a viewer sees, and the mirrors. Kept from frame to frame, it allocates nothing once it is warm.
#[derive(Debug, Clone, Default)]
pub struct VisibleSet {
    pub(crate) cells: EpochSet<CellId>,
    pub(crate) objects: EpochSet<ObjectId>,
    pub(crate) reflections: Vec<Reflection>,
}

/// A mirror that is seen, and what is looked at in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflection {
    /// The mirror.
    pub mirror: MirrorId,
    /// The cell in which lines go on behind the mirror: to be asked with the subgraph of this cell.
    pub cell: CellId,
    /// The eye behind the mirror, and the directions from there that lead through it.
    pub view: View,
}

impl VisibleSet {
    /// Nothing seen yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets all; `n_cells` and `n_objects` are those of the table.
    pub fn clear(&mut self, n_cells: usize, n_objects: usize) {
        self.cells.clear(n_cells);
        self.objects.clear(n_objects);
        self.reflections.clear();
    }

    /// The cells, in no particular order until [`VisibleSet::sort`].
    pub fn cells(&self) -> &[CellId] {
        self.cells.list()
    }

    /// The objects, in no particular order until [`VisibleSet::sort`].
    pub fn objects(&self) -> &[ObjectId] {
        self.objects.list()
    }

    /// Whether a cell is among them. O(1).
    pub fn has_cell(&self, cell: CellId) -> bool {
        self.cells.has(cell)
    }

    /// Whether an object is among them. O(1).
    pub fn has_object(&self, object: ObjectId) -> bool {
        self.objects.has(object)
    }

    /// The mirrors that were seen; one comes more than once if it is seen through several ways.
    pub fn reflections(&self) -> &[Reflection] {
        &self.reflections
    }

    /// Puts cells and objects in ascending order.
    pub fn sort(&mut self) {
        self.cells.sort();
        self.objects.sort();
    }

    /// Adds a cell; whether it is new.
    ///
    /// # Panics
    /// If [`VisibleSet::clear`] made no room for it.
    pub fn add_cell(&mut self, cell: CellId) -> bool {
        self.cells.add(cell)
    }

    /// Adds cells.
    ///
    /// # Panics
    /// As [`VisibleSet::add_cell`].
    pub fn add_cells(&mut self, cells: impl IntoIterator<Item = CellId>) {
        for cell in cells {
            self.add_cell(cell);
        }
    }

    /// Adds objects.
    ///
    /// # Panics
    /// As [`VisibleSet::add_object`].
    pub fn add_objects(&mut self, objects: impl IntoIterator<Item = ObjectId>) {
        for object in objects {
            self.add_object(object);
        }
    }

    /// Adds an object; whether it is new.
    ///
    /// # Panics
    /// If [`VisibleSet::clear`] made no room for it.
    pub fn add_object(&mut self, object: ObjectId) -> bool {
        self.objects.add(object)
    }
}
