//! Lines through two points, and the polygons that they pass.

use crate::stabber::Witness;
use sightlines_geometry::coordinate::MIN_MAGNITUDE;
use sightlines_geometry::{Point3, Portal3, check_coordinate, orient3d};
use std::borrow::Borrow;

/// A directed line, through `a` first and then `b`; a witness when it passes a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line3 {
    /// A point, scene units.
    pub a: Point3,
    /// Another point, further along.
    pub b: Point3,
}

impl Line3 {
    /// The line through two points, with magnitudes that predicates do not accept rounded to zero. `None` if the points
    /// coincide or are not finite.
    pub fn through(a: Point3, b: Point3) -> Option<Self> {
        let round = |x: f64| check_coordinate(if x.abs() < MIN_MAGNITUDE { 0.0 } else { x }).ok();
        let point = |p: Point3| Some([round(p[0])?, round(p[1])?, round(p[2])?]);
        let line = Self { a: point(a)?, b: point(b)? };
        (line.a != line.b).then_some(line)
    }

    /// Whether it has every edge of the polygon strictly on its inner side, that is, passes it in its direction. Exact
    /// for coordinates that [`check_coordinate`] accepts; O(corners).
    pub fn passes(&self, portal: &Portal3) -> bool {
        portal.edges().all(|[from, to]| orient3d(self.a, self.b, from, to) > 0.0)
    }

    /// The same line in the other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self { a: self.b, b: self.a }
    }
}

impl<P: Borrow<Portal3>> Witness<P> for Line3 {
    fn passes(&self, portal: &P) -> bool {
        self.passes(portal.borrow())
    }
}
