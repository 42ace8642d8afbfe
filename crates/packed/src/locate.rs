//! Point location in the bytes of the resident part.

use crate::bytes::{Origin, Reader, f64_at, u32_at, u64_at};
use crate::container::{ResidentPart, Section};
use crate::error::{PackedError, PackedErrorKind as Kind};
use crate::format::{self, NONE};
use sightlines_pvs::{CellId, Locator, LocatorNode, PlaneChild, PlaneNode, PlaneTree, polygon_may_contain};
use std::ops::Range;

/// Bytes of a node of the locator.
pub(crate) const NODE: usize = 16;

/// Boxes, polygons and locator, by their positions in the resident part.
#[derive(Debug)]
pub(crate) struct PointLocation {
    d: usize,
    boxes: Range<usize>,
    /// The numbers of corners before each cell, then the corners.
    polygons: Option<(Range<usize>, Range<usize>)>,
    nodes: Range<usize>,
    entries: Range<usize>,
}

impl PointLocation {
    /// Checks the sections: sizes, that the locator is a tree, that its cells exist. O(bytes).
    ///
    /// Whether the locator misses a cell is checked by [`crate::Packed::verify`].
    pub(crate) fn read(resident: &ResidentPart, d: usize, n_cells: u32) -> Result<Self, PackedError> {
        resident.need(format::BOXES)?.expect(16 * d as u64 * u64::from(n_cells))?;
        let polygons = resident.find(format::POLYGONS).map(|section| polygons(section, d, n_cells)).transpose()?;
        let (n_nodes, n_entries) = check_locator(resident.need(format::LOCATOR)?, d, n_cells)?;
        let start = |id| resident.range(id).map_or(0, |range| range.start);
        let at = start(format::LOCATOR) + 8;
        let nodes = at..at + NODE * n_nodes;
        let at_polygons = start(format::POLYGONS);
        Ok(Self {
            d,
            boxes: resident.range(format::BOXES).unwrap_or_default(),
            polygons: polygons.map(|n| {
                let middle = at_polygons + 4 * (n_cells as usize + 1);
                (at_polygons..middle, middle..middle + 16 * n)
            }),
            entries: nodes.end..nodes.end + 4 * n_entries,
            nodes,
        })
    }

    /// The box of a cell, which must exist.
    #[inline]
    pub(crate) fn cell_box(&self, resident: &ResidentPart, cell: usize) -> ([f64; 3], [f64; 3]) {
        let bytes = &resident.bytes()[self.boxes.clone()];
        let at = 16 * self.d * cell;
        let corner = |k: usize| {
            let mut p = [0.0; 3];
            for (i, x) in p[..self.d].iter_mut().enumerate() {
                *x = f64_at(bytes, at + 8 * (self.d * k + i));
            }
            p
        };
        (corner(0), corner(1))
    }

    /// The corners of a cell, which must exist; none if the cell is its box.
    #[inline]
    pub(crate) fn polygon<'a>(
        &self,
        resident: &'a ResidentPart,
        cell: usize,
    ) -> impl ExactSizeIterator<Item = [f64; 2]> + use<'a> {
        let range = self.polygons.as_ref().map_or(0..0, |(starts, corners)| {
            let starts = &resident.bytes()[starts.clone()];
            let corner = |cell: usize| corners.start + 16 * u32_at(starts, 4 * cell) as usize;
            corner(cell)..corner(cell + 1)
        });
        resident.bytes()[range].chunks_exact(16).map(|c| [f64_at(c, 0), f64_at(c, 8)])
    }

    /// Puts the cells at a point with finite coordinates into `out`, in any order, perhaps repeated. `pending` is
    /// scratch space.
    pub(crate) fn locate(&self, resident: &ResidentPart, p: [f64; 3], pending: &mut Vec<u32>, out: &mut Vec<CellId>) {
        self.for_each_candidate(resident, p, p, pending, |cell| {
            let (min, max) = self.cell_box(resident, cell.idx());
            let in_box = (0..3).all(|k| min[k] <= p[k] && p[k] <= max[k]);
            if in_box && polygon_may_contain(self.polygon(resident, cell.idx()), [p[0], p[1]]) {
                out.push(cell);
            }
        });
    }

    /// Puts the cells that a box with finite corners touches into `out`, as [`PointLocation::locate`] does; polygons of cells are
    /// taken for their boxes, which finds more.
    pub(crate) fn locate_box(
        &self,
        resident: &ResidentPart,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        out: &mut Vec<CellId>,
    ) {
        self.for_each_candidate(resident, min, max, pending, |cell| {
            let (low, high) = self.cell_box(resident, cell.idx());
            if (0..3).all(|k| low[k] <= max[k] && min[k] <= high[k]) {
                out.push(cell);
            }
        });
    }

    fn node(&self, resident: &ResidentPart, node: usize) -> (u32, u32, u64) {
        let bytes = &resident.bytes()[self.nodes.clone()];
        (u32_at(bytes, NODE * node), u32_at(bytes, NODE * node + 4), u64_at(bytes, NODE * node + 8))
    }

    fn entry(&self, resident: &ResidentPart, entry: usize) -> CellId {
        CellId(u32_at(&resident.bytes()[self.entries.clone()], 4 * entry))
    }

    fn for_each_candidate(
        &self,
        resident: &ResidentPart,
        min: [f64; 3],
        max: [f64; 3],
        pending: &mut Vec<u32>,
        mut visit: impl FnMut(CellId),
    ) {
        let nodes = &resident.bytes()[self.nodes.clone()];
        for_each_leaf(nodes, min, max, pending, |_, first, n| {
            (first..first + n).for_each(|entry| visit(self.entry(resident, entry)));
        });
    }

    /// The nodes of the locator.
    pub(crate) fn locator_nodes(&self, resident: &ResidentPart) -> Vec<LocatorNode> {
        let node = |i: usize| {
            let (axis, second, rest) = self.node(resident, i);
            if axis == NONE {
                let entries = rest as usize..rest as usize + second as usize;
                LocatorNode::Leaf { cells: entries.map(|entry| self.entry(resident, entry)).collect() }
            } else {
                LocatorNode::Inner { axis: axis as u8, split: f64::from_bits(rest), low: i as u32 + 1, high: second }
            }
        };
        (0..self.nodes.len() / NODE).map(node).collect()
    }
}

/// Calls `visit` with each leaf whose closed region meets a closed box: the scratch space, and the leaf's fields. The
/// nodes must have been checked. `pending` is scratch space: what is in it stays.
#[inline]
pub(crate) fn for_each_leaf(
    nodes: &[u8],
    min: [f64; 3],
    max: [f64; 3],
    pending: &mut Vec<u32>,
    mut visit: impl FnMut(&mut Vec<u32>, usize, usize),
) {
    let mut at = 0;
    let below = pending.len();
    loop {
        let (axis, second, rest) =
            (u32_at(nodes, NODE * at), u32_at(nodes, NODE * at + 4), u64_at(nodes, NODE * at + 8));
        if axis == NONE {
            visit(pending, rest as usize, second as usize);
            if pending.len() == below {
                return;
            }
            at = pending.pop().map_or(0, |next| next as usize);
            continue;
        }
        let (low, high, split) = (min[axis as usize], max[axis as usize], f64::from_bits(rest));
        if low > split {
            at = second as usize;
        } else {
            // On the split, both children count.
            if high >= split {
                pending.push(second);
            }
            at += 1;
        }
    }
}

/// Checks `POLY`; returns the number of corners.
fn polygons(section: Section<'_>, d: usize, n_cells: u32) -> Result<usize, PackedError> {
    let Section { bytes, place } = section;
    let n_starts = n_cells as usize + 1;
    if d != 2 || bytes.len() < 4 * n_starts {
        return Err(place.fail(Kind::Cut));
    }
    let mut last = 0;
    for start in bytes[..4 * n_starts].chunks_exact(4).map(|start| u32_at(start, 0)) {
        if start < last {
            return Err(place.fail(Kind::Value { value: u64::from(start) }));
        }
        last = start;
    }
    if u32_at(bytes, 0) != 0 {
        return Err(place.fail(Kind::Value { value: u64::from(u32_at(bytes, 0)) }));
    }
    section.expect(4 * n_starts as u64 + 16 * u64::from(last))?;
    Ok(last as usize)
}

/// Checks that `LOCA` is a tree in preorder over cells; returns the numbers of nodes and entries.
fn check_locator(section: Section<'_>, d: usize, n_cells: u32) -> Result<(usize, usize), PackedError> {
    let Section { bytes, place } = section;
    if bytes.len() < 8 {
        return Err(place.fail(Kind::Cut));
    }
    let (n_nodes, n_entries) = (u32_at(bytes, 0), u32_at(bytes, 4));
    section.expect(8 + NODE as u64 * u64::from(n_nodes) + 4 * u64::from(n_entries))?;
    let (nodes, entries) = bytes[8..].split_at(NODE * n_nodes as usize);
    check_tree(nodes, d, u64::from(n_entries), place, |_, second, _| Ok(u64::from(second)))?;
    match entries.chunks_exact(4).map(|entry| u32_at(entry, 0)).find(|&cell| cell >= n_cells) {
        Some(cell) => Err(place.fail(Kind::Value { value: u64::from(cell) })),
        None => Ok((n_nodes as usize, n_entries as usize)),
    }
}

/// Checks that nodes are a tree in preorder whose leaves list `n_listed` entries, one after the other; `entries_of`
/// gives the number of entries of a leaf from its second field.
pub(crate) fn check_tree(
    nodes: &[u8],
    d: usize,
    n_listed: u64,
    place: Origin,
    entries_of: impl Fn(usize, u32, u64) -> Result<u64, PackedError>,
) -> Result<(), PackedError> {
    let wrong = |value: u64| place.fail(Kind::Value { value });
    // High children still to come; a leaf ends the subtree before the last of them.
    let mut highs: Vec<u32> = Vec::new();
    let (mut listed, mut done) = (0u64, false);
    for (i, node) in (0u64..).zip(nodes.chunks_exact(NODE)) {
        if done {
            return Err(wrong(i));
        }
        let (axis, second, rest) = (u32_at(node, 0), u32_at(node, 4), u64_at(node, 8));
        if axis == NONE {
            if rest != listed {
                return Err(wrong(rest));
            }
            listed += entries_of(i as usize, second, rest)?;
            match highs.pop() {
                Some(high) if u64::from(high) == i + 1 => {}
                Some(high) => return Err(wrong(u64::from(high))),
                None => done = true,
            }
        } else {
            if axis as usize >= d || highs.len() >= Locator::MAX_DEPTH || !f64::from_bits(rest).is_finite() {
                return Err(wrong(u64::from(axis)));
            }
            highs.push(second);
        }
    }
    if done && listed == n_listed { Ok(()) } else { Err(wrong(listed)) }
}

pub(crate) fn planes(section: Section<'_>, d: usize, n_cells: u32) -> Result<PlaneTree, PackedError> {
    let mut r = Reader::new(section.bytes, section.place);
    let slack = r.f64()?;
    let n = r.u32()?;
    section.expect(12 + 48 * u64::from(n))?;
    if d != 3 {
        return Err(r.fail(Kind::Value { value: d as u64 }));
    }
    let mut nodes = Vec::with_capacity(n as usize);
    for _ in 0..n {
        let (normal, offset) = (r.point(3)?, r.f64()?);
        let mut children = [PlaneChild::Nothing; 2];
        for child in &mut children {
            *child = match (r.u32()?, r.u32()?) {
                (0, id) => PlaneChild::Node(id),
                (1, id) if id < n_cells => PlaneChild::Cell(CellId(id)),
                (2, 0) => PlaneChild::Nothing,
                (_, id) => return Err(r.fail(Kind::Value { value: u64::from(id) })),
            };
        }
        nodes.push(PlaneNode { normal, offset, children });
    }
    PlaneTree::new(nodes, slack).map_err(|error| section.place.fail(Kind::Table(error.into())))
}
