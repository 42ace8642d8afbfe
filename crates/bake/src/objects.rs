//! Which objects touch which cells.

use sightlines_cells::{ConvexCell2, PlanObject};
use sightlines_geometry::{Aabb, Point2, orient2d};
use sightlines_pvs::ObjectId;

/// Lists of indices as lists of ids.
pub(crate) fn object_lists(lists: Vec<Vec<u32>>) -> Vec<Vec<ObjectId>> {
    lists.into_iter().map(|list| list.into_iter().map(ObjectId).collect()).collect()
}

/// For each cell the objects that meet it, ascending; touching counts. Exact.
pub(crate) fn cell_objects(cells: &[ConvexCell2], objects: &[PlanObject]) -> Vec<Vec<u32>> {
    let touching = |cell: &ConvexCell2| {
        let bounds = cell.bounds();
        let meets = |o: &PlanObject| boxes_meet(&bounds, &o.bounds) && sides_meet(&cell.polygon, &o.bounds);
        (0u32..).zip(objects).filter(|(_, o)| meets(o)).map(|(i, _)| i).collect()
    };
    cells.iter().map(touching).collect()
}

fn boxes_meet(a: &Aabb<2>, b: &Aabb<2>) -> bool {
    (0..2).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Whether no side of the polygon has the whole box strictly outside. With the boxes meeting, that is
/// the separating-axis test of two convex polygons.
fn sides_meet(polygon: &[Point2], bounds: &Aabb<2>) -> bool {
    let [x, y] = [[bounds.min[0], bounds.max[0]], [bounds.min[1], bounds.max[1]]];
    let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| Point2::new(x[i], y[j]));
    let n = polygon.len();
    (0..n).all(|i| corners.iter().any(|&c| orient2d(polygon[i], polygon[(i + 1) % n], c) >= 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> ConvexCell2 {
        let polygon = [(0., 0.), (4., 0.), (0., 4.)].map(|(x, y)| Point2::new(x, y)).to_vec();
        ConvexCell2 { polygon, groups: vec![] }
    }

    fn object(min: [f64; 2], max: [f64; 2]) -> PlanObject {
        PlanObject { name: String::new(), bounds: Aabb { min, max } }
    }

    #[test]
    fn objects_touch_cells_exactly() {
        let inside = object([1., 1.], [1., 1.]);
        let on_side = object([2., 2.], [3., 3.]);
        let past_side = object([2.5, 2.], [3., 3.]);
        let outside = object([5., 0.], [6., 1.]);
        let around = object([-1., -1.], [9., 9.]);
        let touched = cell_objects(&[cell()], &[inside, on_side, past_side, outside, around]);
        assert_eq!(touched, [vec![0, 1, 4]]);
    }
}
