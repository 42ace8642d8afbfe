//! Mirrors: where a cell has one on its border or inside, the table has to have a part of it.
//!
//! A part that is missing reflects nothing, and what is seen in it is hidden. Parts are looked for between the places where something begins or ends, as on
//! [borders](crate::borders). Which points of a plan are on a mirror is decided as it is for the bake, by exact signs.

use crate::borders::{middles, pairs};
use crate::findings::{Findings, Violation};
use crate::shapes::{ends, outlines, turn};
use sightlines_cells::{CellId, LineId, Plan, Scene, SceneObject};
use sightlines_geometry::{Aabb, BoxTree, Point2, Point3, orient2d};
use sightlines_pvs::{MirrorRecord, PortalRecord, Table};

/// Compares the parts of mirrors with the lines of a plan that are mirrors.
pub(super) fn of_plan(table: &Table, plan: &Plan, findings: &mut Findings) {
    let Some(cells) = outlines(table).filter(|_| !plan.mirrors().is_empty()) else { return };
    let by_cell = by_cell(table);
    for (id, cell) in (0u32..).map(CellId).zip(&cells) {
        let sides = cell.iter().zip(cell.iter().cycle().skip(1));
        let missing = sides.flat_map(|(&from, &to)| {
            let of_line = |&LineId(line): &LineId| {
                let line = &plan.lines()[line as usize];
                missing_in_plan([from, to], [line.a, line.b], &by_cell[id.idx()])
            };
            plan.mirrors().iter().find_map(of_line)
        });
        missing.take(1).for_each(|point| findings.add(Violation::MissingMirror { cell: id, point }));
    }
}

/// A point of a side of a cell that is on a mirror, and on no part of one that looks into the cell. What is not exactly on one line is not looked at.
fn missing_in_plan([from, to]: [Point2; 2], mirror: [Point2; 2], parts: &[&MirrorRecord]) -> Option<Point3> {
    let is_on = |p: Point2, [a, b]: [Point2; 2]| orient2d(a, b, p) == 0.0;
    if from == to || mirror[0] == mirror[1] || ![from, to].iter().all(|&p| is_on(p, mirror)) {
        return None;
    }
    let axis = usize::from((to.y - from.y).abs() > (to.x - from.x).abs());
    let along = |p: Point2| p.to_array()[axis];
    let range = |[a, b]: [Point2; 2]| [along(a).min(along(b)), along(a).max(along(b))];
    let ([low, high], reach) = (range([from, to]), range(mirror));
    // From the left end of a part to its right end, a cell's side runs backwards.
    let looks_in = |part: &&&MirrorRecord| {
        let [left, right] = ends_of(part);
        [left, right].iter().all(|&p| is_on(p, [from, to])) && (along(right) < along(left)) == (along(from) < along(to))
    };
    let parts: Vec<[f64; 2]> = parts.iter().filter(looks_in).map(|part| range(ends_of(part))).collect();
    let is_covered = |x: f64| parts.iter().any(|[low, high]| *low <= x && x <= *high);
    let common = [low.max(reach[0]), high.min(reach[1])];
    let open = middles(common, parts.iter().flatten().copied().collect()).into_iter().find(|&x| !is_covered(x))?;
    let share = (open - along(from)) / (along(to) - along(from));
    let p = from + (to - from) * share;
    Some([p.x, p.y, 0.0])
}

fn ends_of(part: &MirrorRecord) -> [Point2; 2] {
    ends(&PortalRecord { cells: [CellId(0); 2], sides: [0; 2], points: part.points.clone() })
}

/// Compares the parts of mirrors with those of a scene's mirrors that are [rectangles] along the axes.
pub(super) fn of_scene(table: &Table, scene: &Scene, findings: &mut Findings) {
    let moves = |object: &u32| scene.moving().binary_search_by_key(object, |moving| moving.object).is_ok();
    let still = scene.mirrors().iter().filter(|object| !moves(object));
    let rectangles: Vec<Aabb<3>> = still.flat_map(|&object| rectangles(&scene.objects()[object as usize])).collect();
    // Tables of given cells, which may overlap, have no mirrors.
    if rectangles.is_empty() || table.portals().is_empty() {
        return;
    }
    let by_cell = by_cell(table);
    for (id, cell) in (0u32..).map(CellId).zip(table.cells()) {
        let bounds = Aabb { min: cell.min, max: cell.max };
        let missing = rectangles.iter().find_map(|r| missing_in_space(&bounds, r, &by_cell[id.idx()]));
        missing.into_iter().for_each(|point| findings.add(Violation::MissingMirror { cell: id, point }));
    }
}

/// The rectangles along the axes that are two triangles of an object and touch no other triangle in their plane: of larger shapes a table may have
/// other parts.
fn rectangles(object: &SceneObject) -> Vec<Aabb<3>> {
    let triangles: Vec<[Point3; 3]> = object.corners().collect();
    let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
    let tree = BoxTree::build(&boxes, 4);
    let mut found = Vec::new();
    for (&t, around) in triangles.iter().zip(&boxes) {
        let is_flat = |b: &Aabb<3>, axis: usize| b.min[axis] == b.max[axis];
        let Some(axis) = (0..3).find(|&axis| is_flat(around, axis)) else { continue };
        let mut near = Vec::new();
        let touches = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= around.max[k] && around.min[k] <= b.max[k]);
        tree.visit(touches, |i| near.push(i as usize));
        near.retain(|&i| is_flat(&boxes[i], axis) && touches(&boxes[i]));
        near.sort_unstable();
        let &[first, second] = &near[..] else { continue };
        let (a, b) = (triangles[first], triangles[second]);
        // Each of the two has three corners of the rectangle, and they have a diagonal in common.
        let is_corner = |p: &Point3| (0..3).all(|k| p[k] == around.min[k] || p[k] == around.max[k]);
        let opposite = |p: &Point3, q: &Point3| (0..3).all(|k| k == axis || p[k] != q[k]);
        let apart = |t: &[Point3; 3], other: &[Point3; 3]| t.iter().find(|p| !other.contains(p)).copied();
        let is_rectangle = a.iter().chain(&b).all(is_corner)
            && apart(&a, &b).zip(apart(&b, &a)).is_some_and(|(p, q)| opposite(&p, &q))
            && boxes[first] == boxes[second];
        if is_rectangle && t == a {
            found.push(*around);
        }
    }
    found
}

/// A point in a closed box that is on a rectangle of a mirror, and on no part for each side of it on which the box is.
fn missing_in_space(bounds: &Aabb<3>, rectangle: &Aabb<3>, parts: &[&MirrorRecord]) -> Option<Point3> {
    let axis = (0..3).find(|&k| rectangle.min[k] == rectangle.max[k])?;
    let place = rectangle.min[axis];
    if place < bounds.min[axis] || bounds.max[axis] < place {
        return None;
    }
    let across = [(axis + 1) % 3, (axis + 2) % 3];
    let parts: Vec<(Aabb<3>, bool)> = parts
        .iter()
        .filter_map(|part| Some((Aabb::around(part.points.iter().copied()), turn(&part.points, axis)? > 0)))
        .filter(|(b, _)| b.min[axis] == place && b.max[axis] == place)
        .collect();
    let [u, v] = across.map(|k| {
        let range = [rectangle.min[k].max(bounds.min[k]), rectangle.max[k].min(bounds.max[k])];
        middles(range, parts.iter().flat_map(|(b, _)| [b.min[k], b.max[k]]).collect())
    });
    let point = |[u, v]: [f64; 2]| {
        let mut p = [place; 3];
        (p[across[0]], p[across[1]]) = (u, v);
        p
    };
    let sides = [(true, place < bounds.max[axis]), (false, bounds.min[axis] < place)];
    pairs(&u, &v).into_iter().map(point).find(|p| {
        let has = |up: bool| parts.iter().any(|(b, looks_up)| *looks_up == up && b.contains(*p));
        sides.iter().any(|&(up, is_there)| is_there && !has(up))
    })
}

fn by_cell(table: &Table) -> Vec<Vec<&MirrorRecord>> {
    let mut by_cell = vec![Vec::new(); table.n_cells()];
    table.mirrors().iter().for_each(|part| by_cell[part.cell.idx()].push(part));
    by_cell
}
