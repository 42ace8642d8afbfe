//! What a table is made of.

use crate::{BitMatrix, CellId, Locator};

/// A convex cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellRecord {
    /// Lower corner of a box around the cell, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
    /// What the cell belongs to, such as a Doom sector.
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

/// Something that is seen or not, and hides nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectRecord {
    /// What users call it.
    pub name: String,
    /// Lower corner of a box around the object, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
}

/// The parts of a [`crate::Table`], not yet checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TableParts {
    /// 2 for a plane, 3 for space.
    pub dimension: u8,
    /// The cells; their index is their id.
    pub cells: Vec<CellRecord>,
    /// The portals; may be empty, no question is answered from them.
    pub portals: Vec<PortalRecord>,
    /// Bit `j` of row `i`: cell `i` may see cell `j`. Square, symmetric, with ones on the diagonal.
    pub rows: BitMatrix,
    /// The objects; their index is their id.
    pub objects: Vec<ObjectRecord>,
    /// For each cell, the objects that touch it, ascending.
    pub cell_objects: Vec<Vec<u32>>,
    /// Bit `o` of row `i`: cell `i` may see object `o`. Cells by objects; each cell sees the objects that
    /// touch it. `None`: a cell sees the objects that touch any cell that it sees.
    pub objects_seen: Option<BitMatrix>,
    /// Finds the cells at a point; complete for the cells' boxes.
    pub locator: Locator,
    /// Free keys and values (source, method, options), with strictly ascending keys.
    pub info: Vec<(String, String)>,
}

impl TableParts {
    /// The boxes around the cells, as [`Locator::build`] takes them.
    pub fn cell_bounds(&self) -> Vec<([f64; 3], [f64; 3])> {
        self.cells.iter().map(|cell| (cell.min, cell.max)).collect()
    }
}
