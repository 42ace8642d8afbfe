//! Clusters, portals and faces of Quake maps.

use super::objects::compare;
use crate::findings::{Findings, Violation};
use crate::truth::{MapFace, MapTree};
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_pvs::{ObjectId, Table};

/// Compares cells and portals with those of a portal file.
pub(super) fn portals(table: &Table, graph: &CellGraph<Convex>, findings: &mut Findings) {
    let counts =
        [("cells", table.n_cells(), graph.n_cells()), ("portals", table.portals().len(), graph.portals().len())];
    for (what, table, scene) in counts.into_iter().filter(|&(what, table, scene)| {
        // Tables may be stripped of their portals.
        table != scene && !(what == "portals" && table == 0)
    }) {
        findings.add(Violation::Count { what, table, scene });
    }
    for (portal, (record, real)) in table.portals().iter().zip(graph.portals()).enumerate() {
        // Tables have corners the other way round.
        let same = real.shape.corners().iter().rev().eq(record.points.iter());
        if record.cells != real.cells || !same {
            findings.add(Violation::UnlikePortal { portal });
        }
    }
}

/// Compares objects with the faces of a map, and lists with those of its leafs.
pub(super) fn faces(table: &Table, world: &MapTree, findings: &mut Findings) {
    let around = |face: &MapFace| {
        let b = face.bounds();
        if b.is_empty() { ([0.0; 3], [0.0; 3]) } else { (b.min, b.max) }
    };
    let objects = world.faces.iter().map(|f| (f.name.as_str(), around(f).0, around(f).1));
    if !compare(table, objects, findings) || world.listed.len() != table.n_cells() {
        return;
    }
    for (cell, listed) in (0u32..).map(CellId).zip(&world.listed) {
        let of_cell = table.objects_of(cell);
        for &object in listed.iter().filter(|face| of_cell.binary_search(&ObjectId(**face)).is_err()) {
            findings.add(Violation::UnlistedObject { cell, object });
        }
    }
}
