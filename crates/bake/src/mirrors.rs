//! Which parts of mirrors lie on which cells.
//!
//! A mirror reflects on the side of a cell where it lies on the cell's border. Ends and corners of a part are end points of
//! mirrors and of cells: nothing is computed.

use sightlines_cells::{Axial, CellGraph, CellId, LineId, Plan, PlanLine, Planar, Scene};
use sightlines_geometry::{Aabb, Point2, orient2d};
use sightlines_kdtree::{AxialFace, SceneOptions, scene_faces};
use sightlines_pvs::{MirrorId, MirrorRecord};

/// The parts of mirrors, and the mirrors without.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct MirrorParts {
    /// Cell by cell, and in each by face.
    pub(crate) parts: Vec<MirrorRecord>,
    /// Lines of which a part is on no cell; rectangles of which on each side a part is in no cell.
    pub(crate) n_lost: usize,
    /// Triangles of mirrors that are not perpendicular to an axis, in space.
    pub(crate) n_other_triangles: usize,
    /// Objects that are mirrors and move, in space.
    pub(crate) n_moving: usize,
}

/// The parts of a plan's mirrors: where a side of a cell and a mirror lie on one line, exactly, and overlap. The face is
/// the line's id.
///
/// Where the lines of a plan cross at points that no double has, they are bent there, and their pieces are no longer on
/// one line with them: such pieces are left out, and counted, as are those that no cell has. O(sides × mirrors).
pub(crate) fn of_plan(graph: &CellGraph<Planar>, plan: &Plan) -> MirrorParts {
    let mut out = MirrorParts::default();
    let mut covered: Vec<Vec<[f64; 2]>> = vec![Vec::new(); plan.mirrors().len()];
    for cell in graph.cell_ids() {
        let polygon = &graph.cell(cell).polygon;
        for (&LineId(face), covered) in plan.mirrors().iter().zip(&mut covered) {
            let line = &plan.lines()[face as usize];
            for i in 0..polygon.len() {
                let side = [polygon[i], polygon[(i + 1) % polygon.len()]];
                let Some([from, to]) = overlap(side, line) else { continue };
                covered.push(interval(line, from, to));
                // Cells are counter-clockwise: as seen from inside, the end of a side is on the left.
                let points = [to, from].map(|p| [p.x, p.y, 0.0]).to_vec();
                out.parts.push(MirrorRecord { cell, mirror: MirrorId(face), points });
            }
        }
    }
    let has_gap = |(&LineId(face), mut covered): (&LineId, Vec<[f64; 2]>)| {
        let line = &plan.lines()[face as usize];
        let [low, high] = interval(line, line.a, line.b);
        covered.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let reached =
            covered.iter().fold(low, |reached, part| if part[0] <= reached { reached.max(part[1]) } else { reached });
        reached < high
    };
    out.n_lost = plan.mirrors().iter().zip(covered).map(has_gap).filter(|has_gap| *has_gap).count();
    out
}

/// The axis along which a line is longer.
fn axis_of(line: &PlanLine) -> usize {
    usize::from((line.b.y - line.a.y).abs() > (line.b.x - line.a.x).abs())
}

/// Where two points of a line are along the axis that it runs along, ascending.
fn interval(line: &PlanLine, p: Point2, q: Point2) -> [f64; 2] {
    let axis = axis_of(line);
    let [p, q] = [p.to_array()[axis], q.to_array()[axis]];
    [p.min(q), p.max(q)]
}

/// What a side of a cell and a line have in common, in the direction of the side: two different points that are ends of
/// one or of the other.
fn overlap([from, to]: [Point2; 2], line: &PlanLine) -> Option<[Point2; 2]> {
    if orient2d(line.a, line.b, from) != 0.0 || orient2d(line.a, line.b, to) != 0.0 {
        return None;
    }
    let axis = axis_of(line);
    let along = |p: Point2| p.to_array()[axis];
    let [low, high] = if along(line.a) < along(line.b) { [line.a, line.b] } else { [line.b, line.a] };
    let [first, last] = if along(from) < along(to) { [from, to] } else { [to, from] };
    let start = if along(first) < along(low) { low } else { first };
    let end = if along(last) > along(high) { high } else { last };
    if along(start) >= along(end) {
        return None;
    }
    Some(if along(from) < along(to) { [start, end] } else { [end, start] })
}

/// The parts of a scene's mirrors: of the rectangles that their axis-aligned triangles make, what is in each closed cell,
/// looking into it. A mirror reflects on both sides, whichever way its triangles look; where it lies inside a cell, because
/// the cell was not cut along it, that cell has both. Faces count the rectangles of all mirrors, object by object.
///
/// A mirror that moves has no part: where it reflects at rest it soon does not, and where else it does, a table cannot hold.
///
/// O(rectangles × cells).
pub(crate) fn of_scene(graph: &CellGraph<Axial>, scene: &Scene) -> MirrorParts {
    let mut out = MirrorParts::default();
    let mut faces = Vec::new();
    for &object in scene.mirrors() {
        if scene.moving().binary_search_by_key(&object, |moving| moving.object).is_ok() {
            out.n_moving += 1;
            continue;
        }
        let alone = Scene::new(vec![scene.objects()[object as usize].clone()]).expect("an object of a scene makes one");
        // Nothing of a mirror is detail.
        let found = scene_faces(&alone, &SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() });
        out.n_other_triangles += found.n_other_triangles;
        faces.extend(found.faces);
    }
    let mut areas = vec![[0.0; 2]; faces.len()];
    for cell in graph.cell_ids() {
        let bounds = graph.cell(cell).bounds;
        for (k, face) in faces.iter().enumerate() {
            let Some(part) = common(face, &bounds) else { continue };
            let [below, above] = [bounds.min[face.axis] < face.at, face.at < bounds.max[face.axis]];
            for (from_above, _) in [(false, below), (true, above)].into_iter().filter(|side| side.1) {
                out.parts.push(record(cell, k as u32, face.axis, &part, from_above));
                areas[k][usize::from(from_above)] += area(&part, face.axis);
            }
        }
    }
    // Cells on one side of a rectangle are disjoint, so what they have adds up. Sums are rounded, and only counted.
    let is_lost = |(face, areas): (&AxialFace<3>, &[f64; 2])| {
        let whole = area(&Aabb { min: face.min, max: face.max }, face.axis);
        areas[0].max(areas[1]) < whole * (1.0 - 1e-9)
    };
    out.n_lost = faces.iter().zip(&areas).filter(|both| is_lost(*both)).count();
    out
}

/// What a rectangle has in common with a closed box, if that has an area.
fn common(face: &AxialFace<3>, bounds: &Aabb<3>) -> Option<Aabb<3>> {
    let min: [f64; 3] = std::array::from_fn(|k| face.min[k].max(bounds.min[k]));
    let max: [f64; 3] = std::array::from_fn(|k| face.max[k].min(bounds.max[k]));
    let has_area = (0..3).all(|k| if k == face.axis { min[k] <= max[k] } else { min[k] < max[k] });
    has_area.then_some(Aabb { min, max })
}

fn area(rect: &Aabb<3>, axis: usize) -> f64 {
    (0..3).filter(|&k| k != axis).map(|k| rect.max[k] - rect.min[k]).product()
}

/// A rectangle, counter-clockwise as seen from above its plane or from below.
fn record(cell: CellId, face: u32, axis: usize, rect: &Aabb<3>, from_above: bool) -> MirrorRecord {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |high_u: bool, high_v: bool| {
        let mut p = rect.min;
        p[u] = if high_u { rect.max[u] } else { rect.min[u] };
        p[v] = if high_v { rect.max[v] } else { rect.min[v] };
        p
    };
    // The turn from u to v is counter-clockwise about the axis, which points to a viewer above.
    let mut points = vec![corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
    if !from_above {
        points.reverse();
    }
    MirrorRecord { cell, mirror: MirrorId(face), points }
}
