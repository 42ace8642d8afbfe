//! The parts of a table.

use crate::records::{CellRecord, DoorRecord, MirrorRecord, ObjectParts, ObjectRecord, ObjectSource, PortalRecord};
use crate::{Axis, BitMatrix, Frame, GeometryDigest, Locator, ObjectId, PlaneTree, StabTrees, TableKind};

/// The key under which a table states the boxes of its doors that were given as such: a line of six numbers for each, in the order of the doors.
pub(crate) const DOOR_BOXES: &str = "door-boxes";

/// The parts of a [`crate::Table`], not yet checked.
///
/// [`TableParts::empty`] has the values of optional parts.
#[derive(Debug, Clone, PartialEq)]
pub struct TableParts {
    /// 2 for a plane, 3 for space.
    pub dimension: u8,
    /// What was cut into cells, and how.
    pub kind: TableKind,
    /// The axis that points up, in its positive direction; `None`: not known.
    pub up: Option<Axis>,
    /// In space: the axes along which all coordinates of the table are; `None`: those of the scene.
    pub frame: Option<Frame>,
    /// Digests of what the table was made of, as the scene has it, before any frame; `None`: not known.
    pub digest: Option<GeometryDigest>,
    /// The cells; their index is their id.
    pub cells: Vec<CellRecord>,
    /// The portals; may be empty, as no query uses them.
    pub portals: Vec<PortalRecord>,
    /// Bit `j` of row `i`: cell `i` may see cell `j`. Square, symmetric, with ones on the diagonal.
    pub rows: BitMatrix,
    /// The objects; their index is their id.
    pub objects: Vec<ObjectRecord>,
    /// For each cell, the objects that touch it, ascending.
    pub cell_objects: Vec<Vec<ObjectId>>,
    /// Bit `o` of row `i`: cell `i` may see object `o`. Cells by objects; each cell sees the objects that
    /// touch it. `None`: a cell sees the objects that touch any cell that it sees.
    pub objects_seen: Option<BitMatrix>,
    /// Number of polygons of each object, in the order of `objects`. Empty: not known.
    pub object_polygons: Vec<u32>,
    /// The parts of objects; only beside [`TableParts::objects_seen`]. `None`: no object was cut.
    pub object_parts: Option<ObjectParts>,
    /// Where each object is in the file that the table was made of, in the order of `objects`; `None`: not in one place, or not known.
    /// Empty: not known of any.
    pub object_sources: Vec<Option<ObjectSource>>,
    /// The doors; may be empty. Their index is their id.
    pub doors: Vec<DoorRecord>,
    /// The parts of mirrors; may be empty.
    pub mirrors: Vec<MirrorRecord>,
    /// The name of each cell for users, in the order of `cells`; names may repeat. Empty: cells have no names.
    pub cell_names: Vec<String>,
    /// Finds the cells at a point; complete for the cells' boxes.
    pub locator: Locator,
    /// In space: locates points in place of the cells' boxes. `None`: the boxes do.
    pub planes: Option<PlaneTree>,
    /// The stab trees of all cells, over the portals of the table; `None`: not known.
    pub stab: Option<StabTrees>,
    /// Free keys and values for people (source, method, options), with strictly ascending keys; no code depends on them.
    pub info: Vec<(String, String)>,
}

impl TableParts {
    /// Parts without any content, of a kind, in a plane (2) or in space (3): to be filled.
    pub fn empty(dimension: u8, kind: TableKind) -> Self {
        Self {
            dimension,
            kind,
            up: None,
            frame: None,
            digest: None,
            cells: Vec::new(),
            portals: Vec::new(),
            rows: BitMatrix::default(),
            objects: Vec::new(),
            cell_objects: Vec::new(),
            objects_seen: None,
            object_polygons: Vec::new(),
            object_parts: None,
            object_sources: Vec::new(),
            doors: Vec::new(),
            mirrors: Vec::new(),
            cell_names: Vec::new(),
            locator: Locator::default(),
            planes: None,
            stab: None,
            info: Vec::new(),
        }
    }

    /// The boxes around the cells, as [`Locator::build`] takes them.
    pub fn cell_bounds(&self) -> Vec<([f64; 3], [f64; 3])> {
        self.cells.iter().map(|cell| (cell.min, cell.max)).collect()
    }
}
