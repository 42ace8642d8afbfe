//! Which cells of a tree something is in, or lies against.

use crate::tree::{AxialNode, AxialTree};
use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;

/// How a box has to lie to a cell along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meets {
    /// It meets the inside of the cell.
    Inside,
    /// It is flat, and meets the inside of the cell when moved up by a little.
    Above,
    /// It is flat, and meets the inside of the cell when moved down by a little.
    Below,
}

impl Meets {
    /// Whether it meets what is below a plane at `at`, if it meets what the plane divides.
    fn low(self, lo: f64, at: f64) -> bool {
        if self == Self::Below { lo <= at } else { lo < at }
    }

    /// Whether it meets what is above a plane at `at`, if it meets what the plane divides.
    fn high(self, hi: f64, at: f64) -> bool {
        if self == Self::Above { hi >= at } else { hi > at }
    }
}

/// Calls `visit` for every cell that the closed box `extent` meets, as `meets` specifies for each axis, in ascending
/// order, until it returns false. Exact: only compares coordinates.
pub(crate) fn visit_cells<const D: usize>(
    tree: &AxialTree<D>,
    extent: &Aabb<D>,
    meets: [Meets; D],
    mut visit: impl FnMut(CellId) -> bool,
) {
    let whole = tree.bounds();
    let inside = |k: usize| meets[k].low(extent.min[k], whole.max[k]) && meets[k].high(extent.max[k], whole.min[k]);
    let mut stack = if (0..D).all(inside) { vec![0] } else { vec![] };
    while let Some(node) = stack.pop() {
        match tree.nodes()[node as usize] {
            AxialNode::Leaf(cell) => {
                if !visit(cell) {
                    return;
                }
            }
            AxialNode::Inner { axis, at, low, high } => {
                if meets[axis].high(extent.max[axis], at) {
                    stack.push(high);
                }
                if meets[axis].low(extent.min[axis], at) {
                    stack.push(low);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{KdOptions, subdivide};
    use crate::face::AxialFace;

    fn cells(extent: [[f64; 2]; 2], meets: [Meets; 2]) -> Vec<u32> {
        // Three columns: x from 0 to 1, 1 to 3, 3 to 4.
        let walls = [1.0, 3.0].map(|x| AxialFace::new(0, [x, 0.0], [x, 2.0]));
        let tree = subdivide(&walls, Aabb { min: [0.0; 2], max: [4.0, 2.0] }, &KdOptions::default()).unwrap();
        let mut found = Vec::new();
        visit_cells(&tree, &Aabb { min: extent[0], max: extent[1] }, meets, |cell| {
            found.push(cell.0);
            true
        });
        found
    }

    #[test]
    fn cells_are_found_on_the_right_side() {
        use Meets::{Above, Below, Inside};
        assert_eq!(cells([[0.5, 0.5], [3.0, 1.0]], [Inside; 2]), [0, 1]);
        assert_eq!(cells([[1.0, 0.5], [1.0, 1.0]], [Inside; 2]), [], "between two");
        assert_eq!(cells([[1.0, 0.5], [1.0, 1.0]], [Above, Inside]), [1]);
        assert_eq!(cells([[1.0, 0.5], [1.0, 1.0]], [Below, Inside]), [0]);
        assert_eq!(cells([[2.0, 0.5], [2.0, 1.0]], [Below, Inside]), [1]);
        assert_eq!(cells([[0.0, 0.5], [0.0, 1.0]], [Above, Inside]), [0]);
        assert_eq!(cells([[0.0, 0.5], [0.0, 1.0]], [Below, Inside]), [], "outside");
        assert_eq!(cells([[4.0, 0.5], [4.0, 1.0]], [Above, Inside]), [], "outside");
        assert_eq!(cells([[4.0, 0.5], [4.0, 1.0]], [Inside; 2]), [], "on the border");
        assert_eq!(cells([[2.0, 2.0], [5.0, 2.0]], [Inside, Below]), [1, 2]);
        assert_eq!(cells([[4.5, 0.5], [5.0, 1.0]], [Inside; 2]), [], "outside");
        assert_eq!(cells([[-9.0, -9.0], [9.0, 9.0]], [Inside; 2]), [0, 1, 2]);
    }
}
