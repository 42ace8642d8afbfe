//! Scenes that were changed after their tables were made.

use crate::tables::common::{Real, cases, quick};
use sightlines_cells::{CellGraph, Plan, PlanLine, Scene};
use sightlines_pvs::Table;
use sightlines_verify::{Findings, Geometry, VerifyOptions, Violation, verify};

/// What the digests of a table tell of a scene, without a ray.
fn changes(table: &Table, real: &Real) -> Vec<Geometry> {
    let options = VerifyOptions { rays: 0, pairs: 0, ..quick() };
    let findings: Findings = verify(table, &real.truth(), &options).expect("a table of this kind of scene");
    let what = |violation: &Violation| match violation {
        Violation::ChangedGeometry { what } => Some(*what),
        _ => None,
    };
    findings.violations.iter().map_while(what).collect()
}

/// The same with one number, the one before or behind the coordinate of a corner, or without a portal.
fn nudged(real: &Real) -> Real {
    match real {
        Real::Plan(plan) => {
            let mut lines: Vec<PlanLine> = plan.lines().to_vec();
            let line = lines.iter_mut().find(|line| line.opaque && line.a.x != 0.0).expect("a wall");
            line.a.x = line.a.x.next_up();
            Real::Plan(Plan::new(lines, plan.objects().to_vec()).expect("a plan"))
        }
        Real::Scene(scene) => {
            let mut objects = scene.objects().to_vec();
            let mut numbers = objects.iter_mut().flat_map(|object| object.vertices.as_flattened_mut());
            let x = numbers.find(|x| **x != 0.0).expect("a corner");
            *x = x.next_down();
            Real::Scene(Scene::new(objects).expect("a scene"))
        }
        Real::Portals(graph) => Real::Portals(fewer(graph)),
        Real::Map(graph, tree) => Real::Map(fewer(graph), tree.clone()),
    }
}

fn fewer(graph: &CellGraph<sightlines_cells::Convex>) -> CellGraph<sightlines_cells::Convex> {
    let portals = graph.portals().iter().skip(1).map(|portal| (portal.cells, portal.shape.clone()));
    CellGraph::of_portals(graph.n_cells(), portals.collect())
}

/// A change of one bit is named before any ray is shot; without a change nothing is.
#[test]
fn changed_scenes_are_named_without_rays() {
    for case in cases() {
        assert_eq!(changes(&case.table, &case.real), [], "{}: nothing has changed", case.name);
        let expected: &[Geometry] = match &case.real {
            Real::Plan(_) | Real::Scene(_) => &[Geometry::Hiding, Geometry::Seen],
            Real::Portals(_) | Real::Map(..) => &[Geometry::Hiding],
        };
        assert_eq!(changes(&case.table, &nudged(&case.real)), expected, "{}", case.name);
        // The impostor: without its digest the table has nothing to tell.
        let bare = case.table.clone().with_digest(None);
        assert_eq!(changes(&bare, &nudged(&case.real)), [], "{}", case.name);
    }
}
