//! Writes a table.

use super::container::{self, Payload};
use super::writer::Writer;
use super::{
    CELL_NAMES, CELL_OBJECTS, CELLS, DIGEST, DOORS, FRAME, INFO, KIND, LEAF, LOCATOR, MIRRORS, OBJECT_PARTS,
    OBJECT_POLYGONS, OBJECTS, PLANES, POLYGONS, PORTALS, ROWS, SEEN, SOURCES, STAB, SectionId, doors, kind_section,
    object_parts, planes, stab,
};
use crate::locator::Node;
use crate::{BitMatrix, CellRecord, MirrorRecord, ObjectId, ObjectRecord, PortalRecord, Table, TableParts};

impl Table {
    /// The table as the bytes of a `.pvs` file, the same on every machine. O(size).
    ///
    /// Optional sections are written only if they have content.
    pub fn to_bytes(&self) -> Vec<u8> {
        let parts = self.parts();
        let d = usize::from(parts.dimension);
        let mut sections = vec![section(CELLS, |out| cells(out, parts))];
        if parts.cells.iter().any(|cell| !cell.polygon.is_empty()) {
            sections.push(section(POLYGONS, |out| polygons(out, &parts.cells)));
        }
        if !parts.portals.is_empty() {
            sections.push(section(PORTALS, move |out| portals(out, &parts.portals, d)));
        }
        sections.push(section(ROWS, |out| rows(out, &parts.rows)));
        sections.push(section(LOCATOR, |out| locator(out, parts)));
        sections.push(section(OBJECTS, move |out| objects(out, &parts.objects, d)));
        sections.push(section(CELL_OBJECTS, |out| cell_objects(out, &parts.cell_objects)));
        if let Some(seen) = &parts.objects_seen {
            sections.push(section(SEEN, |out| out.rows(seen)));
        }
        if !parts.mirrors.is_empty() {
            sections.push(section(MIRRORS, move |out| mirrors(out, &parts.mirrors, d)));
        }
        if !parts.object_polygons.is_empty() {
            sections.push(section(OBJECT_POLYGONS, |out| parts.object_polygons.iter().for_each(|&n| out.u32(n))));
        }
        if let Some(planes) = &parts.planes {
            sections.push(section(PLANES, |out| planes::write(out, planes)));
        }
        if let Some(trees) = &parts.stab {
            sections.push(section(STAB, |out| stab::write(out, trees, &parts.portals)));
        }
        if !parts.cell_names.is_empty() {
            sections.push(section(CELL_NAMES, |out| parts.cell_names.iter().for_each(|name| out.text(name))));
        }
        if let Some(kind) = kind_section(parts.dimension, parts.kind, parts.up, &parts.info) {
            sections.push(section(KIND, move |out| out.0.extend(kind)));
        }
        if let Some(frame) = &parts.frame {
            sections.push(section(FRAME, |out| out.0.extend(frame.to_bytes())));
        }
        if let Some(digest) = &parts.digest {
            sections.push(section(DIGEST, |out| out.0.extend(digest.to_bytes())));
        }
        if !parts.object_sources.is_empty() {
            sections.push(section(SOURCES, |out| doors::write_sources(out, &parts.object_sources)));
        }
        if !parts.doors.is_empty() {
            sections.push(section(DOORS, |out| doors::write(out, &parts.doors)));
        }
        if let Some(of_objects) = &parts.object_parts {
            sections.push(section(OBJECT_PARTS, |out| object_parts::write(out, of_objects)));
        }
        sections.push(section(INFO, |out| info(out, &parts.info)));
        container::write(sections)
    }
}

fn section<'a>(id: SectionId, fill: impl FnOnce(&mut Writer) + 'a) -> Payload<'a> {
    Payload { id, fill: Box::new(fill) }
}

fn cells(out: &mut Writer, parts: &TableParts) {
    let d = usize::from(parts.dimension);
    out.u32(u32::from(parts.dimension));
    out.count(parts.cells.len());
    for CellRecord { min, max, group, .. } in &parts.cells {
        out.floats(&min[..d]);
        out.floats(&max[..d]);
        out.u32(u32::from(group.is_some()));
        out.u32(group.unwrap_or(0));
    }
}

fn polygons(out: &mut Writer, cells: &[CellRecord]) {
    cells.iter().for_each(|cell| out.count(cell.polygon.len()));
    cells.iter().for_each(|cell| out.floats(cell.polygon.as_flattened()));
}

fn portals(out: &mut Writer, portals: &[PortalRecord], d: usize) {
    out.count(portals.len());
    for PortalRecord { cells, sides, points } in portals {
        [cells[0].0, cells[1].0, sides[0], sides[1]].into_iter().for_each(|x| out.u32(x));
        out.count(points.len());
        points.iter().for_each(|p| out.floats(&p[..d]));
    }
}

fn mirrors(out: &mut Writer, mirrors: &[MirrorRecord], d: usize) {
    out.count(mirrors.len());
    for MirrorRecord { cell, mirror, points } in mirrors {
        out.u32(cell.0);
        out.u32(mirror.0);
        out.count(points.len());
        points.iter().for_each(|p| out.floats(&p[..d]));
    }
}

fn rows(out: &mut Writer, rows: &BitMatrix) {
    out.0.reserve_exact((0..rows.n_rows()).map(|i| 8 * (i / 64 + 1)).sum());
    for i in 0..rows.n_rows() {
        let (last, bits) = (i / 64, i % 64);
        for (k, word) in rows.row(i)[..=last].iter().enumerate() {
            let kept = if k == last { u64::MAX >> (63 - bits) } else { u64::MAX };
            out.0.extend((word & kept).to_le_bytes());
        }
    }
}

fn locator(out: &mut Writer, parts: &TableParts) {
    let (nodes, cells) = parts.locator.raw();
    out.count(nodes.len());
    out.count(cells.len());
    for node in nodes {
        match *node {
            Node::Inner { axis, split, high } => {
                out.u32(u32::from(axis));
                out.u32(high);
                out.floats(&[split]);
            }
            Node::Leaf { start, end } => {
                out.u32(LEAF);
                out.u32(end - start);
                out.0.extend([0; 8]);
            }
        }
    }
    cells.iter().for_each(|cell| out.u32(cell.0));
}

fn objects(out: &mut Writer, objects: &[ObjectRecord], d: usize) {
    out.count(objects.len());
    for ObjectRecord { name, min, max } in objects {
        out.floats(&min[..d]);
        out.floats(&max[..d]);
        out.text(name);
    }
}

fn cell_objects(out: &mut Writer, lists: &[Vec<ObjectId>]) {
    lists.iter().for_each(|list| out.count(list.len()));
    lists.iter().flatten().for_each(|object| out.u32(object.0));
}

fn info(out: &mut Writer, info: &[(String, String)]) {
    out.count(info.len());
    for (key, value) in info {
        out.text(key);
        out.text(value);
    }
}
