//! Cells, portals, objects and mirrors as a table stores them.

use crate::{BitMatrix, CellId, MirrorId, ObjectId, PortalId};
use std::ops::Range;

/// A convex cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellRecord {
    /// Lower corner of a box around the cell, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
    /// The group of the cell, such as a Doom sector.
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

/// Something that is visible or not, and hides nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectRecord {
    /// The name of the object for users; names may repeat, see [`ObjectSource`].
    pub name: String,
    /// Lower corner of a box around the object, in scene units; z is 0 in a plane.
    pub min: [f64; 3],
    /// Upper corner of that box.
    pub max: [f64; 3],
}

/// Where an object is in the file that the table was made of: a program that has loaded the same file finds it there.
///
/// Of a glTF file, an object is one primitive of one node. Instances of a node (`EXT_mesh_gpu_instancing`) are objects each, of equal source: of
/// several with one node and primitive, the k-th in the order of ids is instance k. Other formats have no nodes: objects of an OBJ
/// file, which are told by their names, have no source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectSource {
    /// Index of the node in the `nodes` of the file; below 2^32 - 1.
    pub node: u32,
    /// Index of the primitive in the `primitives` of the node's mesh.
    pub primitive: u32,
}

/// A part of an object: a range of its triangles, in the order of the file that the table was made of; degenerate triangles are counted. A program that
/// draws lists of triangles draws it by an offset and a count. In an OBJ file, the triangles are those into which the faces are divided, without faces that were left
/// out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectPart {
    /// The object.
    pub object: ObjectId,
    /// Its first triangle.
    pub start: u32,
    /// The one behind its last triangle.
    pub end: u32,
}

/// The parts of objects, and which cells may see them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectParts {
    /// By object, each time all parts of it: they begin at its triangle 0, and each at the end of the one before. Objects that were not cut have none.
    pub parts: Vec<ObjectPart>,
    /// Bit `p` of row `i`: cell `i` may see part `p`. Where it sees one, it sees the object.
    pub seen: BitMatrix,
}

/// Triangles of an object, counted as for [`ObjectPart`]; none for all of them, as of an object that was not cut.
pub type TriangleRange = (ObjectId, Option<Range<u32>>);

/// Of objects the ranges of triangles that are seen, which do not meet; no range for all of an object that was not cut.
///
/// * `all`: the parts of all objects
/// * `objects`: those that are seen, ascending
/// * `parts`: those that are seen, by their places in `all`, ascending
pub fn triangle_ranges(
    all: &[ObjectPart],
    objects: &[ObjectId],
    parts: impl IntoIterator<Item = usize>,
) -> Vec<TriangleRange> {
    let mut parts = parts.into_iter().map(|part| all[part]).peekable();
    let mut ranges: Vec<TriangleRange> = Vec::with_capacity(objects.len());
    for &object in objects {
        let n = ranges.len();
        while parts.next_if(|part| part.object < object).is_some() {}
        while let Some(part) = parts.next_if(|part| part.object == object) {
            match ranges[n..].last_mut() {
                Some((_, Some(range))) if range.end == part.start => range.end = part.end,
                _ => ranges.push((object, Some(part.start..part.end))),
            }
        }
        if ranges.len() == n && all.binary_search_by_key(&object, |part| part.object).is_err() {
            ranges.push((object, None));
        }
    }
    ranges
}

/// A door, and the portals that nothing is seen through while it is shut.
///
/// A table takes all doors to be open. A program that knows that one is shut closes its portals, for every eye that is not
/// inside the door.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoorRecord {
    /// The name of the door for users; names may repeat.
    pub name: String,
    /// The object that is the door; `None` for one that was given as a box.
    pub object: Option<ObjectId>,
    /// The portals that it closes, ascending. None if it fills no opening, or only parts of portals: then it changes nothing.
    pub portals: Vec<PortalId>,
}

/// The part of a mirror that lies in a cell or on its border.
#[derive(Debug, Clone, PartialEq)]
pub struct MirrorRecord {
    /// The closed cell that the part lies in or on; it reflects what comes from there.
    pub cell: CellId,
    /// The mirror, of which there may be parts in several cells; not checked.
    pub mirror: MirrorId,
    /// Its corners in scene units. In a plane (z is 0) two: the left end, then the right end, as seen
    /// looking from the cell towards the mirror. In space at least three, counter-clockwise as seen so.
    pub points: Vec<[f64; 3]>,
}
