//! The validation of a table's parts.

use crate::parts::TableParts;
use crate::records::{CellRecord, MirrorRecord, ObjectPart, ObjectParts, ObjectRecord, ObjectSource, PortalRecord};
use crate::{
    BitMatrix, CellId, DoorId, FrameError, LocatorError, ObjectId, PlaneError, PortalId, StabError, TableKind, side,
};

/// A kind of thing with coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// A cell's box.
    Cell,
    /// A cell's polygon.
    Polygon,
    /// A portal.
    Portal,
    /// An object's box.
    Object,
    /// A part of a mirror.
    Mirror,
    /// A door.
    Door,
}

impl std::fmt::Display for Item {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cell => "cell",
            Self::Polygon => "the polygon of cell",
            Self::Portal => "portal",
            Self::Object => "object",
            Self::Mirror => "mirror",
            Self::Door => "door",
        })
    }
}

/// Why parts do not make a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Neither 2 nor 3.
    #[error("a table has 2 or 3 dimensions, not {0}")]
    Dimension(u8),
    /// A kind of table that has another dimension.
    #[error("a table of the kind '{kind}' does not have {dimension} dimensions")]
    Kind {
        /// The kind.
        kind: TableKind,
        /// Number of dimensions.
        dimension: u8,
    },
    /// More items of one kind than 32 bits count.
    #[error("{n} are more than 32 bits can count (item kind: {item})")]
    TooMany {
        /// The kind of item; corners of all polygons count as [`Item::Polygon`].
        item: Item,
        /// The number of items.
        n: usize,
    },
    /// NaN or an infinity.
    #[error("{item} {index} has a coordinate that is not a finite number")]
    NotFinite {
        /// The kind of item.
        item: Item,
        /// Its index.
        index: usize,
    },
    /// A box with a lower corner above the upper one.
    #[error("{item} {index} has a lower corner above its upper corner")]
    Inverted {
        /// The kind of item.
        item: Item,
        /// Its index.
        index: usize,
    },
    /// A z that is not 0, in a plane.
    #[error("{item} {index} has a z that is not 0, in a table of the plane")]
    OffPlane {
        /// The kind of item.
        item: Item,
        /// Its index.
        index: usize,
    },
    /// A polygon in space, or one with one or two corners.
    #[error("the polygon of cell {cell} cannot have {n} corners")]
    Corners {
        /// The cell.
        cell: CellId,
        /// Number of corners.
        n: usize,
    },
    /// A polygon that certainly is not convex and counter-clockwise.
    #[error("the polygon of cell {cell} is not convex and counter-clockwise at corner {corner}")]
    NotConvex {
        /// The cell.
        cell: CellId,
        /// The corner at which it shows.
        corner: usize,
    },
    /// A polygon that leaves the cell's box.
    #[error("corner {corner} of the polygon of cell {cell} is outside the cell's box")]
    OutsideBox {
        /// The cell.
        cell: CellId,
        /// The corner.
        corner: usize,
    },
    /// A portal to a cell that does not exist.
    #[error("portal {portal} leads to cell {cell}, which does not exist")]
    PortalCell {
        /// The portal.
        portal: usize,
        /// The cell.
        cell: CellId,
    },
    /// A portal from a cell to itself.
    #[error("portal {portal} joins cell {cell} with itself")]
    PortalLoop {
        /// The portal.
        portal: usize,
        /// The cell.
        cell: CellId,
    },
    /// A portal with the wrong number of points.
    #[error("portal {portal} cannot have {n} points")]
    PortalPoints {
        /// The portal.
        portal: usize,
        /// Number of points.
        n: usize,
    },
    /// Rows that are not one row and one column for each cell.
    #[error("{n_rows} rows of {n_cols} bits do not fit {n_cells} cells")]
    RowsShape {
        /// Number of rows.
        n_rows: usize,
        /// Number of columns.
        n_cols: usize,
        /// Number of cells.
        n_cells: usize,
    },
    /// A row with a one past the last cell.
    #[error("the row of cell {0} has a one past the last cell")]
    RowTail(CellId),
    /// A cell that does not see itself.
    #[error("cell {0} does not see itself")]
    NotReflexive(CellId),
    /// Two cells of which only one sees the other.
    #[error("of cells {} and {} only one sees the other", .0[0], .0[1])]
    NotSymmetric([CellId; 2]),
    /// Not one list of objects for each cell.
    #[error("{n} lists of objects do not fit {n_cells} cells")]
    CellObjects {
        /// Number of lists.
        n: usize,
        /// Number of cells.
        n_cells: usize,
    },
    /// The objects of a cell are not ascending.
    #[error("the objects of cell {0} are not ascending")]
    ObjectOrder(CellId),
    /// An object that does not exist.
    #[error("cell {cell} is touched by object {object}, which does not exist")]
    UnknownObject {
        /// The cell.
        cell: CellId,
        /// The object.
        object: ObjectId,
    },
    /// Rows of objects that are not one row for each cell and one column for each object.
    #[error("{n_rows} rows of {n_cols} objects do not fit {n_cells} cells and {n_objects} objects")]
    SeenShape {
        /// Number of rows.
        n_rows: usize,
        /// Number of columns.
        n_cols: usize,
        /// Number of cells.
        n_cells: usize,
        /// Number of objects.
        n_objects: usize,
    },
    /// A row of objects with a one past the last object.
    #[error("the row of objects of cell {0} has a one past the last object")]
    SeenTail(CellId),
    /// A cell that does not see an object that touches it.
    #[error("cell {cell} does not see object {object}, which touches it")]
    Unseen {
        /// The cell.
        cell: CellId,
        /// The object.
        object: ObjectId,
    },
    /// Numbers of polygons, but not one for each object.
    #[error("{n} numbers of polygons do not fit {n_objects} objects")]
    ObjectPolygons {
        /// Number of numbers.
        n: usize,
        /// Number of objects.
        n_objects: usize,
    },
    /// Sources of objects, but not one for each object.
    #[error("{n} sources of objects do not fit {n_objects} objects")]
    ObjectSources {
        /// Number of sources.
        n: usize,
        /// Number of objects.
        n_objects: usize,
    },
    /// An object of a node whose number is reserved.
    #[error("object {0} cannot be of node 4294967295")]
    ObjectNode(ObjectId),
    /// Rows of parts that are not cells by parts.
    #[error("{n_rows} x {n_cols} bits of parts of objects do not fit {n_cells} cells and {n_parts} parts")]
    PartsShape {
        /// Rows of the matrix.
        n_rows: usize,
        /// Columns of the matrix.
        n_cols: usize,
        /// Number of cells.
        n_cells: usize,
        /// Number of parts.
        n_parts: usize,
    },
    /// A row of parts with a one past the last part.
    #[error("the row of parts of cell {0} has a one past the last part")]
    PartsTail(CellId),
    /// A part that does not begin where it has to, or has no triangles.
    #[error("part {0} does not begin where the one before ends, or has no triangles")]
    PartOrder(usize),
    /// A part of an object that does not exist.
    #[error("part {part} is of object {object}, which does not exist")]
    PartObject {
        /// The part.
        part: usize,
        /// The object.
        object: ObjectId,
    },
    /// Rows of parts without rows of objects.
    #[error("rows of parts of objects need rows of objects")]
    PartsAlone,
    /// A cell that sees a part of an object, but not the object.
    #[error("cell {cell} sees a part of object {object}, but not the object")]
    PartSeen {
        /// The cell.
        cell: CellId,
        /// The object.
        object: ObjectId,
    },
    /// A door that is an object that does not exist.
    #[error("door {door} is object {object}, which does not exist")]
    DoorObject {
        /// The door.
        door: DoorId,
        /// The object.
        object: ObjectId,
    },
    /// A door that closes a portal that does not exist.
    #[error("door {door} closes portal {portal}, which does not exist")]
    DoorPortal {
        /// The door.
        door: DoorId,
        /// The portal.
        portal: PortalId,
    },
    /// The portals of a door are not ascending.
    #[error("the portals of door {0} are not ascending")]
    DoorOrder(DoorId),
    /// Names of cells, but not one for each cell.
    #[error("{n} names of cells do not fit {n_cells} cells")]
    CellNames {
        /// Number of names.
        n: usize,
        /// Number of cells.
        n_cells: usize,
    },
    /// A mirror in a cell that does not exist.
    #[error("mirror {mirror} is in cell {cell}, which does not exist")]
    MirrorCell {
        /// The part of a mirror.
        mirror: usize,
        /// The cell.
        cell: CellId,
    },
    /// A mirror with the wrong number of points.
    #[error("mirror {mirror} cannot have {n} points")]
    MirrorPoints {
        /// The part of a mirror.
        mirror: usize,
        /// Number of points.
        n: usize,
    },
    /// The frame is wrong.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The plane tree is wrong.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// The stab trees are wrong.
    #[error(transparent)]
    Stab(#[from] StabError),
    /// The locator is wrong.
    #[error(transparent)]
    Locator(#[from] LocatorError),
    /// Two keys that are equal or not ascending.
    #[error("info entry {0} does not have a larger key than the one before")]
    InfoOrder(usize),
    /// A text of 4 GiB or more.
    #[error("a text has {0} bytes, more than 32 bits can count")]
    TooLong(usize),
}

impl TableParts {
    /// Checks everything that a table guarantees. O(size), except for the locator, O(entries * depth).
    pub(crate) fn check(&self) -> Result<(), TableError> {
        self.check_with(|parts| {
            parts.check_rows()?;
            parts.check_objects()?;
            parts.objects_seen.as_ref().map_or(Ok(()), |seen| parts.check_seen(seen))?;
            parts.check_parts_seen()
        })
    }

    /// Checks everything that a [`Table`](crate::Table) guarantees, except for its `rows` and `objects_seen`, which are not looked at: for
    /// those who write or read rows one by one. O(size of the rest), except for the locator, O(entries * depth).
    ///
    /// # Errors
    /// [`TableError`] for the first defect.
    pub fn check_without_rows(&self) -> Result<(), TableError> {
        self.check_with(Self::check_objects)
    }

    /// `check_rows` checks rows and objects, at its place among the other checks.
    fn check_with(&self, check_rows: impl FnOnce(&Self) -> Result<(), TableError>) -> Result<(), TableError> {
        if !matches!(self.dimension, 2 | 3) {
            return Err(TableError::Dimension(self.dimension));
        }
        if self.kind.dimension().is_some_and(|d| d != self.dimension) {
            return Err(TableError::Kind { kind: self.kind, dimension: self.dimension });
        }
        if self.frame.is_some() && self.dimension != 3 {
            return Err(FrameError::Plane.into());
        }
        self.check_counts()?;
        let mut cells = (0u32..).map(CellId).zip(&self.cells);
        cells.try_for_each(|(id, cell)| self.check_cell(id, cell))?;
        if !self.cell_names.is_empty() && self.cell_names.len() != self.cells.len() {
            return Err(TableError::CellNames { n: self.cell_names.len(), n_cells: self.cells.len() });
        }
        self.portals.iter().enumerate().try_for_each(|(i, portal)| self.check_portal(i, portal))?;
        check_rows(self)?;
        self.mirrors.iter().enumerate().try_for_each(|(i, mirror)| self.check_mirror(i, mirror))?;
        self.check_doors()?;
        self.locator.check(&self.cell_bounds(), self.dimension)?;
        self.planes.as_ref().map_or(Ok(()), |planes| planes.check(self.cells.len(), self.dimension))?;
        self.stab.as_ref().map_or(Ok(()), |stab| stab.check(&self.portals, self.cells.len()))?;
        match self.info.windows(2).position(|pair| pair[0].0 >= pair[1].0) {
            Some(i) => Err(TableError::InfoOrder(i + 1)),
            None => Ok(()),
        }
    }

    /// Whether there are the objects and portals of all doors, and their counts and names have 32 bits.
    pub(crate) fn check_doors(&self) -> Result<(), TableError> {
        if u32::try_from(self.doors.len()).is_err() {
            return Err(TableError::TooMany { item: Item::Door, n: self.doors.len() });
        }
        for (door, record) in (0u32..).map(DoorId).zip(&self.doors) {
            if u32::try_from(record.name.len()).is_err() {
                return Err(TableError::TooLong(record.name.len()));
            }
            if let Some(object) = record.object.filter(|object| object.idx() >= self.objects.len()) {
                return Err(TableError::DoorObject { door, object });
            }
            if !record.portals.is_sorted_by(|a, b| a < b) {
                return Err(TableError::DoorOrder(door));
            }
            // They ascend, so the last is the largest.
            if let Some(&portal) = record.portals.last().filter(|portal| portal.idx() >= self.portals.len()) {
                return Err(TableError::DoorPortal { door, portal });
            }
        }
        Ok(())
    }

    /// Every count and length has 32 bits in a file.
    fn check_counts(&self) -> Result<(), TableError> {
        let corners: usize = self.cells.iter().map(|cell| cell.polygon.len()).sum();
        let touches: usize = self.cell_objects.iter().map(Vec::len).sum();
        let counts = [
            (Item::Cell, self.cells.len()),
            (Item::Polygon, corners),
            (Item::Portal, self.portals.len()),
            (Item::Object, self.objects.len().max(touches)),
            (Item::Mirror, self.mirrors.len()),
        ];
        if let Some(&(item, n)) = counts.iter().find(|(_, n)| u32::try_from(*n).is_err()) {
            return Err(TableError::TooMany { item, n });
        }
        let names = self.objects.iter().map(|object| &object.name).chain(&self.cell_names);
        let mut texts = names.chain(self.info.iter().flat_map(|(k, v)| [k, v])).map(String::len);
        match texts.find(|&n| u32::try_from(n).is_err()) {
            Some(n) => Err(TableError::TooLong(n)),
            None => Ok(()),
        }
    }

    fn check_box(&self, item: Item, index: usize, min: &[f64; 3], max: &[f64; 3]) -> Result<(), TableError> {
        self.check_points(item, index, &[*min, *max])?;
        if (0..3).any(|k| min[k] > max[k]) { Err(TableError::Inverted { item, index }) } else { Ok(()) }
    }

    fn check_points(&self, item: Item, index: usize, points: &[[f64; 3]]) -> Result<(), TableError> {
        if !points.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(TableError::NotFinite { item, index });
        }
        // Bits are compared: a negative zero would not survive a file.
        let off_plane = self.dimension == 2 && points.iter().any(|p| p[2].to_bits() != 0);
        if off_plane { Err(TableError::OffPlane { item, index }) } else { Ok(()) }
    }

    fn check_cell(&self, id: CellId, cell: &CellRecord) -> Result<(), TableError> {
        let CellRecord { min, max, polygon, .. } = cell;
        self.check_box(Item::Cell, id.idx(), min, max)?;
        let n = polygon.len();
        if n > 0 && (n < 3 || self.dimension == 3) {
            return Err(TableError::Corners { cell: id, n });
        }
        if !polygon.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(TableError::NotFinite { item: Item::Polygon, index: id.idx() });
        }
        let outside = |c: &[f64; 2]| (0..2).any(|k| c[k] < min[k] || c[k] > max[k]);
        if let Some(corner) = polygon.iter().position(outside) {
            return Err(TableError::OutsideBox { cell: id, corner });
        }
        side::first_defect(polygon).map_or(Ok(()), |corner| Err(TableError::NotConvex { cell: id, corner }))
    }

    fn check_portal(&self, index: usize, portal: &PortalRecord) -> Result<(), TableError> {
        if let Some(&cell) = portal.cells.iter().find(|cell| cell.idx() >= self.cells.len()) {
            return Err(TableError::PortalCell { portal: index, cell });
        }
        if portal.cells[0] == portal.cells[1] {
            return Err(TableError::PortalLoop { portal: index, cell: portal.cells[0] });
        }
        let n = portal.points.len();
        if !self.outlines(n) {
            return Err(TableError::PortalPoints { portal: index, n });
        }
        self.check_points(Item::Portal, index, &portal.points)
    }

    /// Whether `n` points can be the outline of something flat.
    fn outlines(&self, n: usize) -> bool {
        if self.dimension == 2 { n == 2 } else { n >= 3 && u32::try_from(n).is_ok() }
    }

    fn check_mirror(&self, index: usize, mirror: &MirrorRecord) -> Result<(), TableError> {
        if mirror.cell.idx() >= self.cells.len() {
            return Err(TableError::MirrorCell { mirror: index, cell: mirror.cell });
        }
        let n = mirror.points.len();
        if !self.outlines(n) {
            return Err(TableError::MirrorPoints { mirror: index, n });
        }
        self.check_points(Item::Mirror, index, &mirror.points)
    }

    fn check_rows(&self) -> Result<(), TableError> {
        let (rows, n_cells) = (&self.rows, self.cells.len());
        if (rows.n_rows(), rows.n_cols()) != (n_cells, n_cells) {
            return Err(TableError::RowsShape { n_rows: rows.n_rows(), n_cols: rows.n_cols(), n_cells });
        }
        let id = |i: usize| CellId(i as u32);
        if let Some(row) = rows.first_stray() {
            return Err(TableError::RowTail(id(row)));
        }
        if let Some(cell) = (0..n_cells).find(|&i| !rows.get(i, i)) {
            return Err(TableError::NotReflexive(id(cell)));
        }
        rows.first_asymmetry().map_or(Ok(()), |(a, b)| Err(TableError::NotSymmetric([id(a), id(b)])))
    }

    fn check_seen(&self, seen: &BitMatrix) -> Result<(), TableError> {
        let (n_cells, n_objects) = (self.cells.len(), self.objects.len());
        if (seen.n_rows(), seen.n_cols()) != (n_cells, n_objects) {
            return Err(TableError::SeenShape { n_rows: seen.n_rows(), n_cols: seen.n_cols(), n_cells, n_objects });
        }
        if let Some(row) = seen.first_stray() {
            return Err(TableError::SeenTail(CellId(row as u32)));
        }
        for (cell, list) in (0u32..).map(CellId).zip(&self.cell_objects) {
            if let Some(&object) = list.iter().find(|&&o| !seen.get(cell.idx(), o.idx())) {
                return Err(TableError::Unseen { cell, object });
            }
        }
        Ok(())
    }

    /// Whether the parts of each object follow each other from its triangle 0 on.
    fn check_object_parts(&self) -> Result<(), TableError> {
        let Some(ObjectParts { parts, .. }) = &self.object_parts else { return Ok(()) };
        let mut before: Option<&ObjectPart> = None;
        for (index, part) in parts.iter().enumerate() {
            if part.object.idx() >= self.objects.len() {
                return Err(TableError::PartObject { part: index, object: part.object });
            }
            let start = match before.filter(|before| before.object >= part.object) {
                Some(before) if before.object == part.object => before.end,
                Some(_) => return Err(TableError::PartOrder(index)),
                None => 0,
            };
            if part.start != start || part.end <= start {
                return Err(TableError::PartOrder(index));
            }
            before = Some(part);
        }
        Ok(())
    }

    /// Checks that rows of parts, if there are any, have the shape that they need: for those who write other rows one by one. O(size of the rows).
    ///
    /// # Errors
    /// [`TableError::PartsShape`], [`TableError::PartsTail`].
    pub fn check_rows_of_parts(&self) -> Result<(), TableError> {
        let Some(ObjectParts { parts, seen }) = &self.object_parts else { return Ok(()) };
        let (n_cells, n_parts) = (self.cells.len(), parts.len());
        if (seen.n_rows(), seen.n_cols()) != (n_cells, n_parts) {
            return Err(TableError::PartsShape { n_rows: seen.n_rows(), n_cols: seen.n_cols(), n_cells, n_parts });
        }
        seen.first_stray().map_or(Ok(()), |row| Err(TableError::PartsTail(CellId(row as u32))))
    }

    /// Whether all objects are seen of which a part is.
    fn check_parts_seen(&self) -> Result<(), TableError> {
        self.check_rows_of_parts()?;
        let Some(ObjectParts { parts, seen }) = &self.object_parts else { return Ok(()) };
        let objects_seen = self.objects_seen.as_ref().ok_or(TableError::PartsAlone)?;
        for (cell, row) in (0u32..).map(CellId).zip(0..self.cells.len()) {
            let objects = seen.iter_ones(row).map(|part| parts[part].object);
            if let Some(object) = objects.into_iter().find(|object| !objects_seen.get(row, object.idx())) {
                return Err(TableError::PartSeen { cell, object });
            }
        }
        Ok(())
    }

    fn check_objects(&self) -> Result<(), TableError> {
        for (index, ObjectRecord { min, max, .. }) in self.objects.iter().enumerate() {
            self.check_box(Item::Object, index, min, max)?;
        }
        let n_objects = self.objects.len();
        if !self.object_polygons.is_empty() && self.object_polygons.len() != n_objects {
            return Err(TableError::ObjectPolygons { n: self.object_polygons.len(), n_objects });
        }
        if !self.object_sources.is_empty() && self.object_sources.len() != n_objects {
            return Err(TableError::ObjectSources { n: self.object_sources.len(), n_objects });
        }
        let reserved = |source: &Option<ObjectSource>| source.is_some_and(|source| source.node == u32::MAX);
        if let Some(object) = self.object_sources.iter().position(reserved) {
            return Err(TableError::ObjectNode(ObjectId(object as u32)));
        }
        let (n, n_cells) = (self.cell_objects.len(), self.cells.len());
        if n != n_cells {
            return Err(TableError::CellObjects { n, n_cells });
        }
        for (cell, list) in (0u32..).map(CellId).zip(&self.cell_objects) {
            if !list.is_sorted_by(|a, b| a < b) {
                return Err(TableError::ObjectOrder(cell));
            }
            // The list ascends, so its last entry is the largest.
            if let Some(&object) = list.last().filter(|o| o.idx() >= self.objects.len()) {
                return Err(TableError::UnknownObject { cell, object });
            }
        }
        self.check_object_parts()
    }
}
