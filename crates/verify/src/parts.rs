//! Tables with parts of objects, checked as tables in which each part is an object of its own.

use crate::findings::{Findings, Violation};
use sightlines_cells::{MovingObject, Scene, SceneObject, places_of_triangles};
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, ObjectId, ObjectPart, ObjectRecord, Table};
use std::ops::Range;

/// A table and its scene, with parts in place of the objects that were cut.
pub(crate) struct InParts {
    pub(crate) table: Table,
    pub(crate) scene: Scene,
    /// What the objects of both are.
    things: Vec<Thing>,
}

/// An object of a table in parts.
#[derive(Debug, Clone)]
enum Thing {
    /// A part, by its number.
    Part(u32),
    /// An object that was not cut.
    Whole(u32),
}

impl InParts {
    /// None for a table without parts, and with a violation for one whose parts are not those of the scene.
    ///
    /// * `left_out`: triangles of the file that the scene does not have
    pub(crate) fn of(table: &Table, scene: &Scene, left_out: &[[u32; 2]], findings: &mut Findings) -> Option<Self> {
        let parts = table.object_parts();
        if parts.is_empty() || scene.objects().len() != table.objects().len() {
            return None;
        }
        let (mut things, mut objects): (Vec<Thing>, Vec<SceneObject>) = (Vec::new(), Vec::new());
        let mut of: Vec<u32> = Vec::new();
        let mut add = |thing: Thing, object: u32, triangles: Range<usize>| {
            let whole = &scene.objects()[object as usize];
            let vertices: Vec<_> = whole.corners_of(triangles).flatten().collect();
            let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            objects.push(SceneObject { name: whole.name.clone(), vertices, triangles });
            things.push(thing);
            of.push(object);
        };
        let mut n = 0;
        for list in parts.chunk_by(|a, b| a.object == b.object) {
            let object = list[0].object.0;
            let places = places_of_triangles(left_out, object, scene.objects()[object as usize].triangles.len());
            if list.last().map(|part| part.end) != places.last().copied() {
                findings.add(Violation::ObjectParts { object });
                return None;
            }
            for &ObjectPart { start, end, .. } in list {
                let at = |place: u32| places[..places.len() - 1].partition_point(|&p| p < place);
                add(Thing::Part(n), object, at(start)..at(end));
                n += 1;
            }
        }
        let is_cut = |object: u32| parts.binary_search_by_key(&object, |part| part.object.0).is_ok();
        for (object, o) in (0u32..).zip(scene.objects()).filter(|(object, _)| !is_cut(*object)) {
            add(Thing::Whole(object), object, 0..o.triangles.len());
        }
        let those = |holds: &dyn Fn(u32) -> bool| -> Vec<u32> {
            (0u32..).zip(&of).filter(|(_, object)| holds(**object)).map(|(thing, _)| thing).collect()
        };
        // What moves is not cut, and comes in the order of the objects.
        let moves = |object: &u32| scene.moving().binary_search_by_key(object, |moving| moving.object).ok();
        let moving = (0u32..)
            .zip(&of)
            .filter_map(|(thing, object)| moves(object).map(|k| MovingObject { object: thing, ..scene.moving()[k] }));
        let moving: Vec<MovingObject> = moving.collect();
        let in_parts = Scene::new(objects)
            .and_then(|all| all.with_moving(moving))
            .and_then(|all| all.with_see_through(those(&|o| !scene.is_opaque(o))))
            .and_then(|all| all.with_single_sided(those(&|o| scene.is_single_sided(o))))
            .and_then(|all| all.with_front_occluders(those(&|o| scene.hides_from_front(o))));
        let in_parts = in_parts.expect("the parts of a scene are a scene");
        Some(Self { table: table_of(table, &things, &in_parts), scene: in_parts, things })
    }

    /// Restates violations, from the given one on, by the parts and objects of the original table.
    pub(crate) fn rename(&self, findings: &mut Findings, first: usize) {
        for violation in &mut findings.violations[first..] {
            let Violation::HiddenObject { cell, object, segment } = *violation else { continue };
            let before = violation.kind();
            *violation = match self.things[object as usize] {
                Thing::Part(part) => Violation::HiddenPart { cell, part, segment },
                Thing::Whole(object) => Violation::HiddenObject { cell, object, segment },
            };
            *findings.by_kind.entry(violation.kind()).or_default() += 1;
            findings.by_kind.entry(before).and_modify(|n| *n -= 1);
        }
        findings.by_kind.retain(|_, n| *n > 0);
    }
}

/// The table whose objects are these.
fn table_of(table: &Table, things: &[Thing], scene: &Scene) -> Table {
    let mut parts = table.parts().clone();
    let (of_objects, seen) = parts.object_parts.take().zip(parts.objects_seen.take()).expect("rows of both kinds");
    let mut all = BitMatrix::new(parts.cells.len(), things.len());
    let mut records = Vec::with_capacity(things.len());
    let mut ids = vec![None; parts.objects.len()];
    for (k, (thing, o)) in things.iter().zip(scene.objects()).enumerate() {
        let (matrix, column) = match *thing {
            Thing::Part(part) => (&of_objects.seen, part),
            Thing::Whole(object) => (&seen, object),
        };
        (0..parts.cells.len())
            .filter(|&cell| matrix.get(cell, column as usize))
            .for_each(|cell| all.set(cell, k, true));
        records.push(match *thing {
            Thing::Part(_) => {
                let b: Aabb<3> = o.bounds();
                let b = if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { b };
                ObjectRecord { name: o.name.clone(), min: b.min, max: b.max }
            }
            Thing::Whole(object) => {
                ids[object as usize] = Some(ObjectId(k as u32));
                parts.objects[object as usize].clone()
            }
        });
    }
    parts.cell_objects.iter_mut().for_each(|list| *list = list.iter().filter_map(|o| ids[o.idx()]).collect());
    (parts.objects, parts.objects_seen) = (records, Some(all));
    (parts.object_polygons, parts.object_sources, parts.doors) = (Vec::new(), Vec::new(), Vec::new());
    Table::new(parts).expect("the parts of a table are a table")
}
