//! Boxes in space and the rectangular portals between them.

use crate::graph::{CellGraph, Exit, Portal, PortalId, Space};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_pvs::CellId;

/// Space, cut into boxes that are joined by axis-aligned rectangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Axial;

impl Space for Axial {
    type Cell = BoxCell;
    type Portal = AxialDoor;
}

/// A box. Its sides are numbered `2 * axis` (towards smaller coordinates) and `2 * axis + 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxCell {
    /// The box.
    pub bounds: Aabb<3>,
}

/// What is wrong with a graph of boxes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AxialDefect {
    /// A cell has no inside, or a corner that is not finite.
    #[error("cell {0} is not a box of positive extent")]
    NotABox(CellId),
    /// A portal is not a rectangle of positive extent on a plane of its axis.
    #[error("portal {} is not a rectangle across its axis", .0.0)]
    NotARectangle(PortalId),
    /// A portal's side numbers are not those of its axis and direction.
    #[error("portal {} has sides that do not fit its direction", .0.0)]
    Sides(PortalId),
    /// A portal is not on the right wall of one of its cells, or sticks out of it.
    #[error("portal {} is not on the wall of cell {}", portal.0, cell)]
    OffWall {
        /// The portal.
        portal: PortalId,
        /// The cell.
        cell: CellId,
    },
}

impl CellGraph<Axial> {
    /// The portal that `exit` crosses, as seen by who crosses it.
    #[inline]
    pub fn door(&self, exit: &Exit) -> AxialDoor {
        let shape = self.portal(exit.portal).shape;
        if exit.forward { shape } else { shape.reversed() }
    }

    /// Checks what the crate promises of a graph of boxes: cells with an inside; portals that are
    /// rectangles within the wall that their two cells share, on the side that the direction of
    /// crossing says; side numbers that mean these sides. Exact; O(size).
    ///
    /// Whether cells overlap is not looked at.
    ///
    /// # Errors
    /// The first [`AxialDefect`].
    pub fn check_well_formed(&self) -> Result<(), AxialDefect> {
        let bad = |id: &CellId| !is_box(&self.cell(*id).bounds);
        if let Some(id) = self.cell_ids().find(bad) {
            return Err(AxialDefect::NotABox(id));
        }
        (0u32..).map(PortalId).zip(self.portals()).try_for_each(|(id, portal)| self.check_portal(id, portal))
    }

    fn check_portal(&self, portal: PortalId, p: &Portal<Axial>) -> Result<(), AxialDefect> {
        let AxialDoor { extent, axis, forward } = p.shape;
        let k = usize::from(axis);
        if k > 2 || !is_rectangle(&extent, k) {
            return Err(AxialDefect::NotARectangle(portal));
        }
        let (below, above) = (2 * u32::from(axis) + 1, 2 * u32::from(axis));
        if p.sides != (if forward { [below, above] } else { [above, below] }) {
            return Err(AxialDefect::Sides(portal));
        }
        for (i, cell) in p.cells.into_iter().enumerate() {
            let b = &self.cell(cell).bounds;
            // The first cell is left, so going forward its wall is its upper one.
            let wall = if forward == (i == 0) { b.max[k] } else { b.min[k] };
            if wall != extent.min[k] || !b.contains(extent.min) || !b.contains(extent.max) {
                return Err(AxialDefect::OffWall { portal, cell });
            }
        }
        Ok(())
    }

    /// Panics unless the graph is well formed; for tests.
    ///
    /// # Panics
    /// With the first defect.
    pub fn assert_well_formed(&self) {
        if let Err(defect) = self.check_well_formed() {
            panic!("the cell graph is not well formed: {defect}");
        }
    }
}

fn is_box(b: &Aabb<3>) -> bool {
    (0..3).all(|k| b.min[k].is_finite() && b.max[k].is_finite() && b.min[k] < b.max[k])
}

fn is_rectangle(extent: &Aabb<3>, axis: usize) -> bool {
    (0..3).all(|k| if k == axis { extent.min[k] == extent.max[k] } else { extent.min[k] < extent.max[k] })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(x: f64) -> BoxCell {
        BoxCell { bounds: Aabb { min: [x, 0.0, 0.0], max: [x + 2.0, 2.0, 2.0] } }
    }

    fn door() -> Portal<Axial> {
        let extent = Aabb { min: [2.0, 0.5, 0.0], max: [2.0, 1.0, 2.0] };
        Portal { cells: [CellId(0), CellId(1)], sides: [1, 0], shape: AxialDoor { extent, axis: 0, forward: true } }
    }

    fn check(cells: Vec<BoxCell>, portal: Portal<Axial>) -> Result<(), AxialDefect> {
        CellGraph::<Axial>::new(cells, vec![portal]).check_well_formed()
    }

    #[test]
    fn two_boxes_are_well_formed() {
        let graph = CellGraph::<Axial>::new(vec![cell(0.0), cell(2.0)], vec![door()]);
        graph.assert_well_formed();
        let [exit] = graph.exits(CellId(1)) else { panic!("one door") };
        assert_eq!((exit.side, exit.entry_side, graph.door(exit)), (0, 1, door().shape.reversed()));
        // The same door listed from the other cell.
        let turned = Portal { cells: [CellId(1), CellId(0)], sides: [0, 1], shape: door().shape.reversed() };
        assert_eq!(check(vec![cell(0.0), cell(2.0)], turned), Ok(()));
    }

    #[test]
    fn defects_are_found() {
        let good = || vec![cell(0.0), cell(2.0)];
        let with = |change: fn(&mut Portal<Axial>)| {
            let mut portal = door();
            change(&mut portal);
            check(good(), portal).unwrap_err()
        };
        let id = PortalId(0);
        assert_eq!(
            check(vec![cell(0.0), BoxCell { bounds: Aabb::EMPTY }], door()),
            Err(AxialDefect::NotABox(CellId(1)))
        );
        assert_eq!(with(|p| p.shape.axis = 3), AxialDefect::NotARectangle(id));
        assert_eq!(with(|p| p.shape.extent.max[1] = 0.5), AxialDefect::NotARectangle(id));
        assert_eq!(with(|p| p.shape.extent.max[0] = 2.5), AxialDefect::NotARectangle(id));
        assert_eq!(with(|p| p.sides = [0, 1]), AxialDefect::Sides(id));
        assert_eq!(with(|p| p.sides = [3, 2]), AxialDefect::Sides(id));
        assert_eq!(with(|p| p.shape.forward = false), AxialDefect::Sides(id));
        assert_eq!(with(|p| p.cells.swap(0, 1)), AxialDefect::OffWall { portal: id, cell: CellId(1) });
        assert_eq!(with(|p| p.shape.extent.max[2] = 2.5), AxialDefect::OffWall { portal: id, cell: CellId(0) });
        let apart = check(vec![cell(0.0), cell(2.5)], door());
        assert_eq!(apart, Err(AxialDefect::OffWall { portal: id, cell: CellId(1) }));
        assert_eq!(apart.unwrap_err().to_string(), "portal 0 is not on the wall of cell 1");
    }
}
