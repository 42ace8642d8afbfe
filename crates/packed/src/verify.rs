//! The check of the entire content of a file.

use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format;
use crate::index::StoreIndex;
use crate::masks;
use crate::packed::{Packed, Places};
use crate::rows::Rows;
use crate::source::ByteSource;
use sightlines_pvs::{BitMatrix, CellId, PortalId, SectionId, TableError, TableParts};
use std::ops::Range;

/// Bytes of rows of a large file that [`Packed::verify`] has in memory at once.
const BAND_BYTES: usize = 64 << 20;

impl<S: ByteSource> Packed<S> {
    /// Checks the entire content: every block, that it is a valid table, that the exits of cells are its portals, that pages
    /// of the locator agree with the cells, and that the coarse table agrees with the rows. O(size of the table).
    ///
    /// Of a small file the whole table is in memory. Of a large one its rows never are: see [`Packed::verify_within`].
    ///
    /// # Errors
    /// As [`Packed::to_table`], or any other defect.
    pub fn verify(&self) -> Result<(), PackedError> {
        self.verify_within(BAND_BYTES)
    }

    /// As [`Packed::verify`], with about `bytes` of the rows of a large file in memory at once, at least one row; the other
    /// parts are in memory as a whole. Rows are symmetric if each band of them equals its columns, for which those rows are
    /// read again that see the band by the coarse table: O(size), times the bands that an average row sees.
    ///
    /// # Errors
    /// As [`Packed::verify`].
    pub fn verify_within(&self, bytes: usize) -> Result<(), PackedError> {
        if let (Rows::Masks { store, .. }, Places::Paged(pages)) = (&self.rows, &self.places) {
            let parts = self.parts_without_rows()?;
            parts.check_without_rows().map_err(self.table_error(format::HEAD))?;
            self.check_exits(&parts)?;
            self.check_pages(pages)?;
            self.check_rows_of_objects(&parts)?;
            self.check_parts_seen()?;
            drop(parts);
            self.check_rows_and_coarse(store)?;
            return self.check_symmetry(store, bytes / 4);
        }
        let table = self.to_table()?;
        let page = self.head.page as usize;
        let n_pages = self.head.n_pages();
        let mut pages = BitMatrix::new(n_pages, n_pages);
        for cell in (0..table.n_cells() as u32).map(CellId) {
            table.visible(cell).for_each(|other| pages.set(cell.idx() / page, other.idx() / page, true));
        }
        self.check_coarse(&pages)?;
        self.check_exits(table.parts())
    }

    fn check_coarse(&self, pages: &BitMatrix) -> Result<(), PackedError> {
        let n_pages = pages.n_rows();
        match (0..n_pages).find(|&p| (0..n_pages).any(|q| pages.get(p, q) != self.page_sees(p, q))) {
            Some(p) => Err(PackedError::new(Some(format::COARSE), 0, Kind::Coarse { page: p as u32 })),
            None => Ok(()),
        }
    }

    fn check_exits(&self, parts: &TableParts) -> Result<(), PackedError> {
        let mut exits: Vec<Vec<(PortalId, bool, CellId)>> = vec![Vec::new(); parts.cells.len()];
        for (portal, record) in (0u32..).map(PortalId).zip(&parts.portals) {
            let [a, b] = record.cells;
            exits[a.idx()].push((portal, true, b));
            exits[b.idx()].push((portal, false, a));
        }
        for (cell, expected) in (0u32..).map(CellId).zip(&exits) {
            let mut found = Vec::new();
            self.exits(cell, &mut |portal, forward, to, _| found.push((portal, forward, to)))?;
            if found != *expected {
                return Err(PackedError::new(Some(format::CELLS), 0, Kind::Exits { cell }));
            }
        }
        Ok(())
    }

    /// Whether each row of objects has the objects that touch its cell.
    fn check_rows_of_objects(&self, parts: &TableParts) -> Result<(), PackedError> {
        let Some(Rows::Masks { id, store, n_items }) = &self.seen else { return Ok(()) };
        let mut unseen = None;
        self.for_each_row(*id, store, *n_items, 0..self.head.n_cells, |cell, objects| {
            let touching = &parts.cell_objects[cell as usize];
            let missing = touching.iter().find(|object| objects.binary_search(&object.0).is_err());
            unseen = missing.map(|&object| TableError::Unseen { cell: CellId(cell), object });
            unseen.is_none()
        })?;
        unseen.map_or(Ok(()), |error| Err(self.table_error(*id)(error)))
    }

    /// Whether each cell sees the objects of which it sees a part.
    fn check_parts_seen(&self) -> Result<(), PackedError> {
        let Some((parts, rows)) = &self.parts else { return Ok(()) };
        let wrong = self.table_error(format::PARTS_SEEN);
        if self.seen.is_none() {
            return Err(wrong(TableError::PartsAlone));
        }
        let (mut seen, mut objects) = (Vec::new(), Vec::new());
        for cell in (0..self.head.n_cells).map(CellId) {
            self.items(rows, cell, &mut seen, |part| parts[part as usize].object)?;
            self.objects_seen(cell, &mut objects)?;
            if let Some(&object) = seen.iter().find(|object| objects.binary_search(object).is_err()) {
                return Err(wrong(TableError::PartSeen { cell, object }));
            }
        }
        Ok(())
    }

    /// Whether each cell sees itself, and the coarse table is that of the rows.
    fn check_rows_and_coarse(&self, store: &StoreIndex) -> Result<(), PackedError> {
        let (page, n_pages) = (self.head.page, self.head.n_pages());
        let mut pages = BitMatrix::new(n_pages, n_pages);
        let mut blind = None;
        self.for_each_row(format::ROWS, store, self.head.n_cells, 0..self.head.n_cells, |cell, row| {
            if row.binary_search(&cell).is_err() {
                blind = Some(TableError::NotReflexive(CellId(cell)));
            }
            row.iter().for_each(|other| pages.set((cell / page) as usize, (other / page) as usize, true));
            blind.is_none()
        })?;
        blind.map_or(Ok(()), |error| Err(self.table_error(format::ROWS)(error)))?;
        self.check_coarse(&pages)
    }

    /// Whether rows equal columns, with about `max_items` entries of rows in memory. The coarse table must agree with the rows.
    fn check_symmetry(&self, store: &StoreIndex, max_items: usize) -> Result<(), PackedError> {
        let (n_cells, page, n_pages) = (self.head.n_cells, self.head.page, self.head.n_pages());
        let mut begin = 0;
        while begin < n_cells {
            let (mut items, mut starts) = (Vec::new(), vec![0]);
            self.for_each_row(format::ROWS, store, n_cells, begin..n_cells, |_, row| {
                items.extend_from_slice(row);
                starts.push(items.len());
                items.len() < max_items
            })?;
            let end = begin + starts.len() as u32 - 1;
            let mut next = starts[..starts.len() - 1].to_vec();
            let mut one_sided = None;
            let band = (begin / page) as usize..=((end - 1) / page) as usize;
            for q in (0..n_pages).filter(|&q| band.clone().any(|p| self.page_sees(q, p))) {
                let first = q as u32 * page;
                let cells = first..n_cells.min(first.saturating_add(page));
                self.for_each_row(format::ROWS, store, n_cells, cells, |other, row| {
                    let in_band = row.partition_point(|&cell| cell < begin)..row.partition_point(|&cell| cell < end);
                    for &cell in &row[in_band] {
                        let k = (cell - begin) as usize;
                        let expected = items[next[k]..starts[k + 1]].first().copied();
                        if expected != Some(other) {
                            // The first of both that the other does not have.
                            one_sided = Some((expected.unwrap_or(other).min(other), cell));
                            break;
                        }
                        next[k] += 1;
                    }
                    one_sided.is_none()
                })?;
                if one_sided.is_some() {
                    break;
                }
            }
            let unmet = || {
                let k = (0..next.len()).find(|&k| next[k] < starts[k + 1])?;
                Some((begin + k as u32, items[next[k]]))
            };
            if let Some((a, b)) = one_sided.or_else(unmet) {
                return Err(self.table_error(format::ROWS)(TableError::NotSymmetric([a, b].map(CellId))));
            }
            begin = end;
        }
        Ok(())
    }

    /// Calls `visit` with the rows of cells in turn, until it returns `false`; each block is read once, and none is kept.
    fn for_each_row(
        &self,
        id: SectionId,
        store: &StoreIndex,
        n_items: u32,
        cells: Range<u32>,
        mut visit: impl FnMut(u32, &[u32]) -> bool,
    ) -> Result<(), PackedError> {
        let mut items = Vec::new();
        self.for_each_record((id, store), cells, |cell, mut r| {
            items.clear();
            masks::decode(&mut r, n_items, |item| items.push(item))?;
            Ok(visit(cell, &items))
        })
    }
}
