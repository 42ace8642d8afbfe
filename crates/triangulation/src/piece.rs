//! Pieces of lines, where they are cut, and how far rounding reaches.

use crate::grid::PointGrid;
use sightlines_geometry::{Point2, Segment2, orient2d};

/// Part of a line of a plan, in the line's direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Start.
    pub a: Point2,
    /// End, different from the start.
    pub b: Point2,
    /// Whether it blocks sight.
    pub opaque: bool,
    /// Index of the line; [`JOINT`] for a joint.
    pub line: u32,
}

/// In place of the index of a line: a joint of the plan, which names no groups.
pub const JOINT: u32 = u32::MAX;

impl Piece {
    pub(crate) fn segment(&self) -> Segment2 {
        Segment2::new(self.a, self.b)
    }
}

/// Where a line is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cut {
    /// One piece ends and the next begins at a point, which may be off the line by rounding.
    At(Point2),
    /// The line stops at the first point and goes on at the second.
    Gap(Point2, Point2),
}

/// Bound on the distance between a crossing and the point that stands for it: 2^-49 of the larger
/// coordinate. Rounding moves each coordinate by at most 2^-51 of itself (four roundings of 2^-53: of
/// numerator, denominator, quotient and sum), a choice among neighbours by two units in the last place,
/// 2^-51 again; both coordinates together by less than 2^-49.
pub(crate) fn reach_of(p: Point2) -> f64 {
    p.x.abs().max(p.y.abs()) * 8.0 * f64::EPSILON
}

/// Whether an end point that is not on `line` may lie between it and the part that became `piece`.
///
/// Both are within a rounding error of each other, so the test is one of sides: a point is between if
/// the two disagree about its side, or if it lies on the piece.
pub(crate) fn sweeps(line: &Piece, piece: &Piece, ends: &PointGrid) -> bool {
    let side = |a: Point2, b: Point2, v: Point2| {
        let o = orient2d(a, b, v);
        i8::from(o > 0.0) - i8::from(o < 0.0)
    };
    if [piece.a, piece.b].iter().all(|&p| side(line.a, line.b, p) == 0) {
        return false;
    }
    let slack = 4.0 * reach_of(piece.a).max(reach_of(piece.b));
    ends.any_near(&piece.segment(), slack, |v| {
        let known = v == piece.a || v == piece.b || v == line.a || v == line.b;
        let own = side(line.a, line.b, v);
        !known && own != 0 && own != side(piece.a, piece.b, v)
    })
}
