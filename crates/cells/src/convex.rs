//! Convex polyhedra as cells and the convex polygons between them.

use crate::graph::{CellGraph, Portal, Space};
use sightlines_geometry::{Aabb, Portal3};
use sightlines_pvs::CellId;

/// Space, cut into convex polyhedra that are joined by convex polygons.
#[derive(Debug, Clone, PartialEq)]
pub struct Convex;

impl Space for Convex {
    type Cell = ConvexCell3;
    type Portal = Portal3;
}

/// A convex polyhedron, of which nothing is known but what its portals say. Where leafs of a map were merged it may be of any shape, and
/// nothing hides inside of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvexCell3 {
    /// The box around its portals; empty for a cell without any.
    pub bounds: Aabb<3>,
}

impl CellGraph<Convex> {
    /// Joins `n_cells` cells by portals: the two cells, and the polygon as seen when crossing from the first
    /// into the second. Every portal is a side of its own. O(n log n).
    ///
    /// # Panics
    /// As [`CellGraph::new`].
    pub fn of_portals(n_cells: usize, portals: Vec<([CellId; 2], Portal3)>) -> Self {
        let mut cells = vec![ConvexCell3 { bounds: Aabb::EMPTY }; n_cells];
        let mut n_sides = vec![0u32; n_cells];
        let join = |(pair, shape): ([CellId; 2], Portal3)| {
            let sides = pair.map(|cell| {
                let bounds = &mut cells[cell.idx()].bounds;
                *bounds = shape.corners().iter().fold(*bounds, |b, &p| b.with(p));
                n_sides[cell.idx()] += 1;
                n_sides[cell.idx()] - 1
            });
            Portal { cells: pair, sides, shape }
        };
        let portals = portals.into_iter().map(join).collect();
        Self::new(cells, portals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portals_make_the_graph() {
        let square = |x: f64| {
            let points = [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]];
            Portal3::around(&points).unwrap()
        };
        let graph = CellGraph::of_portals(
            4,
            vec![([CellId(0), CellId(1)], square(1.0)), ([CellId(2), CellId(1)], square(2.0).reversed())],
        );
        let exits = graph.exits(CellId(1));
        assert_eq!(
            exits.iter().map(|e| (e.to, e.forward, e.side)).collect::<Vec<_>>(),
            [(CellId(0), false, 0), (CellId(2), false, 1)]
        );
        assert_eq!(graph.cell(CellId(1)).bounds, Aabb { min: [1.0, 0.0, 0.0], max: [2.0, 1.0, 1.0] });
        assert!(graph.cell(CellId(3)).bounds.is_empty());
    }
}
