//! Closed rooms that show only back sides.

use crate::coplanar::FlatRect;
use crate::face::AxialFace;
use crate::flat::covered_by;
use crate::mesh::{TriangleKind, kind_of, others};
use crate::rooms::Rooms;
use crate::scene_faces::{Survey, flat};
use crate::touch::{Meets, visit_cells};
use crate::tree::AxialTree;
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::{Aabb, Point2, orient2d};

/// For each given room, whether it is hollow: closed on all sides, including the ends of the tree; nothing is inside
/// its cells; and no triangle faces them. Errs towards "no".
pub(crate) fn hollow_rooms(
    scene: &Scene,
    survey: &Survey,
    faces: &[AxialFace<3>],
    tree: &AxialTree<3>,
    rooms: &Rooms,
    candidates: Vec<bool>,
) -> Vec<bool> {
    let mut hollow =
        Hollow { n_left: candidates.iter().filter(|is_candidate| **is_candidate).count(), rooms: candidates };
    let ends = Ends::of(tree.bounds(), faces);
    let is_open = |cells: &[u32]| !cells.iter().all(|&c| ends.close(&tree.cells()[c as usize].bounds));
    for (room, cells) in rooms.cells.iter().enumerate() {
        if hollow.rooms[room] && is_open(cells) {
            hollow.rule_out(room);
        }
    }
    let objects = scene.objects().iter().zip(&survey.shapes).zip(&survey.detail);
    for (id, ((object, shape), &is_detail)) in (0u32..).zip(objects) {
        if hollow.n_left == 0 {
            break;
        }
        if scene.moving().binary_search_by_key(&id, |moving| moving.object).is_ok() {
            // Wherever it may be.
            visit_inside(tree, &scene.extent(id), |cell| hollow.rule_out(rooms.of_cell[cell] as usize));
        } else if !scene.is_opaque(id) {
            // Both sides are seen.
            for [a, b, c] in object.corners() {
                show(&[a, b, c], tree, rooms, &mut hollow);
                show(&[a, c, b], tree, rooms, &mut hollow);
            }
        } else if is_detail {
            // The box around a small thing is small.
            visit_inside(tree, &shape.bounds, |cell| hollow.rule_out(rooms.of_cell[cell] as usize));
        } else {
            object.corners().for_each(|corners| show(&corners, tree, rooms, &mut hollow));
        }
    }
    hollow.rooms
}

/// The rooms that may still be hollow.
struct Hollow {
    rooms: Vec<bool>,
    /// How many there are.
    n_left: usize,
}

impl Hollow {
    fn rule_out(&mut self, room: usize) {
        self.n_left -= usize::from(std::mem::take(&mut self.rooms[room]));
    }
}

fn visit_inside(tree: &AxialTree<3>, extent: &Aabb<3>, mut visit: impl FnMut(usize)) {
    visit_cells(tree, extent, [Meets::Inside; 3], |cell| {
        visit(cell.idx());
        true
    });
}

/// Marks the rooms that have a triangle inside, or in front of which it is.
fn show(corners: &[Point3; 3], tree: &AxialTree<3>, rooms: &Rooms, hollow: &mut Hollow) {
    let extent = Aabb::around(*corners);
    let mut meets = [Meets::Inside; 3];
    let mut across = vec![0, 1, 2];
    match kind_of(corners) {
        TriangleKind::Empty => return,
        TriangleKind::Other => {}
        TriangleKind::Flat(flat) => {
            // A flat triangle inside of a cell is found by this too.
            meets[flat.axis] = if flat.up { Meets::Above } else { Meets::Below };
            across = vec![flat.axis];
        }
    }
    visit_cells(tree, &extent, meets, |cell| {
        let (bounds, room) = (&tree.cells()[cell.idx()].bounds, rooms.of_cell[cell.idx()] as usize);
        if hollow.rooms[room] && across.iter().all(|&axis| overlap(corners, bounds, axis)) {
            hollow.rule_out(room);
        }
        hollow.n_left > 0
    });
}

/// Whether a triangle and the inside of a box have a point in common as seen along `axis`. Exact.
pub(crate) fn overlap(corners: &[Point3; 3], cell: &Aabb<3>, axis: usize) -> bool {
    let [u, v] = others(axis);
    let flat = corners.map(|p| Point2::new(p[u], p[v]));
    let (lo, hi) = (Point2::new(cell.min[u], cell.min[v]), Point2::new(cell.max[u], cell.max[v]));
    let beside = flat.iter().all(|p| p.x <= lo.x)
        || flat.iter().all(|p| p.x >= hi.x)
        || flat.iter().all(|p| p.y <= lo.y)
        || flat.iter().all(|p| p.y >= hi.y);
    !beside && !(0..3).any(|i| separates([flat[i], flat[(i + 1) % 3], flat[(i + 2) % 3]], lo, hi))
}

/// Whether the line through `a` and `b` has the rectangle on one side and `c` on the other.
fn separates([a, b, c]: [Point2; 3], lo: Point2, hi: Point2) -> bool {
    let corners = [lo, Point2::new(hi.x, lo.y), hi, Point2::new(lo.x, hi.y)];
    let (third, sides) = (orient2d(a, b, c), corners.map(|p| orient2d(a, b, p)));
    a != b && ((third <= 0.0 && sides.iter().all(|s| *s >= 0.0)) || (third >= 0.0 && sides.iter().all(|s| *s <= 0.0)))
}

/// The faces on the borders of the tree, which divide no cell but close some.
struct Ends {
    bounds: Aabb<3>,
    /// For each axis the faces on the lower, then on the upper border.
    faces: [[Vec<FlatRect>; 2]; 3],
}

impl Ends {
    fn of(bounds: Aabb<3>, faces: &[AxialFace<3>]) -> Self {
        let on = |axis: usize, at: f64| faces.iter().filter(|f| f.axis == axis && f.at == at).map(flat).collect();
        Self { bounds, faces: std::array::from_fn(|k| [on(k, bounds.min[k]), on(k, bounds.max[k])]) }
    }

    /// Whether faces cover every side of a cell that the tree ends at.
    fn close(&self, cell: &Aabb<3>) -> bool {
        (0..3).all(|k| {
            let [u, v] = others(k);
            let side = FlatRect { u: [cell.min[u], cell.max[u]], v: [cell.min[v], cell.max[v]] };
            let closed = |i: usize| covered_by(&side, self.faces[k][i].iter().copied());
            (cell.min[k] != self.bounds.min[k] || closed(0)) && (cell.max[k] != self.bounds.max[k] || closed(1))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_seen_where_they_are() {
        let cell = Aabb { min: [0.0; 3], max: [2.0; 3] };
        let seen = |corners: [Point3; 3]| (0..3).map(|k| overlap(&corners, &cell, k)).collect::<Vec<_>>();
        // Cuts off a corner of the cell; then touches the corner; then runs along an edge.
        assert_eq!(seen([[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]), [true; 3]);
        assert_eq!(seen([[4., 0., 1.], [0., 4., 1.], [4., 4., 1.]]), [true, true, false]);
        assert_eq!(seen([[4.5, 0., 1.], [0., 4.5, 1.], [4., 4., 1.]]), [true, true, false]);
        assert_eq!(seen([[3.5, 0., 1.], [0., 3.5, 1.], [4., 4., 1.]]), [true; 3]);
        // Seen edge-on: a segment, through the middle or along the diagonal's neighbour.
        assert_eq!(seen([[0., 0., 0.], [2., 2., 0.], [2., 2., 2.]]), [true; 3]);
        assert_eq!(seen([[2., 0., 0.], [4., 2., 0.], [4., 2., 2.]]), [true, false, false]);
    }
}
