//! Checks that the structure of a table matches its scene. The promises of the format (symmetry, the diagonal, ids) are
//! checked when it is read (`pvs`).

mod doors;
mod mirrors;
mod objects;
mod planar;
mod spatial;
mod world;

use crate::findings::{Findings, Geometry, Violation};
use crate::truth::Truth;
use sightlines_pvs::Table;

/// Checks all that needs no rays.
pub(crate) fn check(table: &Table, truth: &Truth<'_>) -> Findings {
    let mut findings = Findings {
        n_cells: table.n_cells(),
        n_portals: table.portals().len(),
        n_objects: table.objects().len(),
        n_doors: table.doors().len(),
        ..Findings::default()
    };
    neighbours(table, &mut findings);
    match truth {
        Truth::Plan(plan) => {
            planar::check(table, plan, &mut findings);
            objects::of_plan(table, plan, &mut findings);
            mirrors::of_plan(table, plan, &mut findings);
        }
        Truth::Scene(scene) => {
            spatial::check(table, &mut findings);
            objects::of_scene(table, scene, &mut findings);
            mirrors::of_scene(table, scene, &mut findings);
            doors::of_scene(table, scene, &mut findings);
        }
        Truth::Portals(graph) => {
            world::portals(table, graph, &mut findings);
        }
        Truth::World(graph, tree) => {
            world::portals(table, graph, &mut findings);
            world::faces(table, tree, &mut findings);
        }
    }
    findings
}

/// Compares the doors of a table, along its frame if it has one, with the boxes that it states for them.
pub(crate) fn door_boxes(table: &Table, truth: &Truth<'_>, findings: &mut Findings) {
    doors::as_boxes(table, matches!(truth, Truth::Scene(_)), findings);
}

/// What has changed since the table was made, by its digests; nothing if it has none.
pub(crate) fn changes(table: &Table, truth: &Truth<'_>) -> Vec<Violation> {
    let Some(then) = table.digest() else { return Vec::new() };
    let now = truth.digest();
    let parts = [(Geometry::Hiding, then.hiding != now.hiding), (Geometry::Seen, then.seen != now.seen)];
    let changed = parts.into_iter().filter(|(_, has_changed)| *has_changed);
    changed.map(|(what, _)| Violation::ChangedGeometry { what }).collect()
}

/// Cells joined by a portal see each other: so does every line through it.
fn neighbours(table: &Table, findings: &mut Findings) {
    for (portal, record) in table.portals().iter().enumerate() {
        let [a, b] = record.cells;
        if !table.sees(a, b) {
            findings.add(Violation::HiddenNeighbour { cells: [a, b], portal });
        }
    }
}
