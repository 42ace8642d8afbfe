//! The whole file: conversion back to a table.

use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, MAX_TABLE, POLYGONS_KNOWN};
use crate::packed::{Packed, Places};
use crate::source::ByteSource;
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectParts, PortalId, SectionId, StabParts, StabTrees, Table,
    TableError, TableParts,
};

impl<S: ByteSource> Packed<S> {
    /// The whole table, checked as every table is; equal to the packed one if nothing was merged.
    /// O(size of the table), if kept blocks have room for a few blocks of each kind.
    ///
    /// # Errors
    /// If a block cannot be read, if the content is not a valid table, or if its rows take more than [`MAX_TABLE`]
    /// bytes.
    pub fn to_table(&self) -> Result<Table, PackedError> {
        let (n_cells, n_objects) = (self.n_cells(), self.n_objects());
        let rows = self.matrix(format::ROWS, n_cells, |cell, out| self.items(&self.rows, cell, out, |i| i))?;
        let mut parts = TableParts { rows, ..self.parts_without_rows()? };
        if let Some(seen) = &self.seen {
            parts.objects_seen =
                Some(self.matrix(format::SEEN, n_objects, |cell, out| self.items(seen, cell, out, |o| o))?);
        }
        if let (Some(of_objects), Some((all, rows))) = (&mut parts.object_parts, &self.parts) {
            of_objects.seen =
                self.matrix(format::PARTS_SEEN, all.len(), |cell, out| self.items(rows, cell, out, |p| p))?;
        }
        Table::new(parts).map_err(self.table_error(format::HEAD))
    }

    /// An error of the table, in a section.
    pub(crate) fn table_error(&self, id: SectionId) -> impl Fn(TableError) -> PackedError + use<S> {
        let offset = self.resident.find(id).map_or(0, |section| section.place.offset);
        move |error: TableError| PackedError::new(Some(id), offset, Kind::Table(error))
    }

    /// The whole table except for its rows of cells and of objects; not yet checked. O(size), without the rows.
    ///
    /// # Errors
    /// If a block cannot be read, or if the locator or the stab trees are no trees.
    pub fn parts_without_rows(&self) -> Result<TableParts, PackedError> {
        let n_cells = self.n_cells();
        let nodes = match &self.places {
            Places::Resident(places) => places.locator_nodes(&self.resident),
            Places::Paged(pages) => self.paged_locator_nodes(pages)?,
        };
        let locator = match &self.places {
            Places::Resident(_) => format::LOCATOR,
            Places::Paged(_) => format::LOCATOR_TOP,
        };
        let mut parts = TableParts {
            info: self.info().to_vec(),
            mirrors: self.mirrors().to_vec(),
            object_parts: self
                .parts
                .as_ref()
                .map(|(parts, _)| ObjectParts { parts: parts.clone(), seen: BitMatrix::default() }),
            object_sources: self.sources.of_objects.clone(),
            doors: self.doors().to_vec(),
            planes: self.planes().cloned(),
            locator: Locator::from_nodes(&nodes).map_err(|error| self.table_error(locator)(error.into()))?,
            up: self.up(),
            frame: self.frame().copied(),
            digest: self.digest(),
            ..TableParts::empty(self.dimension(), self.kind())
        };
        drop(nodes);
        for cell in (0..n_cells as u32).map(CellId) {
            let (min, max) = self.cell_box(cell)?;
            let mut polygon = Vec::new();
            self.cell_polygon(cell, &mut polygon)?;
            parts.cells.push(CellRecord { min, max, group: self.group(cell)?, polygon });
            let mut objects = Vec::new();
            self.objects_of(cell, &mut objects)?;
            parts.cell_objects.push(objects);
            parts.cell_names.extend(self.cell_name(cell)?);
        }
        for portal in 0..self.head.n_portals {
            parts.portals.push(self.portal(PortalId(portal))?);
        }
        let known = self.head.flags & POLYGONS_KNOWN != 0;
        for object in 0..self.head.n_objects {
            let (record, polygons) = self.object(ObjectId(object))?;
            parts.objects.push(record);
            parts.object_polygons.extend(known.then_some(polygons));
        }
        if let Some(n_nodes) = self.n_stab_nodes() {
            let stab = StabTrees::new(self.stab_parts(n_nodes)?, &parts.portals, n_cells);
            parts.stab = Some(stab.map_err(|error| self.table_error(format::STAB)(error.into()))?);
        }
        Ok(parts)
    }

    /// A matrix of cells by `n_columns`, from what `read` gives for each cell.
    fn matrix(
        &self,
        id: SectionId,
        n_columns: usize,
        read: impl Fn(CellId, &mut Vec<u32>) -> Result<(), PackedError>,
    ) -> Result<BitMatrix, PackedError> {
        let bytes = self.n_cells() as u64 * 8 * n_columns.div_ceil(64) as u64;
        if bytes > MAX_TABLE {
            return Err(PackedError::new(Some(id), 0, Kind::TooLarge { bytes }));
        }
        let mut matrix = BitMatrix::new(self.n_cells(), n_columns);
        let mut items = Vec::new();
        for cell in 0..self.n_cells() {
            read(CellId(cell as u32), &mut items)?;
            let row = matrix.row_mut(cell);
            items.iter().for_each(|&i| row[i as usize / 64] |= 1 << (i % 64));
        }
        Ok(matrix)
    }

    fn stab_parts(&self, n_nodes: u32) -> Result<StabParts, PackedError> {
        let mut parts = StabParts::default();
        let mut list = Vec::new();
        for node in 0..n_nodes {
            let crossed = self.stab_node(node, &mut list)?;
            parts.push_node(crossed.portal, crossed.forward, &list, crossed.open);
        }
        for cell in (0..self.n_cells() as u32).map(CellId) {
            let open = self.stab_roots(cell, &mut list)?;
            parts.push_cell(&list, open);
        }
        Ok(parts)
    }
}
