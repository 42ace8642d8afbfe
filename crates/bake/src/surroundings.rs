//! What is around everything else in a scene: skies, ground planes of kilometres, far backdrops.
//!
//! Nobody is out there, and hardly anything hides behind it. As part of the scene such an object would make its box so large that all else is in one
//! cell. So the rest is baked without it, as it would be alone, and it counts as visible from every cell. That hides less, never more, whatever is
//! taken for surroundings; an eye between the rest and them is in no cell, and sees everything.

use crate::scene::n_triangles;
use sightlines_cells::{ANYWHERE, Scene};
use sightlines_geometry::{Aabb, Point3, orient3d};
use sightlines_pvs::{ObjectId, Table, TableError, TableParts};

/// The most objects that are surroundings.
const MOST: usize = 16;
/// How many times as long as the rest an object is at least, along its longest side, that has all triangles apart from the rest.
const APART: f64 = 4.0;
/// How many times as long a flat one is at least, along two axes, that the rest stands on.
const GROUND: f64 = 16.0;
/// What is apart from the rest is farther away than this share of its longest side.
const MARGIN: f64 = 1.0 / 16.0;
/// How deep the rest may reach through the ground: this share of its height.
const DEPTH: f64 = 1.0 / 8.0;
/// Below so many other objects with triangles nothing is left that could hide something.
const LEAST_REST: usize = 2;

/// The objects around everything else in a scene, ascending.
///
/// These are the largest ones, as many as possible up to 16, such that each of them is so relative to the others of the scene together: either it is
/// at least four times as long, and all of its triangles are apart from the box of the others, by a sixteenth of its longest side; or it is thinner than
/// that along an axis of the scene, 16 times as long along both others, and the others stand on it or hang from it. What moves, reflects or is a door is none, and
/// where fewer than two other objects have triangles, or their box has no inside, there are none. The numbers are choices. O(n log n) of
/// objects, O(n) of the triangles of the largest.
pub fn surroundings(scene: &Scene) -> Vec<u32> {
    let n = scene.objects().len() as u32;
    let extents: Vec<Aabb<3>> = (0..n).map(|object| scene.extent(object)).collect();
    let is_there = |object: &u32| !extents[*object as usize].is_empty() && extents[*object as usize] != ANYWHERE;
    let mut order: Vec<u32> = (0..n).filter(is_there).collect();
    let size = |object: &u32| longest(&extents[*object as usize]);
    order.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.cmp(b)));
    let can_be = |object: &u32| {
        let moves = scene.moving().iter().any(|moving| moving.object == *object);
        !moves && scene.doors().binary_search(object).is_err() && scene.mirrors().binary_search(object).is_err()
    };
    let most = order.iter().take(MOST.min(order.len().saturating_sub(LEAST_REST))).take_while(|o| can_be(o)).count();
    // The box around all from the k-th on.
    let mut boxes = vec![Aabb::EMPTY; order.len() + 1];
    for k in (0..order.len()).rev() {
        let b = &extents[order[k] as usize];
        boxes[k] = boxes[k + 1].with(b.min).with(b.max);
    }
    let are_around = |k: &usize| {
        let rest = &boxes[*k];
        let has_room = (0..3).all(|axis| rest.min[axis] < rest.max[axis]);
        has_room && order[..*k].iter().all(|&object| is_around(scene, object, &extents[object as usize], rest))
    };
    let mut found = order[..(1..=most).rev().find(are_around).unwrap_or(0)].to_vec();
    found.sort_unstable();
    found
}

/// Whether an object is around what has a box.
fn is_around(scene: &Scene, object: u32, extent: &Aabb<3>, rest: &Aabb<3>) -> bool {
    let side = |b: &Aabb<3>, k: usize| b.max[k] - b.min[k];
    let size = longest(rest);
    let is_ground = (0..3).any(|axis| {
        let deep = DEPTH * side(rest, axis);
        side(extent, axis) <= MARGIN * size
            && (extent.max[axis] <= rest.min[axis] + deep || extent.min[axis] >= rest.max[axis] - deep)
            && (0..3).filter(|&k| k != axis).all(|k| side(extent, k) >= GROUND * size)
    });
    if is_ground || longest(extent) < APART * size {
        return is_ground;
    }
    let margin = MARGIN * size;
    let wide = Aabb { min: rest.min.map(|x| x - margin), max: rest.max.map(|x| x + margin) };
    scene.objects()[object as usize].corners().all(|t| is_apart(&t, &wide))
}

/// Whether a triangle is apart from a box: along an axis, or as the box is on one side of its plane.
fn is_apart(t: &[Point3; 3], b: &Aabb<3>) -> bool {
    let along = |k: usize| t.iter().all(|p| p[k] < b.min[k]) || t.iter().all(|p| p[k] > b.max[k]);
    let sides = || b.corners().map(|p| orient3d(t[0], t[1], t[2], p));
    (0..3).any(along) || sides().iter().all(|s| *s > 0.0) || sides().iter().all(|s| *s < 0.0)
}

fn longest(b: &Aabb<3>) -> f64 {
    (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max)
}

/// An object around the rest of a scene, which is baked without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surrounding {
    /// Its index.
    pub object: u32,
    /// The box around it, along the axes of the table.
    pub bounds: Aabb<3>,
    /// Its triangles.
    pub n_triangles: u32,
}

impl Surrounding {
    /// An object of a scene along the axes of the table.
    pub(crate) fn of(scene: &Scene, object: u32) -> Self {
        Self { object, bounds: scene.extent(object), n_triangles: n_triangles(&scene.objects()[object as usize]) }
    }
}

/// The key under which a table states the names of the surroundings, one a line.
const SURROUNDINGS: &str = "surroundings";

/// States surroundings in the table of the rest, but for what sees them.
///
/// Their boxes are widened to hold all cells, each of which then lists them: an eye in any cell may see them without looking through another cell
/// that they touch.
pub(crate) fn state(parts: &mut TableParts, around: &[Surrounding]) {
    let cells = Aabb::<3>::around(parts.cells.iter().flat_map(|cell| [cell.min, cell.max]));
    let mut names = Vec::new();
    for of in around {
        let record = &mut parts.objects[of.object as usize];
        let all = if cells.is_empty() { of.bounds } else { of.bounds.with(cells.min).with(cells.max) };
        (record.min, record.max) = (all.min, all.max);
        names.push(record.name.clone());
        parts.object_polygons[of.object as usize] = of.n_triangles;
        for list in &mut parts.cell_objects {
            list.insert(list.partition_point(|object| object.0 < of.object), ObjectId(of.object));
        }
    }
    if !names.is_empty() {
        parts.info.push((SURROUNDINGS.to_owned(), names.join("\n")));
        parts.info.sort();
    }
}

/// The table of a scene, from that of the rest: every cell sees the surroundings.
pub(crate) fn seen_around(table: Table, around: &[Surrounding]) -> Result<Table, TableError> {
    if around.is_empty() {
        return Ok(table);
    }
    let mut parts = table.into_parts();
    state(&mut parts, around);
    let n_cells = parts.cells.len();
    if let Some(seen) = &mut parts.objects_seen {
        (0..n_cells).for_each(|cell| around.iter().for_each(|of| seen.set(cell, of.object as usize, true)));
    }
    Table::new(parts)
}
