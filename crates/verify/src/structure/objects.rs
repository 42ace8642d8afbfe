//! Objects of plans and scenes.

use crate::findings::{Findings, Violation};
use crate::shapes::outlines;
use sightlines_cells::{CellId, Plan, Scene};
use sightlines_geometry::{Aabb, Point2, orient2d};
use sightlines_pvs::{CellRecord, ObjectId, ObjectRecord, Table};

/// Compares names, boxes and lists with those of a plan.
pub(super) fn of_plan(table: &Table, plan: &Plan, findings: &mut Findings) {
    let lift = |[x, y]: [f64; 2]| [x, y, 0.0];
    let scene = plan.objects().iter().map(|o| (o.name.as_str(), lift(o.bounds.min), lift(o.bounds.max)));
    if !compare(table, scene, findings) {
        return;
    }
    let Some(cells) = outlines(table) else { return };
    for (id, cell) in (0u32..).map(CellId).zip(&cells) {
        let around = Aabb::<2>::around(cell.iter().map(|p| [p.x, p.y]));
        let touches = |o: &ObjectRecord| {
            let b = Aabb { min: [o.min[0], o.min[1]], max: [o.max[0], o.max[1]] };
            boxes_meet(&around, &b) && sides_meet(cell, &b)
        };
        lists(table, id, touches, findings);
    }
}

/// Compares names, boxes, numbers of triangles, places in the file, and lists with those of a scene in space.
pub(super) fn of_scene(table: &Table, scene: &Scene, findings: &mut Findings) {
    let cells = Aabb::<3>::around(table.cells().iter().flat_map(|cell| [cell.min, cell.max]));
    let drawn = |object: usize| {
        let b = scene.extent(object as u32);
        // What is not drawn is nowhere, and tables have it at the origin.
        if b.is_empty() {
            return ([0.0; 3], [0.0; 3]);
        }
        // The box of what is around a scene holds all cells too, which errs towards visible.
        let wide = if cells.is_empty() { b } else { b.with(cells.min).with(cells.max) };
        let is_wide = table.objects().get(object).is_some_and(|o| (o.min, o.max) == (wide.min, wide.max));
        if is_wide { (wide.min, wide.max) } else { (b.min, b.max) }
    };
    let objects = scene.objects().iter().enumerate().map(|(k, o)| (o.name.as_str(), drawn(k).0, drawn(k).1));
    if !compare(table, objects, findings) {
        return;
    }
    for (object, o) in (0u32..).zip(scene.objects()) {
        let n = u32::try_from(o.triangles.len()).unwrap_or(u32::MAX);
        if !table.parts().object_polygons.is_empty() && table.polygons_of(ObjectId(object)) != n {
            findings.add(Violation::ObjectBox { object });
        }
        let source = scene.sources().get(object as usize).copied().flatten();
        if table.has_sources() && !scene.sources().is_empty() && table.source_of(ObjectId(object)) != source {
            findings.add(Violation::ObjectSource { object });
        }
    }
    let is_drawn: Vec<bool> = (0u32..).zip(scene.objects()).map(|(k, _)| !scene.extent(k).is_empty()).collect();
    for (id, cell) in (0u32..).map(CellId).zip(table.cells()) {
        let touches = |o: &ObjectRecord| meets(cell, o);
        lists_of(table, id, |k, o| is_drawn[k] && touches(o), findings);
    }
}

fn meets(cell: &CellRecord, o: &ObjectRecord) -> bool {
    (0..3).all(|k| cell.min[k] <= o.max[k] && o.min[k] <= cell.max[k])
}

/// Compares names and boxes; whether there are as many as in the scene.
pub(super) fn compare<'s>(
    table: &Table,
    scene: impl ExactSizeIterator<Item = (&'s str, [f64; 3], [f64; 3])>,
    findings: &mut Findings,
) -> bool {
    let (n_table, n_scene) = (table.objects().len(), scene.len());
    if n_table != n_scene {
        findings.add(Violation::Count { what: "objects", table: n_table, scene: n_scene });
        return false;
    }
    let mut wrong_boxes = Vec::new();
    for ((object, record), (name, min, max)) in (0u32..).zip(table.objects()).zip(scene) {
        if record.name != name {
            findings.add(Violation::ObjectName { object });
        }
        if record.min != min || record.max != max {
            wrong_boxes.push(object);
        }
    }
    wrong_boxes.into_iter().for_each(|object| findings.add(Violation::ObjectBox { object }));
    true
}

fn lists(table: &Table, cell: CellId, touches: impl Fn(&ObjectRecord) -> bool, findings: &mut Findings) {
    lists_of(table, cell, |_, o| touches(o), findings);
}

fn lists_of(table: &Table, cell: CellId, touches: impl Fn(usize, &ObjectRecord) -> bool, findings: &mut Findings) {
    let listed = table.objects_of(cell);
    for (k, o) in table.objects().iter().enumerate() {
        let object = k as u32;
        match (touches(k, o), listed.binary_search(&ObjectId(object)).is_ok()) {
            (true, false) => findings.add(Violation::UnlistedObject { cell, object }),
            (false, true) => findings.remarks.listed_apart += 1,
            _ => {}
        }
    }
}

fn boxes_meet(a: &Aabb<2>, b: &Aabb<2>) -> bool {
    (0..2).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Whether no side of the polygon has all corners of the box strictly outside. Exact.
fn sides_meet(polygon: &[Point2], b: &Aabb<2>) -> bool {
    let corners = [b.min, [b.max[0], b.min[1]], b.max, [b.min[0], b.max[1]]].map(Point2::from);
    let n = polygon.len();
    (0..n).all(|i| corners.iter().any(|&c| orient2d(polygon[i], polygon[(i + 1) % n], c) >= 0.0))
}
