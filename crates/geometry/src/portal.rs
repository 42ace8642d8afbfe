//! Openings of the plane, as who walks through them sees them.

use crate::Point2;

/// An open segment, named as a viewer sees it who crosses it: the ends do not belong to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Portal2 {
    /// End on the viewer's left.
    pub left: Point2,
    /// End on the viewer's right.
    pub right: Point2,
}

impl Portal2 {
    /// The same portal for a viewer who crosses it the other way.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self { left: self.right, right: self.left }
    }
}
