//! Convex cells of the plane and the portals between them.

use crate::graph::{CellGraph, Exit, PortalId, Space};
use sightlines_geometry::{Aabb, Orient2d, Point2, Portal2, SmallGrid, is_convex_ccw, orient2d};
use sightlines_pvs::CellId;

/// The plane: convex polygons joined by segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Planar;

impl Space for Planar {
    type Cell = ConvexCell2;
    type Portal = Portal2;
}

/// A convex polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexCell2 {
    /// Corners, counter-clockwise; straight angles are allowed.
    pub polygon: Vec<Point2>,
    /// The groups (Doom sectors) that the lines assign to the region around the cell, ascending. Empty where no line
    /// names one; more than one where the lines around the region disagree.
    pub groups: Vec<u32>,
}

impl ConvexCell2 {
    /// Smallest box around the cell.
    pub fn bounds(&self) -> Aabb<2> {
        Aabb::around(self.polygon.iter().map(|p| [p.x, p.y]))
    }
}

/// What is wrong with a planar graph.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WellFormedError {
    /// A cell is not a convex polygon with counter-clockwise corners.
    #[error("cell {0} is not convex and counter-clockwise")]
    NotConvex(CellId),
    /// A cell's groups are not ascending.
    #[error("the groups of cell {0} are not ascending")]
    Groups(CellId),
    /// A portal does not lie on a side of one of its cells, with that cell on the right hand.
    #[error("portal {} is not on the boundary of cell {}", portal.0, cell)]
    OffBoundary {
        /// The portal.
        portal: PortalId,
        /// The cell.
        cell: CellId,
    },
    /// Two portals of a cell share a side number but not a line, or the reverse.
    #[error("portals {} and {} of cell {} disagree about their sides", portals[0].0, portals[1].0, cell)]
    Sides {
        /// The cell.
        cell: CellId,
        /// The portals.
        portals: [PortalId; 2],
    },
}

impl CellGraph<Planar> {
    /// The portal that `exit` crosses, as seen by who crosses it.
    #[inline]
    pub fn crossing(&self, exit: &Exit) -> Portal2 {
        let shape = self.portal(exit.portal).shape;
        if exit.forward { shape } else { shape.reversed() }
    }

    /// The predicate for small grids, if all corners of cells and ends of portals are on one; then the
    /// corners of boxes around cells are too.
    pub fn small_grid(&self) -> Option<SmallGrid> {
        let ends = self.portals().iter().flat_map(|p| [p.shape.left, p.shape.right]);
        let corners = self.cells().iter().flat_map(|c| c.polygon.iter().copied());
        SmallGrid::covering(ends.chain(corners))
    }

    /// Checks what the crate promises of a planar graph: convex cells, portals on the sides of both
    /// their cells and rightly oriented, side numbers that mean straight sides. Exact; O(size).
    ///
    /// # Errors
    /// The first [`WellFormedError`].
    pub fn check_well_formed(&self) -> Result<(), WellFormedError> {
        for id in self.cell_ids() {
            let cell = self.cell(id);
            if !is_convex_ccw(&cell.polygon) {
                return Err(WellFormedError::NotConvex(id));
            }
            if !cell.groups.is_sorted_by(|a, b| a < b) {
                return Err(WellFormedError::Groups(id));
            }
            self.check_exits(id)?;
        }
        Ok(())
    }

    fn check_exits(&self, cell: CellId) -> Result<(), WellFormedError> {
        let exits = self.exits(cell);
        for exit in exits {
            // Who leaves a cell across a side has the cell behind: the side runs from right to left.
            let Portal2 { left, right } = self.crossing(exit);
            if !on_side(&self.cell(cell).polygon, right, left) {
                return Err(WellFormedError::OffBoundary { portal: exit.portal, cell });
            }
        }
        for pair in exits.windows(2) {
            let (p, q) = (self.crossing(&pair[0]), self.crossing(&pair[1]));
            let straight = orient2d(p.left, p.right, q.left) == 0.0 && orient2d(p.left, p.right, q.right) == 0.0;
            if straight != (pair[0].side == pair[1].side) {
                return Err(WellFormedError::Sides { cell, portals: [pair[0].portal, pair[1].portal] });
            }
        }
        Ok(())
    }

    /// Panics unless the graph is well formed; for tests.
    ///
    /// # Panics
    /// With the first defect.
    pub fn assert_well_formed(&self) {
        if let Err(error) = self.check_well_formed() {
            panic!("the cell graph is not well formed: {error}");
        }
    }
}

/// Whether `from` to `to` runs along the boundary of a convex counter-clockwise polygon.
fn on_side(polygon: &[Point2], from: Point2, to: Point2) -> bool {
    let adaptive = sightlines_geometry::Adaptive;
    let inside = polygon.iter().all(|&corner| adaptive.orient(from, to, corner) >= 0.0);
    let on_line: Vec<Point2> = polygon.iter().copied().filter(|&c| adaptive.orient(from, to, c) == 0.0).collect();
    let reach = Aabb::around(on_line.iter().map(|c| [c.x, c.y]));
    from != to && inside && on_line.len() >= 2 && [from, to].iter().all(|p| reach.contains([p.x, p.y]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Portal;

    fn square(x: f64) -> ConvexCell2 {
        let p = |dx: f64, y: f64| Point2::new(x + dx, y);
        ConvexCell2 { polygon: vec![p(0., 0.), p(1., 0.), p(1., 1.), p(0., 1.)], groups: vec![] }
    }

    fn door() -> Portal<Planar> {
        let shape = Portal2 { left: Point2::new(1., 0.75), right: Point2::new(1., 0.25) };
        Portal { cells: [CellId(0), CellId(1)], sides: [1, 3], shape }
    }

    #[test]
    fn two_rooms_are_well_formed() {
        let graph = CellGraph::<Planar>::new(vec![square(0.), square(1.)], vec![door()]);
        graph.assert_well_formed();
        let [exit] = graph.exits(CellId(1)) else { panic!("one door") };
        assert_eq!((exit.to, exit.side, exit.entry_side, exit.forward), (CellId(0), 3, 1, false));
        assert_eq!(graph.crossing(exit), door().shape.reversed());
    }

    #[test]
    fn defects_are_found() {
        let with = |cells: Vec<ConvexCell2>, portals| CellGraph::<Planar>::new(cells, portals).check_well_formed();
        let mut twisted = door();
        twisted.shape = twisted.shape.reversed();
        assert!(matches!(with(vec![square(0.), square(1.)], vec![twisted]), Err(WellFormedError::OffBoundary { .. })));
        let mut second = door();
        second.sides = [2, 3];
        assert!(matches!(with(vec![square(0.), square(1.)], vec![door(), second]), Err(WellFormedError::Sides { .. })));
        let mut clockwise = square(0.);
        clockwise.polygon.reverse();
        assert_eq!(with(vec![clockwise], vec![]), Err(WellFormedError::NotConvex(CellId(0))));
    }
}
