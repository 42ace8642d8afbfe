//! Boxes in space and the rectangular portals between them.

use crate::graph::{CellGraph, Exit, Space};
use sightlines_geometry::{Aabb, AxialDoor};

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

impl CellGraph<Axial> {
    /// The portal that `exit` crosses, as seen by who crosses it.
    #[inline]
    pub fn door(&self, exit: &Exit) -> AxialDoor {
        let shape = self.portal(exit.portal).shape;
        if exit.forward { shape } else { shape.reversed() }
    }
}
