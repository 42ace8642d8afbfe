//! Pieces of faces: halves of halves, with bounds of how far rounding has moved their corners.
//!
//! A piece is cut in the middle of its longest edge, without rounding: the exact result, its *true* piece, is a part of the
//! face, and the true pieces of a face cover it. A middle that no double holds is rounded, and `error` bounds how far the
//! corners of a piece are off along each axis. What is claimed of a piece is proven for everything within these
//! bounds, so for the true piece and for the one with the given corners.
//!
//! Source: halving along the longest edge: Rivara, "Algorithms for refining triangular grids suitable for adaptive and multigrid
//! techniques", Int. J. Numerical Methods in Engineering 20, 1984.

use crate::Side;
use sightlines_geometry::vector::{dot, sub};
use sightlines_geometry::{Point3, check_coordinate};

/// What is known of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum State {
    /// No point of the light lights any point of it: proven.
    Umbra,
    /// Every point of the light lights every point of it, but for lines that only graze: proven.
    Lit,
    /// Neither is proven: it is in the penumbra, or too large, or the method could not decide.
    InDoubt,
}

/// A part of a side of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// The face that it is a part of.
    pub face: u32,
    /// The side.
    pub side: Side,
    /// Its corners in scene units, which turn as those of the face.
    pub corners: [Point3; 3],
    /// How far a true corner is from the given one at most, along each axis; 0 where nothing was rounded.
    pub error: Point3,
    /// How often the face was halved: its true area is the face's over `2^depth`.
    pub depth: u32,
    /// What is known.
    pub state: State,
    /// Whether some rays from the light arrived and some did not, as doubles have it: then it is neither in umbra nor lit as a whole, and
    /// no method can decide it at this size.
    pub is_mixed: bool,
}

impl Piece {
    /// A whole face.
    pub(crate) fn whole(face: u32, side: Side, corners: [Point3; 3]) -> Self {
        Self { face, side, corners, error: [0.0; 3], depth: 0, state: State::InDoubt, is_mixed: false }
    }

    /// Which edge is the longest, from the corner of that index to the next, and its length; rounded.
    pub(crate) fn longest(&self) -> (usize, f64) {
        let squared = |i: usize| {
            let edge = sub(self.corners[(i + 1) % 3], self.corners[i]);
            dot(edge, edge)
        };
        let i = (1..3).fold(0, |best, i| if squared(i) > squared(best) { i } else { best });
        (i, squared(i).sqrt())
    }

    /// The halves at its longest edge; none if no other double lies between the ends, or predicates do not take the middle.
    pub(crate) fn halves(&self) -> Option<[Self; 2]> {
        let (i, _) = self.longest();
        let [a, b, c] = [0, 1, 2].map(|k| self.corners[(i + k) % 3]);
        let (mut middle, mut error) = ([0.0; 3], self.error);
        for k in 0..3 {
            let (half, is_exact) = middle_of(a[k], b[k]);
            middle[k] = check_coordinate(half).ok()?;
            if !is_exact {
                // The sum is off by half a unit in its last place, and halving is exact. Ends may be off by `error` themselves.
                error[k] = (error[k] + half.abs() * f64::EPSILON).next_up();
            }
        }
        if middle == a || middle == b {
            return None;
        }
        let half = |from: usize| {
            let mut corners = self.corners;
            corners[(i + from) % 3] = middle;
            Self { corners, error, depth: self.depth + 1, ..*self }
        };
        debug_assert!(c == self.corners[(i + 2) % 3], "the third corner stays in both halves");
        Some([half(1), half(0)])
    }

    /// Points in whose hull all of the piece is, as far as rounding may have moved it.
    pub(crate) fn around(&self) -> Vec<Point3> {
        let mut points = self.corners.to_vec();
        for k in (0..3).filter(|&k| self.error[k] > 0.0) {
            // Outwards by the rounding of these sums.
            let mut beyond = points.clone();
            points.iter_mut().for_each(|p| p[k] = (p[k] - self.error[k]).next_down());
            beyond.iter_mut().for_each(|p| p[k] = (p[k] + self.error[k]).next_up());
            points.append(&mut beyond);
        }
        points
    }
}

/// Half the sum of two coordinates, rounded, and whether that is exact.
///
/// Source: the error of a sum: Knuth, "The Art of Computer Programming", volume 2, section 4.2.2.
fn middle_of(a: f64, b: f64) -> (f64, bool) {
    let sum = a + b;
    let b_part = sum - a;
    let error = (a - (sum - b_part)) + (b - b_part);
    (sum / 2.0, error == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middles_know_whether_they_are_exact() {
        assert_eq!(middle_of(1.0, 2.0), (1.5, true));
        assert_eq!(middle_of(-3.0, 3.0), (0.0, true));
        let next = 1.0f64.next_up();
        assert!(!middle_of(1.0, next).1);
        assert!(!middle_of(0.1, 1e9).1);
        assert!(middle_of(0.1, 0.1).1);
    }

    #[test]
    fn halves_share_the_longest_edge_and_turn_alike() {
        let whole = Piece::whole(3, Side::Front, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
        let [p, q] = whole.halves().unwrap();
        assert_eq!(p.corners, [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 2.0, 0.0]]);
        assert_eq!(q.corners, [[0.0; 3], [0.5, 2.0, 0.0], [0.0, 4.0, 0.0]]);
        assert_eq!((p.error, p.depth), ([0.0; 3], 1));
        assert_eq!(p.around().len(), 3);
    }

    #[test]
    fn bounds_hold_true_corners() {
        // A middle that is rounded: 1 and the next double, with one more that has no room at all.
        let next = 1.0f64.next_up();
        let whole = Piece::whole(0, Side::Front, [[1.0, 0.1, 0.0], [next, 1e9, 0.0], [1.0, 1.0, 1.0]]);
        let [p, _] = whole.halves().unwrap();
        assert!(p.error[0] > 0.0 && p.error[1] >= 1e9 * 2f64.powi(-53) && p.error[2] == 0.0);
        let around = p.around();
        assert_eq!(around.len(), 12);
        for corner in p.corners {
            for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let beyond = |q: &&Point3| {
                    let off = [x * (q[0] - corner[0]) >= p.error[0], y * (q[1] - corner[1]) >= p.error[1]];
                    let is_near = (q[0] - corner[0]).abs() < 1e-9 && (q[1] - corner[1]).abs() < 1e-6;
                    off == [true; 2] && is_near && q[2] == corner[2]
                };
                assert_eq!(around.iter().filter(beyond).count(), 1, "{corner:?} {x} {y}");
            }
        }
        let thin = Piece::whole(0, Side::Front, [[1.0; 3], [next, 1.0, 1.0], [1.0, next, 1.0]]);
        assert!(thin.halves().is_none() || thin.halves().unwrap()[0].corners != thin.corners);
        // Middles that underflow for the predicates end it.
        let tiny = 2f64.powi(-140);
        let thin = Piece::whole(0, Side::Front, [[0.0; 3], [tiny, 0.0, 0.0], [0.0, tiny, 0.0]]);
        assert!(thin.halves().is_none());
    }
}
