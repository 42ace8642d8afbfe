//! The table and its queries.

use crate::parts::{DOOR_BOXES, TableParts};
use crate::records::{CellRecord, DoorRecord, MirrorRecord, ObjectPart, ObjectRecord, ObjectSource, PortalRecord};
use crate::{
    Axis, CellId, CellSet, Frame, FrameError, GeometryDigest, Locator, NodeIndex, ObjectId, PlaneTree, StabTrees,
    TableError, TableKind, TriangleRange, bits, side, triangle_ranges,
};

/// Which cells of a scene can see each other: checked, and immutable.
///
/// Every answer errs towards "visible".
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    parts: TableParts,
    /// The objects of each node, by the parts.
    nodes: NodeIndex,
}

impl Table {
    /// Checks `parts`: shapes, ids, finite coordinates, convex polygons inside their boxes, symmetric
    /// rows with ones on the diagonal, a locator that misses no cell. O(size * log(size)).
    ///
    /// # Errors
    /// The first [`TableError`].
    pub fn new(parts: TableParts) -> Result<Self, TableError> {
        parts.check()?;
        Ok(Self { nodes: NodeIndex::new(&parts.object_sources), parts })
    }

    /// The parts, for inspection.
    pub fn parts(&self) -> &TableParts {
        &self.parts
    }

    /// The parts, for changes and another check.
    pub fn into_parts(self) -> TableParts {
        self.parts
    }

    /// The same table without portals, doors, stab trees and polygons: smaller, and enough for a game that queries by cell or
    /// by position.
    ///
    /// The cells become their boxes, so a point may be found in more cells than before, and never in
    /// fewer. Rows, objects, mirrors, planes, ids and names of cells and objects stay.
    #[must_use]
    pub fn strip_geometry(&self) -> Self {
        let mut parts = self.parts.clone();
        parts.portals.clear();
        parts.doors.clear();
        parts.info.retain(|(key, _)| key != DOOR_BOXES);
        parts.stab = None;
        parts.cells.iter_mut().for_each(|cell| cell.polygon.clear());
        Self { parts, nodes: self.nodes.clone() }
    }

    /// 2 for a plane, 3 for space.
    pub fn dimension(&self) -> u8 {
        self.parts.dimension
    }

    /// What was cut into cells, and how.
    pub fn kind(&self) -> TableKind {
        self.parts.kind
    }

    /// The axis that points up, in its positive direction; `None` if it is not known.
    pub fn up(&self) -> Option<Axis> {
        self.parts.up
    }

    /// The axes along which the coordinates of cells, portals, objects and mirrors are; `None`: those of the scene. Queries take
    /// points and boxes of the scene, with a frame or without.
    pub fn frame(&self) -> Option<&Frame> {
        self.parts.frame.as_ref()
    }

    /// The same table in another frame: its coordinates stay as they are, and are along these axes from now on. With `None`,
    /// queries take points along the axes of the table.
    ///
    /// # Errors
    /// [`TableError::Frame`] for a frame in a table of the plane.
    pub fn with_frame(mut self, frame: Option<Frame>) -> Result<Self, TableError> {
        if frame.is_some() && self.dimension() != 3 {
            return Err(FrameError::Plane.into());
        }
        self.parts.frame = frame;
        Ok(self)
    }

    /// Digests of the geometry that the table was made of; `None` if they are not known, as in older files.
    pub fn digest(&self) -> Option<GeometryDigest> {
        self.parts.digest
    }

    /// The same table with other digests of what it was made of.
    #[must_use]
    pub fn with_digest(mut self, digest: Option<GeometryDigest>) -> Self {
        self.parts.digest = digest;
        self
    }

    /// The same table with other doors.
    ///
    /// # Errors
    /// [`TableError`] for objects and portals that there are not, and portals that do not ascend.
    pub fn with_doors(mut self, doors: Vec<DoorRecord>) -> Result<Self, TableError> {
        self.parts.doors = doors;
        self.parts.check_doors()?;
        Ok(self)
    }

    /// The same table with another text under a key of its [free texts](Self::info).
    pub(crate) fn with_info(mut self, key: &str, value: String) -> Self {
        self.parts.info.retain(|(other, _)| other != key);
        self.parts.info.push((key.to_owned(), value));
        self.parts.info.sort();
        self
    }

    /// Whether cells can be found at points: not in a table of the clusters of a Quake map without planes.
    pub fn has_places(&self) -> bool {
        !self.parts.kind.is_quake() || self.parts.planes.is_some()
    }

    /// Number of cells; ids are below it.
    pub fn n_cells(&self) -> usize {
        self.parts.cells.len()
    }

    /// The cells, by id.
    pub fn cells(&self) -> &[CellRecord] {
        &self.parts.cells
    }

    /// The portals, in the order in which they were given; empty in a stripped table.
    pub fn portals(&self) -> &[PortalRecord] {
        &self.parts.portals
    }

    /// The objects, by id.
    pub fn objects(&self) -> &[ObjectRecord] {
        &self.parts.objects
    }

    /// The locator of the cells at a point.
    pub fn locator(&self) -> &Locator {
        &self.parts.locator
    }

    /// Number of polygons of an object; 1 if it is unknown.
    ///
    /// # Panics
    /// If the table has no such object.
    pub fn polygons_of(&self, object: ObjectId) -> u32 {
        let n_objects = self.parts.objects.len();
        assert!(object.idx() < n_objects, "object {object} of {n_objects}");
        self.parts.object_polygons.get(object.idx()).copied().unwrap_or(1)
    }

    /// Where an object is in the file that the table was made of; `None` if that is not known, as in older files, or if it has no
    /// place there. O(1).
    ///
    /// # Panics
    /// If the table has no such object.
    pub fn source_of(&self, object: ObjectId) -> Option<ObjectSource> {
        let n_objects = self.parts.objects.len();
        assert!(object.idx() < n_objects, "object {object} of {n_objects}");
        self.parts.object_sources.get(object.idx()).copied().flatten()
    }

    /// Whether it is known where any of the objects are in the file that the table was made of ([`Table::source_of`]).
    pub fn has_sources(&self) -> bool {
        !self.nodes.is_empty()
    }

    /// The objects of a node of that file, ascending: one for each primitive of its mesh, and of each of its instances. None for a node without a
    /// mesh, and where sources are not known. O(log n).
    pub fn objects_of_node(&self, node: u32) -> impl Iterator<Item = ObjectId> + '_ {
        self.nodes.objects_of(node)
    }

    /// The parts of objects, by object; objects that were not cut have none. Empty if none was.
    pub fn object_parts(&self) -> &[ObjectPart] {
        self.parts.object_parts.as_ref().map_or(&[], |of| &of.parts)
    }

    /// The name of a cell for users; `None` if the cells of the table have no names. O(1).
    ///
    /// # Panics
    /// If the table has no such cell.
    pub fn cell_name(&self, cell: CellId) -> Option<&str> {
        let n_cells = self.n_cells();
        assert!(cell.idx() < n_cells, "cell {cell} of {n_cells}");
        self.parts.cell_names.get(cell.idx()).map(String::as_str)
    }

    /// Whether the cells have names ([`Table::cell_name`]).
    pub fn has_cell_names(&self) -> bool {
        !self.parts.cell_names.is_empty()
    }

    /// The parts of mirrors, in the order in which they were given.
    pub fn mirrors(&self) -> &[MirrorRecord] {
        &self.parts.mirrors
    }

    /// The plane tree that locates points in place of the cells' boxes, if there is one.
    pub fn planes(&self) -> Option<&PlaneTree> {
        self.parts.planes.as_ref()
    }

    /// The stab trees of all cells, if the table has them.
    pub fn stab(&self) -> Option<&StabTrees> {
        self.parts.stab.as_ref()
    }

    /// Free keys and values for people, by ascending key; see [`Table::kind`] for what code may depend on.
    pub fn info(&self) -> &[(String, String)] {
        &self.parts.info
    }

    /// The value of a key of [`Table::info`].
    pub fn info_value(&self, key: &str) -> Option<&str> {
        let info = &self.parts.info;
        info.binary_search_by(|(k, _)| k.as_str().cmp(key)).ok().map(|i| info[i].1.as_str())
    }

    /// Whether something in `a` may be seen from somewhere in `b`; symmetric. O(1).
    ///
    /// # Panics
    /// If the table has no such cells.
    #[inline]
    pub fn sees(&self, a: CellId, b: CellId) -> bool {
        self.parts.rows.get(a.idx(), b.idx())
    }

    /// The cells that `cell` may see, itself included, ascending.
    ///
    /// # Panics
    /// If the table has no such cell.
    pub fn visible(&self, cell: CellId) -> impl Iterator<Item = CellId> + '_ {
        self.parts.rows.iter_ones(cell.idx()).map(|i| CellId(i as u32))
    }

    /// The row of a cell: bit `j % 64` of word `j / 64` is set if it may see cell `j`.
    ///
    /// # Panics
    /// If the table has no such cell.
    #[inline]
    pub fn row(&self, cell: CellId) -> &[u64] {
        self.parts.rows.row(cell.idx())
    }

    /// The objects that touch a cell, ascending.
    ///
    /// # Panics
    /// If the table has no such cell.
    pub fn objects_of(&self, cell: CellId) -> &[ObjectId] {
        &self.parts.cell_objects[cell.idx()]
    }

    /// The objects that `cell` may see, ascending.
    ///
    /// # Panics
    /// If the table has no such cell.
    pub fn visible_objects(&self, cell: CellId) -> Vec<ObjectId> {
        match &self.parts.objects_seen {
            Some(seen) => seen.iter_ones(cell.idx()).map(|o| ObjectId(o as u32)).collect(),
            None => self.objects_in_row(self.row(cell)),
        }
    }

    /// What `cell` may see, as for [`Inside::visible_ranges`](crate::Inside::visible_ranges).
    ///
    /// # Panics
    /// If the table has no such cell.
    pub fn visible_ranges(&self, cell: CellId) -> Vec<TriangleRange> {
        let parts = self.parts.object_parts.iter().flat_map(|of| of.seen.iter_ones(cell.idx()));
        triangle_ranges(self.object_parts(), &self.visible_objects(cell), parts)
    }

    /// The objects that touch a cell of the set, ascending.
    ///
    /// # Panics
    /// If the set is from a table with more cells.
    pub fn objects_in(&self, cells: &CellSet) -> Vec<ObjectId> {
        self.objects_in_row(cells.words())
    }

    fn objects_in_row(&self, row: &[u64]) -> Vec<ObjectId> {
        let mut objects: Vec<ObjectId> =
            bits::ones(row).flat_map(|i| self.parts.cell_objects[i].iter().copied()).collect();
        objects.sort_unstable();
        objects.dedup();
        objects
    }

    /// Calls `visit` with every cell that contains the point, see [`crate::Query::at`]; a cell may be visited more than
    /// once, in no particular order. The coordinates must be finite, and z must be 0 in a plane. `pending` is scratch
    /// space.
    pub(crate) fn for_each_cell_at(&self, p: [f64; 3], pending: &mut Vec<u32>, mut visit: impl FnMut(CellId)) {
        if let Some(frame) = &self.parts.frame {
            let (min, max) = frame.around(p, p);
            return self.for_each_touching_along(min, max, pending, |cell| {
                visit(cell);
                true
            });
        }
        match &self.parts.planes {
            Some(planes) => planes.for_each_cell(p, pending, visit),
            None => self.parts.locator.for_each_candidate_in(p, pending, |id| {
                if self.may_contain(&self.parts.cells[id.idx()], p) {
                    visit(id);
                }
            }),
        }
    }

    /// Calls `visit` with every cell that the closed box from `min` to `max` (of the scene, in its units; z is 0 in a plane)
    /// touches, until it returns `false`; a cell may be visited more than once, in no particular order. `pending` is
    /// scratch space. In a table with a frame these are the cells that the box around that one, along the frame, touches.
    ///
    /// Cells are closed polygons, or boxes, or defined by a [`PlaneTree`], as for [`crate::Query::at`]. Errs towards
    /// touching, by rounding only: every cell that the box touches is visited. A NaN bounds nothing. O(cells near the
    /// box).
    #[inline]
    pub fn for_each_touching(
        &self,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        visit: impl FnMut(CellId) -> bool,
    ) {
        let (min, max) = self.parts.frame.map_or((min, max), |frame| frame.around(min, max));
        self.for_each_touching_along(min, max, pending, visit);
    }

    /// The same for a box along the axes of the table.
    #[inline]
    fn for_each_touching_along(
        &self,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        mut visit: impl FnMut(CellId) -> bool,
    ) {
        if let Some(planes) = &self.parts.planes {
            return planes.for_each_cell_of_box(min, max, pending, visit);
        }
        self.parts.locator.for_each_candidate_of_box(min, max, pending, |id| {
            let cell = &self.parts.cells[id.idx()];
            let apart = (0..3).any(|k| cell.min[k] > max[k] || cell.max[k] < min[k]);
            apart || !side::polygon_may_touch_box(&cell.polygon, [min[0], min[1]], [max[0], max[1]]) || visit(id)
        });
    }

    /// The *visible share*: of all pairs of different cells, those that may see each other, from 0 to 1. That is also the share of the other
    /// cells that a cell sees, averaged over all cells. 0 for fewer than two cells.
    pub fn mean_visible_share(&self) -> f64 {
        let n = self.n_cells() as u64;
        let n_ordered = n.saturating_mul(n.saturating_sub(1));
        // Each cell sees itself, which is no pair.
        if n_ordered == 0 { 0.0 } else { (self.parts.rows.count_ones() - n) as f64 / n_ordered as f64 }
    }

    fn may_contain(&self, cell: &CellRecord, p: [f64; 3]) -> bool {
        let in_box = (0..3).all(|k| cell.min[k] <= p[k] && p[k] <= cell.max[k]);
        in_box && side::polygon_may_contain(cell.polygon.iter().copied(), [p[0], p[1]])
    }
}
