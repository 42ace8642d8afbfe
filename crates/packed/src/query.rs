//! Queries about cells, objects and stab trees.

use crate::bytes::Reader;
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, POLYGONS_KNOWN};
use crate::packed::{Packed, Places};
use crate::source::ByteSource;
use sightlines_pvs::{
    CellId, DimensionError, ObjectId, ObjectPart, ObjectRecord, Place, PlaceBuffer, PlaneTree, PortalId, PortalRecord,
    TriangleRange, triangle_ranges,
};

/// Called by [`Packed::exits`] with the portal, whether it is crossed from its first cell into its second, the cell
/// that it leads to, and its corners.
pub type ExitVisitor<'a> = dyn FnMut(PortalId, bool, CellId, &[[f64; 3]]) + 'a;

/// A node of stab trees, without its children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StabNode {
    /// The portal that is crossed.
    pub portal: PortalId,
    /// Whether from its first cell into its second.
    pub forward: bool,
    /// Whether the tree was cut here: any sequence may follow.
    pub open: bool,
}

/// A packed table in `D` dimensions, 2 or 3: [`Packed::in_dimension`].
#[derive(Debug, Clone, Copy)]
pub struct PackedQuery<'a, S: ByteSource, const D: usize> {
    packed: &'a Packed<S>,
}

impl<S: ByteSource, const D: usize> PackedQuery<'_, S, D> {
    /// The cells that may contain a point (scene units), ascending: the same as [`sightlines_pvs::Query::at`]. Allocates nothing
    /// once `buffer` is warm. Of a small file, reads nothing from the source; of a large one one block, or a few for a point on
    /// the border between pages of the locator.
    ///
    /// # Errors
    /// Of a large file, if a block cannot be read; of a small one there are none.
    pub fn cells_at<'b>(&self, p: [f64; D], buffer: &'b mut PlaceBuffer) -> Result<Place<&'b [CellId]>, PackedError> {
        self.packed.cells_at(std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0)), buffer)
    }
}

impl<S: ByteSource> Packed<S> {
    /// The box around a cell, in scene units, along the [frame](Self::frame) if there is one; z is 0 in a plane.
    ///
    /// # Errors
    /// If there is no such cell, or, of a large file, if its block cannot be read.
    pub fn cell_box(&self, cell: CellId) -> Result<([f64; 3], [f64; 3]), PackedError> {
        self.check_cell(cell)?;
        match &self.places {
            Places::Resident(places) => Ok(places.cell_box(&self.resident, cell.idx())),
            Places::Paged(pages) => self.paged_box(pages, cell, None),
        }
    }

    /// Puts the corners of a cell into `out`, which is cleared; none if the cell is its box.
    ///
    /// # Errors
    /// As [`Packed::cell_box`].
    pub fn cell_polygon(&self, cell: CellId, out: &mut Vec<[f64; 2]>) -> Result<(), PackedError> {
        out.clear();
        self.check_cell(cell)?;
        match &self.places {
            Places::Resident(places) => out.extend(places.polygon(&self.resident, cell.idx())),
            Places::Paged(pages) => drop(self.paged_box(pages, cell, Some(out))?),
        }
        Ok(())
    }

    /// The plane tree that locates points in place of the cells' boxes, if there is one.
    pub fn planes(&self) -> Option<&PlaneTree> {
        self.planes.as_ref()
    }

    /// The packed table for points of `D` coordinates, 2 or 3, checked once.
    ///
    /// # Errors
    /// [`DimensionError`] if the table has another dimension.
    pub fn in_dimension<const D: usize>(&self) -> Result<PackedQuery<'_, S, D>, DimensionError> {
        if usize::from(self.dimension()) == D {
            Ok(PackedQuery { packed: self })
        } else {
            Err(DimensionError { table: self.dimension(), points: D })
        }
    }

    /// As [`PackedQuery::cells_at`], for code that serves both dimensions: in a plane the third coordinate does not count.
    ///
    /// # Errors
    /// As [`PackedQuery::cells_at`].
    pub fn cells_at<'b>(&self, p: [f64; 3], buffer: &'b mut PlaceBuffer) -> Result<Place<&'b [CellId]>, PackedError> {
        let p = if self.dimension() == 2 { [p[0], p[1], 0.0] } else { p };
        if !self.has_places() || !p.iter().all(|x| x.is_finite()) {
            return Ok(Place::Outside);
        }
        let around = self.frame().map(|frame| frame.around(p, p));
        let mut result = Ok(());
        let place = buffer.fill(|pending, found| match (&self.planes, &self.places, around) {
            (Some(planes), _, None) => planes.for_each_cell(p, pending, |cell| found.push(cell)),
            (Some(planes), _, Some((min, max))) => {
                planes.for_each_cell_of_box(min, max, pending, &mut |cell| {
                    found.push(cell);
                    true
                });
            }
            (None, Places::Resident(places), None) => places.locate(&self.resident, p, pending, found),
            (None, Places::Resident(places), Some((min, max))) => {
                places.locate_box(&self.resident, min, max, pending, found);
            }
            (None, Places::Paged(pages), _) => {
                result = self.locate_in_pages(pages, around.unwrap_or((p, p)), around.is_none(), pending, found);
            }
        });
        result.map(|()| place)
    }

    /// Puts the cells that `cell` may see, itself included, into `out`, which is cleared, ascending.
    ///
    /// # Errors
    /// If there is no such cell, or its block cannot be read.
    pub fn visible(&self, cell: CellId, out: &mut Vec<CellId>) -> Result<(), PackedError> {
        self.items(&self.rows, cell, out, CellId)
    }

    /// Puts the objects that `cell` may see into `out`, which is cleared, ascending.
    ///
    /// Without own rows of objects these are the objects of all cells that it sees, and the blocks of all
    /// of them are read.
    ///
    /// # Errors
    /// If there is no such cell, or a block cannot be read.
    pub fn objects_seen(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), PackedError> {
        if let Some(seen) = &self.seen {
            return self.items(seen, cell, out, ObjectId);
        }
        out.clear();
        let mut cells = Vec::new();
        self.visible(cell, &mut cells)?;
        let mut set = vec![0u64; if cells.is_empty() { 0 } else { self.n_objects().div_ceil(64) }];
        for cell in cells {
            self.for_each_object(cell, |object| set[object.idx() / 64] |= 1 << (object.0 % 64))?;
        }
        out.extend(sightlines_pvs::bits::ones(&set).map(|object| ObjectId(object as u32)));
        Ok(())
    }

    /// The parts of objects, as [`sightlines_pvs::Table::object_parts`].
    pub fn object_parts(&self) -> &[ObjectPart] {
        self.parts.as_ref().map_or(&[], |(parts, _)| parts)
    }

    /// Puts the triangles that `cell` may see into `out`, which is cleared: as [`sightlines_pvs::Table::visible_ranges`].
    ///
    /// # Errors
    /// As [`Packed::objects_seen`].
    pub fn visible_ranges(&self, cell: CellId, out: &mut Vec<TriangleRange>) -> Result<(), PackedError> {
        out.clear();
        let (mut objects, mut parts): (Vec<ObjectId>, Vec<usize>) = (Vec::new(), Vec::new());
        self.objects_seen(cell, &mut objects)?;
        if let Some((_, rows)) = &self.parts {
            self.items(rows, cell, &mut parts, |part| part as usize)?;
        }
        *out = triangle_ranges(self.object_parts(), &objects, parts);
        Ok(())
    }

    /// Puts the objects that touch a cell into `out`, which is cleared, ascending.
    ///
    /// # Errors
    /// If there is no such cell, or its block cannot be read.
    pub fn objects_of(&self, cell: CellId, out: &mut Vec<ObjectId>) -> Result<(), PackedError> {
        out.clear();
        self.check_cell(cell)?;
        self.for_each_object(cell, |object| out.push(object))
    }

    fn for_each_object(&self, cell: CellId, mut visit: impl FnMut(ObjectId)) -> Result<(), PackedError> {
        self.with_record((format::CELLS, &self.cells), cell.0, |mut r| {
            r.varint()?;
            self.for_each_exit(&mut r, |_, _, _| Ok(()))?;
            r.ascending(u64::from(self.head.n_objects), |object| visit(ObjectId(object)))
        })
    }

    /// The group of a cell, such as a Doom sector.
    ///
    /// # Errors
    /// If there is no such cell, or its block cannot be read.
    pub fn group(&self, cell: CellId) -> Result<Option<u32>, PackedError> {
        self.check_cell(cell)?;
        self.with_record((format::CELLS, &self.cells), cell.0, |mut r| {
            let group = r.varint()?;
            match group.checked_sub(1).map(u32::try_from) {
                None => Ok(None),
                Some(Ok(group)) => Ok(Some(group)),
                Some(Err(_)) => Err(r.fail(Kind::Value { value: group })),
            }
        })
    }

    /// The name of a cell for users; `None` if the cells of the table have no names.
    ///
    /// # Errors
    /// If there is no such cell, its block cannot be read, or the name is not UTF-8.
    pub fn cell_name(&self, cell: CellId) -> Result<Option<String>, PackedError> {
        self.check_cell(cell)?;
        let Some(store) = &self.names else { return Ok(None) };
        self.with_record((format::CELL_NAMES, store), cell.0, |mut r| {
            let name = r.take(r.left())?;
            let name = std::str::from_utf8(name).map_err(|_| r.fail(Kind::Text))?;
            Ok(Some(name.to_owned()))
        })
    }

    /// Whether the table has names of cells ([`Packed::cell_name`]). Reads nothing.
    pub fn has_cell_names(&self) -> bool {
        self.names.is_some()
    }

    /// Reads the exits of a cell: portal, whether it leads forward, to-cell.
    fn for_each_exit(
        &self,
        r: &mut Reader<'_>,
        mut visit: impl FnMut(PortalId, bool, CellId) -> Result<(), PackedError>,
    ) -> Result<(), PackedError> {
        for _ in 0..r.count(2)? {
            let (gate, to) = (r.varint()?, r.below(u64::from(self.head.n_cells))?);
            if gate / 2 >= u64::from(self.head.n_portals) {
                return Err(r.fail(Kind::Value { value: gate }));
            }
            visit(PortalId((gate / 2) as u32), gate % 2 == 0, CellId(to))?;
        }
        Ok(())
    }

    /// Calls `visit` for each way out of a cell: the portal, whether it is crossed from its first cell into
    /// its second, the cell it leads to, and its corners as [`PortalRecord::points`], that is, as seen from
    /// its first cell whatever the direction.
    ///
    /// # Errors
    /// If there is no such cell, or a block cannot be read; then some exits may have been visited.
    pub fn exits(&self, cell: CellId, visit: &mut ExitVisitor<'_>) -> Result<(), PackedError> {
        self.check_cell(cell)?;
        let mut points = Vec::new();
        self.with_record((format::CELLS, &self.cells), cell.0, |mut r| {
            r.varint()?;
            self.for_each_exit(&mut r, |portal, forward, to| {
                self.read_portal(portal, &mut points)?;
                visit(portal, forward, to, &points);
                Ok(())
            })
        })
    }

    /// A portal.
    ///
    /// # Errors
    /// If there is no such portal, or its block cannot be read.
    pub fn portal(&self, portal: PortalId) -> Result<PortalRecord, PackedError> {
        let n_portals = self.head.n_portals;
        if portal.0 >= n_portals {
            return Err(PackedError::asked(Kind::NoPortal { portal, n_portals }));
        }
        let mut points = Vec::new();
        let [a, b, s, t] = self.read_portal(portal, &mut points)?;
        Ok(PortalRecord { cells: [CellId(a), CellId(b)], sides: [s, t], points })
    }

    /// Puts the corners into `points`; returns the cells and sides of the portal.
    fn read_portal(&self, portal: PortalId, points: &mut Vec<[f64; 3]>) -> Result<[u32; 4], PackedError> {
        let d = usize::from(self.head.dimension);
        self.with_record((format::PORTALS, &self.portals), portal.0, |mut r| {
            let mut ids = [0; 4];
            for (k, id) in ids.iter_mut().enumerate() {
                *id = r.below(if k < 2 { u64::from(self.head.n_cells) } else { 1 << 32 })?;
            }
            points.clear();
            for _ in 0..r.count(8 * d)? {
                points.push(r.point(d)?);
            }
            r.finish()?;
            Ok(ids)
        })
    }

    fn with_object<T>(
        &self,
        object: ObjectId,
        visit: impl FnOnce(&mut Reader<'_>) -> Result<T, PackedError>,
    ) -> Result<T, PackedError> {
        let n_objects = self.head.n_objects;
        if object.0 >= n_objects {
            return Err(PackedError::asked(Kind::NoObject { object, n_objects }));
        }
        self.with_record((format::OBJECTS, &self.objects), object.0, |mut r| visit(&mut r))
    }

    /// The box around an object, in scene units, along the [frame](Self::frame) if there is one; z is 0 in a plane.
    ///
    /// # Errors
    /// If there is no such object, or its block cannot be read.
    pub fn object_box(&self, object: ObjectId) -> Result<([f64; 3], [f64; 3]), PackedError> {
        let d = usize::from(self.head.dimension);
        self.with_object(object, |r| Ok((r.point(d)?, r.point(d)?)))
    }

    /// The name of an object.
    ///
    /// # Errors
    /// As [`Packed::object_box`].
    pub fn object_name(&self, object: ObjectId) -> Result<String, PackedError> {
        Ok(self.object(object)?.0.name)
    }

    /// The number of polygons of an object; 1 if it is unknown.
    ///
    /// # Errors
    /// As [`Packed::object_box`].
    pub fn object_polygons(&self, object: ObjectId) -> Result<u32, PackedError> {
        let polygons = self.object(object)?.1;
        Ok(if self.head.flags & POLYGONS_KNOWN == 0 { 1 } else { polygons })
    }

    pub(crate) fn object(&self, object: ObjectId) -> Result<(ObjectRecord, u32), PackedError> {
        let d = usize::from(self.head.dimension);
        self.with_object(object, |r| {
            let (min, max, polygons) = (r.point(d)?, r.point(d)?, r.below(1 << 32)?);
            let name = r.take(r.left())?;
            let name = std::str::from_utf8(name).map_err(|_| r.fail(Kind::Text))?.to_owned();
            Ok((ObjectRecord { name, min, max }, polygons))
        })
    }

    /// Number of nodes of all stab trees, if there are any; see [`sightlines_pvs::StabTrees`].
    pub fn n_stab_nodes(&self) -> Option<u32> {
        self.head.n_nodes
    }

    /// Puts the nodes that begin the sequences out of a cell into `out`, which is cleared, ascending. Returns whether
    /// the tree was cut at its root, so that any sequence may be visible; `true` without stab trees.
    ///
    /// # Errors
    /// If there is no such cell, or its block cannot be read.
    pub fn stab_roots(&self, cell: CellId, out: &mut Vec<u32>) -> Result<bool, PackedError> {
        out.clear();
        self.check_cell(cell)?;
        let Some(n_nodes) = self.head.n_nodes else { return Ok(true) };
        self.with_record((format::CELLS, &self.cells), cell.0, |mut r| {
            r.varint()?;
            self.for_each_exit(&mut r, |_, _, _| Ok(()))?;
            r.ascending(u64::from(self.head.n_objects), |_| {})?;
            let open = r.below(2)? == 1;
            r.ascending(u64::from(n_nodes), |node| out.push(node))?;
            r.finish()?;
            Ok(open)
        })
    }

    /// A node of the stab trees; puts the gates that may follow it into `children`, which is cleared, ascending.
    ///
    /// # Errors
    /// If there is no such node, or its block cannot be read.
    pub fn stab_node(&self, node: u32, children: &mut Vec<u32>) -> Result<StabNode, PackedError> {
        children.clear();
        let n_nodes = self.head.n_nodes.unwrap_or(0);
        let Some(store) = self.nodes.as_ref().filter(|_| node < n_nodes) else {
            return Err(PackedError::asked(Kind::NoNode { node, n_nodes }));
        };
        self.with_record((format::STAB, store), node, |mut r| {
            let (gate, n) = (r.varint()?, r.varint()?);
            if gate / 2 >= u64::from(self.head.n_portals) || n / 2 > r.left() as u64 {
                return Err(r.fail(Kind::Value { value: gate }));
            }
            let mut above = u64::from(node);
            for _ in 0..n / 2 {
                let down = r.varint()?;
                let child = above.checked_sub(1).and_then(|above| above.checked_sub(down));
                above = child.ok_or_else(|| r.fail(Kind::Value { value: down }))?;
                children.push(above as u32);
            }
            r.finish()?;
            children.reverse();
            Ok(StabNode { portal: PortalId((gate / 2) as u32), forward: gate % 2 == 0, open: n % 2 == 1 })
        })
    }
}
