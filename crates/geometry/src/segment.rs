//! Segments of the plane.

use crate::{Point2, orient2d};

/// A directed segment from `a` to `b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment2 {
    /// Start.
    pub a: Point2,
    /// End.
    pub b: Point2,
}

impl Segment2 {
    /// The segment from `a` to `b`.
    pub const fn new(a: Point2, b: Point2) -> Self {
        Self { a, b }
    }

    /// Whether the two segments cross in one point that is inside both. Exact.
    pub fn crosses(&self, other: &Self) -> bool {
        let side = |s: &Self, p: Point2| orient2d(s.a, s.b, p);
        let opposite = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
        opposite(side(self, other.a), side(self, other.b)) && opposite(side(other, self.a), side(other, self.b))
    }

    /// Whether `p` lies on the segment, its end points included. Exact.
    pub fn contains(&self, p: Point2) -> bool {
        let between = |lo: f64, x: f64, hi: f64| lo.min(hi) <= x && x <= lo.max(hi);
        between(self.a.x, p.x, self.b.x) && between(self.a.y, p.y, self.b.y) && orient2d(self.a, self.b, p) == 0.0
    }

    /// Whether the closed segments have a point in common. Exact.
    pub fn meets(&self, other: &Self) -> bool {
        self.crosses(other)
            || self.contains(other.a)
            || self.contains(other.b)
            || other.contains(self.a)
            || other.contains(self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn s(ax: f64, ay: f64, bx: f64, by: f64) -> Segment2 {
        Segment2::new(Point2::new(ax, ay), Point2::new(bx, by))
    }

    #[test]
    fn crossing_is_proper_and_meeting_is_closed() {
        let base = s(0.0, 0.0, 4.0, 0.0);
        assert!(base.crosses(&s(1.0, -1.0, 1.0, 1.0)));
        for touching in [s(1.0, 0.0, 1.0, 1.0), s(4.0, 0.0, 5.0, 1.0), s(1.0, 0.0, 9.0, 0.0)] {
            assert!(!base.crosses(&touching) && base.meets(&touching), "{touching:?}");
        }
        assert!(!base.meets(&s(5.0, 0.0, 6.0, 0.0)));
    }
}
