//! Pages of the locator: the top of its tree is resident, and each page holds a subtree with its cells.

use crate::bytes::{Origin, f64_at, u32_at};
use crate::container::{ResidentPart, Section};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format;
use crate::index::{Index, StoreIndex};
use crate::locate::{NODE, check_tree};
use sightlines_pvs::CellId;
use std::ops::Range;

/// The resident part, and where the rest is.
#[derive(Debug)]
pub(crate) struct Pages {
    pub(crate) d: usize,
    pub(crate) n_cells: u32,
    /// The top of the locator in the resident part.
    pub(crate) nodes: Range<usize>,
    pub(crate) pages: StoreIndex,
    pub(crate) boxes: StoreIndex,
}

impl Pages {
    /// Checks the top of the locator. O(pages).
    pub(crate) fn read(resident: &ResidentPart, index: &Index, d: usize, n_cells: u32) -> Result<Self, PackedError> {
        let section = resident.need(format::LOCATOR_TOP)?;
        let Section { bytes, place } = section;
        if bytes.len() < 8 {
            return Err(place.fail(Kind::Cut));
        }
        let (n_nodes, n_pages) = (u32_at(bytes, 0), u32_at(bytes, 4));
        section.expect(8 + NODE as u64 * u64::from(n_nodes))?;
        check_tree(&bytes[8..], d, u64::from(n_pages), place, |_, second, _| match second {
            0 => Ok(1),
            value => Err(place.fail(Kind::Value { value: u64::from(value) })),
        })?;
        let start = resident.range(format::LOCATOR_TOP).map_or(0, |range| range.start) + 8;
        Ok(Self {
            d,
            n_cells,
            nodes: start..start + NODE * n_nodes as usize,
            pages: index.need_records(format::PLACES, n_pages)?,
            boxes: index.need_records(format::BOXES, n_cells)?,
        })
    }
}

/// A page, by the positions of its parts.
#[derive(Clone, Copy)]
pub(crate) struct Page<'a> {
    d: usize,
    pub(crate) nodes: &'a [u8],
    entries: &'a [u8],
    cells: &'a [u8],
    starts: &'a [u8],
    boxes: &'a [u8],
    corners: &'a [u8],
}

impl<'a> Page<'a> {
    /// `None` if the lengths do not fit.
    pub(crate) fn new(bytes: &'a [u8], d: usize) -> Option<Self> {
        let (counts, rest) = bytes.split_at_checked(16)?;
        let count = |k: usize| u32_at(counts, 4 * k) as usize;
        let (nodes, rest) = rest.split_at_checked(count(0).checked_mul(NODE)?)?;
        let (entries, rest) = rest.split_at_checked(count(1).checked_mul(4)?)?;
        let (cells, rest) = rest.split_at_checked(count(2).checked_mul(4)?)?;
        let (starts, rest) = rest.split_at_checked(cells.len() + 4)?;
        let (boxes, corners) = rest.split_at_checked(count(2).checked_mul(16 * d)?)?;
        let fits = corners.len() == count(3).checked_mul(16)?;
        fits.then_some(Self { d, nodes, entries, cells, starts, boxes, corners })
    }

    /// Checks that all positions in the page lie in it. O(bytes).
    pub(crate) fn check(bytes: &'a [u8], place: Origin, d: usize, n_cells: u32) -> Result<(), PackedError> {
        let page = Self::new(bytes, d).ok_or_else(|| place.fail(Kind::Cut))?;
        let wrong = |value: u32| place.fail(Kind::Value { value: u64::from(value) });
        check_tree(page.nodes, d, page.entries.len() as u64 / 4, place, |_, second, _| Ok(u64::from(second)))?;
        let numbers = |bytes: &'_ [u8]| bytes.chunks_exact(4).map(|bytes| u32_at(bytes, 0)).collect::<Vec<_>>();
        let (entries, cells, starts) = (numbers(page.entries), numbers(page.cells), numbers(page.starts));
        if let Some(&entry) = entries.iter().find(|entry| **entry as usize >= cells.len()) {
            return Err(wrong(entry));
        }
        if let Some(&cell) = cells.iter().find(|cell| **cell >= n_cells) {
            return Err(wrong(cell));
        }
        let n_corners = page.corners.len() / 16;
        match starts.last() {
            Some(&last) if starts[0] == 0 && starts.is_sorted() && last as usize == n_corners => Ok(()),
            last => Err(wrong(last.copied().unwrap_or(0))),
        }
    }

    pub(crate) fn n_cells(&self) -> usize {
        self.cells.len() / 4
    }

    #[inline]
    pub(crate) fn cell_box(&self, k: usize) -> ([f64; 3], [f64; 3]) {
        box_at(&self.boxes[16 * self.d * k..], self.d)
    }

    #[inline]
    pub(crate) fn polygon(&self, k: usize) -> impl ExactSizeIterator<Item = [f64; 2]> + use<'a> {
        let corner = |k: usize| 16 * u32_at(self.starts, 4 * k) as usize;
        corners(&self.corners[corner(k)..corner(k + 1)])
    }

    #[inline]
    pub(crate) fn cell(&self, k: usize) -> CellId {
        CellId(u32_at(self.cells, 4 * k))
    }

    #[inline]
    pub(crate) fn entry(&self, entry: usize) -> usize {
        u32_at(self.entries, 4 * entry) as usize
    }
}

/// The box that begins with these bytes.
#[inline]
pub(crate) fn box_at(bytes: &[u8], d: usize) -> ([f64; 3], [f64; 3]) {
    let corner = |k: usize| {
        let mut p = [0.0; 3];
        for (i, x) in p[..d].iter_mut().enumerate() {
            *x = f64_at(bytes, 8 * (d * k + i));
        }
        p
    };
    (corner(0), corner(1))
}

/// Corners, one after the other.
pub(crate) fn corners(bytes: &[u8]) -> impl ExactSizeIterator<Item = [f64; 2]> + use<'_> {
    bytes.chunks_exact(16).map(|c| [f64_at(c, 0), f64_at(c, 8)])
}
