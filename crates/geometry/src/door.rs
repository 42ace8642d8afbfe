//! Axis-aligned rectangles in space, as who passes through them sees them.

use crate::Aabb;

/// An open rectangle on a plane perpendicular to an axis, with the direction in which it is crossed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialDoor {
    /// The rectangle: `min[axis] == max[axis]`, and `min < max` along the other two axes.
    pub extent: Aabb<3>,
    /// The axis that the rectangle is perpendicular to: 0, 1 or 2.
    pub axis: u8,
    /// Whether it is crossed towards larger coordinates.
    pub forward: bool,
}

impl AxialDoor {
    /// The same door for a viewer who crosses it the other way.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self { forward: !self.forward, ..self }
    }

    /// Where its plane meets its axis.
    pub const fn at(&self) -> f64 {
        self.extent.min[self.axis as usize]
    }
}

/// A rectangle on a plane perpendicular to an axis that hides from one side: it stops whoever comes from its front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneWayRectangle {
    /// A box that is flat along one axis, in scene units.
    pub bounds: Aabb<3>,
    /// Whether its front faces larger coordinates of that axis, so that it stops lines towards smaller ones.
    pub front_up: bool,
}
