//! Point location in blocks.

use crate::bytes::{Origin, u32_at, u64_at};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, NONE};
use crate::locate::{NODE, for_each_leaf};
use crate::packed::Packed;
use crate::pages::{Page, Pages, box_at, corners};
use crate::source::ByteSource;
use sightlines_pvs::{CellId, LocatorNode, polygon_may_contain};

impl<S: ByteSource> Packed<S> {
    /// Puts the cells that a box with finite corners touches into `out`, in any order, perhaps repeated. If `is_point`, the
    /// polygons of cells decide too, else they are taken for their boxes, which finds more. `pending` is scratch space.
    ///
    /// # Errors
    /// If a page cannot be read.
    pub(crate) fn locate_in_pages(
        &self,
        pages: &Pages,
        (min, max): ([f64; 3], [f64; 3]),
        is_point: bool,
        pending: &mut Vec<u32>,
        out: &mut Vec<CellId>,
    ) -> Result<(), PackedError> {
        let mut result = Ok(());
        let top = &self.resident.bytes()[pages.nodes.clone()];
        for_each_leaf(top, min, max, pending, |pending, page, _| {
            if result.is_ok() {
                result = self.with_page(pages, page, |page| {
                    for_each_leaf(page.nodes, min, max, pending, |_, first, n| {
                        for k in (first..first + n).map(|entry| page.entry(entry)) {
                            let (low, high) = page.cell_box(k);
                            let touches = (0..3).all(|i| low[i] <= max[i] && min[i] <= high[i]);
                            if touches && (!is_point || polygon_may_contain(page.polygon(k), [min[0], min[1]])) {
                                out.push(page.cell(k));
                            }
                        }
                    });
                });
            }
        });
        result
    }

    fn with_page<T>(&self, pages: &Pages, page: usize, visit: impl FnOnce(Page<'_>) -> T) -> Result<T, PackedError> {
        let (d, n_cells) = (pages.d, pages.n_cells);
        let check = |bytes: &[u8], place: Origin| Page::check(bytes, place, d, n_cells);
        self.with_checked_record((format::PLACES, &pages.pages), page as u32, check, |bytes| {
            visit(Page::new(bytes, d).expect("the page was checked when it was read"))
        })
    }

    /// The box of a cell, which must exist, and its corners.
    pub(crate) fn paged_box(
        &self,
        pages: &Pages,
        cell: CellId,
        polygon: Option<&mut Vec<[f64; 2]>>,
    ) -> Result<([f64; 3], [f64; 3]), PackedError> {
        self.with_record((format::BOXES, &pages.boxes), cell.0, |mut r| {
            let bytes = r.take(16 * pages.d)?;
            if r.left() % 16 != 0 || (pages.d != 2 && r.left() > 0) {
                return Err(r.fail(Kind::Surplus { left: r.left() as u64 }));
            }
            if let Some(polygon) = polygon {
                polygon.extend(corners(r.take(r.left())?));
            }
            Ok(box_at(bytes, pages.d))
        })
    }

    /// The nodes of the locator, with all pages in their places.
    pub(crate) fn paged_locator_nodes(&self, pages: &Pages) -> Result<Vec<LocatorNode>, PackedError> {
        let top = &self.resident.bytes()[pages.nodes.clone()];
        let mut nodes = Vec::new();
        // Where each node of the top begins in the result.
        let mut begins = Vec::new();
        for node in top.chunks_exact(NODE) {
            begins.push(nodes.len() as u32);
            let (axis, second, rest) = (u32_at(node, 0), u32_at(node, 4), u64_at(node, 8));
            if axis != NONE {
                nodes.push(inner(nodes.len() as u32, axis, second, rest));
                continue;
            }
            let base = nodes.len() as u32;
            self.with_page(pages, rest as usize, |page| {
                for (i, node) in (0u32..).zip(page.nodes.chunks_exact(NODE)) {
                    let (axis, second, rest) = (u32_at(node, 0), u32_at(node, 4), u64_at(node, 8));
                    nodes.push(if axis == NONE {
                        let entries = rest as usize..rest as usize + second as usize;
                        LocatorNode::Leaf { cells: entries.map(|entry| page.cell(page.entry(entry))).collect() }
                    } else {
                        inner(base + i, axis, base + second, rest)
                    });
                }
            })?;
        }
        // High children of the top were numbers of its nodes.
        for (node, &begin) in top.chunks_exact(NODE).zip(&begins) {
            if let LocatorNode::Inner { high, .. } = &mut nodes[begin as usize]
                && u32_at(node, 0) != NONE
            {
                *high = begins[*high as usize];
            }
        }
        Ok(nodes)
    }

    /// Checks that the boxes and polygons in the pages are those of the cells. O(size of the pages).
    pub(crate) fn check_pages(&self, pages: &Pages) -> Result<(), PackedError> {
        let mut corners = Vec::new();
        for number in 0..pages.pages.n_records {
            let cells = self.with_page(pages, number as usize, |page| {
                let place = |k: usize| (page.cell(k), page.cell_box(k), page.polygon(k).collect::<Vec<_>>());
                (0..page.n_cells()).map(place).collect::<Vec<_>>()
            })?;
            for (cell, bounds, polygon) in cells {
                corners.clear();
                let own = self.paged_box(pages, cell, Some(&mut corners))?;
                if own != bounds || corners != polygon {
                    return Err(PackedError::new(Some(format::PLACES), 0, Kind::Page { page: number, cell }));
                }
            }
        }
        Ok(())
    }
}

fn inner(at: u32, axis: u32, high: u32, split: u64) -> LocatorNode {
    LocatorNode::Inner { axis: axis as u8, split: f64::from_bits(split), low: at + 1, high }
}
