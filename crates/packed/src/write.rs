//! Sections and records as bytes, as [`crate::format`] describes them.

use crate::bytes::{Writer, bytes_of};
use crate::classes::{Classes, Distinct};
use crate::error::PackError;
use crate::format::{HAS_SEEN, MAX_UNPACKED_BLOCK, NONE, POLYGONS_KNOWN, page_size};
use crate::masks::encode;
use crate::store::LEVEL;
use crate::zstandard;
use sightlines_pvs::{
    BitMatrix, CellRecord, DoorRecord, Locator, LocatorNode, ObjectPart, ObjectParts, ObjectSource, PlaneChild,
    PlaneTree, SectionId, StabTrees, TableParts,
};

/// Numbers of cells, objects, portals and nodes, and the flags of `HEAD`. A checked table counts with 32 bits.
pub(crate) fn counts(parts: &TableParts, has_seen: bool) -> [u32; 5] {
    let known = if parts.object_polygons.is_empty() { 0 } else { POLYGONS_KNOWN };
    let seen = if has_seen { HAS_SEEN } else { 0 };
    let n_nodes = parts.stab.as_ref().map_or(NONE, |stab| stab.n_nodes() as u32);
    [parts.cells.len() as u32, parts.objects.len() as u32, parts.portals.len() as u32, n_nodes, known | seen]
}

pub(crate) fn boxes(parts: &TableParts) -> Vec<u8> {
    let d = usize::from(parts.dimension);
    let mut out = Writer::default();
    for CellRecord { min, max, .. } in &parts.cells {
        out.floats(&min[..d]);
        out.floats(&max[..d]);
    }
    out.0
}

pub(crate) fn polygons(cells: &[CellRecord]) -> Vec<u8> {
    let mut out = Writer::default();
    let mut before = 0;
    out.u32(0);
    for cell in cells {
        before += cell.polygon.len() as u32;
        out.u32(before);
    }
    cells.iter().for_each(|cell| out.floats(cell.polygon.as_flattened()));
    out.0
}

pub(crate) fn locator(locator: &Locator) -> Vec<u8> {
    let (mut out, mut entries) = (Writer::default(), Writer::default());
    out.u32(locator.n_nodes() as u32);
    out.u32(locator.n_entries() as u32);
    for node in locator.to_nodes() {
        match node {
            LocatorNode::Inner { axis, split, high, .. } => {
                out.u32(u32::from(axis));
                out.u32(high);
                out.floats(&[split]);
            }
            LocatorNode::Leaf { cells } => {
                out.u32(NONE);
                out.u32(cells.len() as u32);
                out.u64(entries.0.len() as u64 / 4);
                cells.iter().for_each(|cell| entries.u32(cell.0));
            }
        }
    }
    out.0.extend(entries.0);
    out.0
}

pub(crate) fn planes(planes: &PlaneTree) -> Vec<u8> {
    let mut out = Writer::default();
    out.floats(&[planes.slack()]);
    out.u32(planes.nodes().len() as u32);
    for node in planes.nodes() {
        out.floats(&node.normal);
        out.floats(&[node.offset]);
        for child in node.children {
            let (kind, id) = match child {
                PlaneChild::Node(id) => (0, id),
                PlaneChild::Cell(cell) => (1, cell.0),
                PlaneChild::Nothing => (2, 0),
            };
            out.u32(kind);
            out.u32(id);
        }
    }
    out.0
}

pub(crate) fn mirrors(parts: &TableParts) -> Vec<u8> {
    let d = usize::from(parts.dimension);
    let mut out = Writer::default();
    out.varint(parts.mirrors.len() as u64);
    for mirror in &parts.mirrors {
        out.varint(u64::from(mirror.cell.0));
        out.varint(u64::from(mirror.mirror.0));
        out.varint(mirror.points.len() as u64);
        mirror.points.iter().for_each(|p| out.floats(&p[..d]));
    }
    out.0
}

pub(crate) fn sources(sources: &[Option<ObjectSource>]) -> Vec<u8> {
    let mut out = Writer::default();
    for source in sources {
        out.varint(source.map_or(0, |source| u64::from(source.node) + 1));
        source.iter().for_each(|source| out.varint(u64::from(source.primitive)));
    }
    out.0
}

pub(crate) fn object_parts(parts: &[ObjectPart]) -> Vec<u8> {
    let mut out = Writer::default();
    out.varint(parts.len() as u64);
    for ObjectPart { object, start, end } in parts {
        out.varint(u64::from(object.0));
        out.varint(u64::from(end - start));
    }
    out.0
}

/// The parts that each cell sees.
pub(crate) fn parts_seen(ObjectParts { parts, seen }: &ObjectParts) -> impl Iterator<Item = Vec<u8>> + '_ {
    (0..seen.n_rows()).map(|row| {
        let mut out = Vec::new();
        let ascending = seen.iter_ones(row).map(|part| part as u32);
        encode(ascending, parts.len() as u32, &mut out).expect("the ones of a row ascend");
        out
    })
}

pub(crate) fn doors(doors: &[DoorRecord]) -> Vec<u8> {
    let mut out = Writer::default();
    out.varint(doors.len() as u64);
    for DoorRecord { name, object, portals } in doors {
        out.varint(object.map_or(0, |object| u64::from(object.0) + 1));
        out.text(name);
        out.ascending(portals.iter().map(|portal| portal.0));
    }
    out.0
}

pub(crate) fn info(info: &[(String, String)]) -> Vec<u8> {
    let mut out = Writer::default();
    out.varint(info.len() as u64);
    for (key, value) in info {
        out.text(key);
        out.text(value);
    }
    out.0
}

/// The classes of each, packed; empty if each is its own class.
///
/// Classes are numbered by their first members, so most entries are "the next new one", which is 0.
pub(crate) fn classes(id: SectionId, classes: &Classes) -> Result<Vec<u8>, PackError> {
    if classes.is_identity() {
        return Ok(Vec::new());
    }
    let mut raw = Writer::default();
    let mut next = 0;
    for &class in &classes.of {
        raw.varint(u64::from(next - class));
        next = next.max(class + 1);
    }
    let mut out = Writer::default();
    let n_raw = u32::try_from(raw.0.len()).ok().filter(|n| *n <= MAX_UNPACKED_BLOCK);
    out.u32(n_raw.ok_or(PackError::Record { store: id, bytes: raw.0.len() as u64 })?);
    out.0.extend(zstandard::compress(&raw.0, LEVEL).map_err(|_| PackError::Zstd { store: id })?);
    Ok(out.0)
}

/// Which pages of cells see each other. O(cells * classes / 64 + ones of the distinct rows).
pub(crate) fn coarse(rows: &Distinct, n_cells: usize) -> Vec<u8> {
    let page = page_size(n_cells);
    let n_pages = n_cells.div_ceil(page);
    // First pages by classes, then each class is replaced by the pages in which it has members.
    let mut seen = BitMatrix::new(n_pages, rows.bits.n_cols());
    for (i, &class) in rows.rows.of.iter().enumerate() {
        sightlines_pvs::bits::or_words(seen.row_mut(i / page), rows.bits.row(class as usize));
    }
    let mut out = BitMatrix::new(n_pages, n_pages);
    for p in 0..n_pages {
        for (j, &class) in rows.columns.of.iter().enumerate() {
            if seen.get(p, class as usize) {
                out.set(p, j / page, true);
            }
        }
    }
    (0..n_pages).flat_map(|p| bytes_of(out.row(p))).collect()
}

/// The records of `CELL`.
pub(crate) fn cells(parts: &TableParts) -> impl Iterator<Item = Vec<u8>> + '_ {
    // The exits of each cell, one after the other; `ends` are filled from the beginnings on.
    let mut ends = vec![0u32; parts.cells.len() + 1];
    parts.portals.iter().flat_map(|portal| portal.cells).for_each(|cell| ends[cell.idx() + 1] += 1);
    (0..parts.cells.len()).for_each(|i| ends[i + 1] += ends[i]);
    let mut all = vec![(0u64, 0u32); 2 * parts.portals.len()];
    let mut push = |from: sightlines_pvs::CellId, exit| {
        all[ends[from.idx()] as usize] = exit;
        ends[from.idx()] += 1;
    };
    for (portal, record) in (0u64..).zip(&parts.portals) {
        let [a, b] = record.cells;
        push(a, (2 * portal, b.0));
        push(b, (2 * portal + 1, a.0));
    }
    let record = move |i: usize| {
        let exits = &all[i.checked_sub(1).map_or(0, |before| ends[before] as usize)..ends[i] as usize];
        let mut out = Writer::default();
        out.varint(parts.cells[i].group.map_or(0, |group| u64::from(group) + 1));
        out.varint(exits.len() as u64);
        for &(gate, to) in exits {
            out.varint(gate);
            out.varint(u64::from(to));
        }
        out.ascending(parts.cell_objects[i].iter().map(|object| object.0));
        if let Some(stab) = &parts.stab {
            let cell = sightlines_pvs::CellId(i as u32);
            out.varint(u64::from(stab.is_root_open(cell)));
            out.ascending(stab.roots(cell).iter().copied());
        }
        out.0
    };
    (0..parts.cells.len()).map(record)
}

/// The records of `PORT`.
pub(crate) fn portals(parts: &TableParts) -> impl Iterator<Item = Vec<u8>> + '_ {
    let d = usize::from(parts.dimension);
    let record = move |portal: &sightlines_pvs::PortalRecord| {
        let mut out = Writer::default();
        let ids = [portal.cells[0].0, portal.cells[1].0, portal.sides[0], portal.sides[1]];
        ids.into_iter().for_each(|x| out.varint(u64::from(x)));
        out.varint(portal.points.len() as u64);
        portal.points.iter().for_each(|p| out.floats(&p[..d]));
        out.0
    };
    parts.portals.iter().map(record)
}

/// The records of `OBJS`.
pub(crate) fn objects(parts: &TableParts) -> impl Iterator<Item = Vec<u8>> + '_ {
    let d = usize::from(parts.dimension);
    let record = move |(o, object): (usize, &sightlines_pvs::ObjectRecord)| {
        let mut out = Writer::default();
        out.floats(&object.min[..d]);
        out.floats(&object.max[..d]);
        out.varint(u64::from(parts.object_polygons.get(o).copied().unwrap_or(0)));
        out.0.extend_from_slice(object.name.as_bytes());
        out.0
    };
    parts.objects.iter().enumerate().map(record)
}

/// The records of `CNAM`.
pub(crate) fn cell_names(parts: &TableParts) -> impl Iterator<Item = Vec<u8>> + '_ {
    parts.cell_names.iter().map(|name| name.as_bytes().to_vec())
}

/// The records of `STAB`.
pub(crate) fn nodes(stab: &StabTrees) -> impl Iterator<Item = Vec<u8>> + '_ {
    let record = |node: u32| {
        let mut out = Writer::default();
        let ((portal, forward), children) = (stab.gate(node), stab.children(node));
        out.varint(2 * u64::from(portal.0) + u64::from(!forward));
        out.varint(2 * children.len() as u64 + u64::from(stab.is_open(node)));
        let mut above = node;
        for &child in children.iter().rev() {
            out.varint(u64::from(above - 1 - child));
            above = child;
        }
        out.0
    };
    (0..stab.n_nodes() as u32).map(record)
}
