//! On which side of a portal's plane the eye is.

use crate::side::{Vector, cross, dot, norm, sub};
use sightlines_geometry::{Point2, orient2d, orient3d};

/// What a sum of a few products may be off by, as a share of their sizes: 32 times the unit roundoff, 2^-53.
const SMALL: f64 = 1.0 / (1u64 << 48) as f64;

/// Determines the side of a portal on which a point is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Front {
    /// In the plane: the line through the two corners, left end first.
    Line { left: [f64; 2], right: [f64; 2] },
    /// In space: all corners have the same coordinate `at` along `axis`; crossed upwards or downwards.
    Axis { axis: u8, upwards: bool, at: f64 },
    /// In space: a point of the plane, its unit normal in the direction of crossing, how far corners are from it at
    /// most, and how much the normal may be off.
    Plane { point: Vector, normal: Vector, uneven: f64, tilt: f64 },
}

/// Where the eye is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Facing {
    /// Before the portal: lines from the eye may cross it.
    Before,
    /// In the portal itself, or in its plane, as far as can be decided: uneven portals and rounded eyes leave a doubt.
    Level,
    /// In its plane or behind: no line from the eye crosses it in its direction.
    Behind,
}

impl Front {
    /// Of corners in the order in which who crosses the portal sees them.
    pub(crate) fn of(corners: &[Vector], planar: bool) -> Self {
        if let (true, [l, r]) = (planar, corners) {
            return Self::Line { left: [l[0], l[1]], right: [r[0], r[1]] };
        }
        let Some(&point) = corners.first() else {
            return Self::Plane { point: [0.0; 3], normal: [0.0; 3], uneven: f64::INFINITY, tilt: 0.0 };
        };
        let normal = towards(corners);
        for axis in 0..3 {
            if corners.iter().all(|c| c[axis] == point[axis]) && normal[axis] != 0.0 {
                return Self::Axis { axis: axis as u8, upwards: normal[axis] > 0.0, at: point[axis] };
            }
        }
        let length = dot(normal, normal).sqrt();
        let normal = normal.map(|x| x / length);
        let size = corners.iter().fold(0.0f64, |m, &c| m.max(norm(sub(c, point))));
        let off = corners.iter().fold(0.0f64, |m, &c| m.max(dot(normal, sub(c, point)).abs()));
        // Each of the cross products is off by some 8 u size², and the rest of the sum by less: 2^-48 has room for 32.
        let tilt = corners.len() as f64 * size * size / length * SMALL;
        let uneven = off + size * SMALL;
        // Where sizes are not numbers, nothing is known.
        let is_known = uneven.is_finite() && tilt.is_finite();
        let (uneven, tilt) = if is_known { (uneven, tilt) } else { (f64::INFINITY, 0.0) };
        Self::Plane { point, normal, uneven, tilt }
    }

    /// A point of the plane, and its unit normal.
    pub(crate) fn plane(&self) -> (Vector, Vector) {
        match *self {
            Self::Line { left, right } => {
                let along = [left[0] - right[0], left[1] - right[1]];
                let length = along[0].hypot(along[1]);
                // Along an axis exactly so, whatever the length's rounding.
                let unit = |x: f64| if x == 0.0 { 0.0 } else { x / length };
                let normal = match (along[0] == 0.0, along[1] == 0.0) {
                    (true, _) => [1.0, 0.0, 0.0],
                    (_, true) => [0.0, 1.0, 0.0],
                    _ => [unit(along[1]), -unit(along[0]), 0.0],
                };
                ([right[0], right[1], 0.0], normal)
            }
            Self::Axis { axis, at, .. } => {
                let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
                (point[usize::from(axis)], normal[usize::from(axis)]) = (at, 1.0);
                (point, normal)
            }
            Self::Plane { point, normal, .. } => (point, normal),
        }
    }

    /// Where `eye`, whose coordinates are off by at most `slack`, is. Exact in the plane and for portals along
    /// an axis if `slack` is 0.
    ///
    /// An uneven portal counts as flat: an eye between the planes of its triangles, but not near the portal, cannot
    /// look through it, like an eye in the plane of a flat one.
    #[inline]
    pub(crate) fn facing(&self, corners: &[Vector], eye: Vector, slack: f64) -> Facing {
        match *self {
            Self::Line { left, right } => {
                if slack > 0.0 {
                    return facing_line(eye, left, right, slack);
                }
                let point = |p: [f64; 2]| Point2::new(p[0], p[1]);
                match orient2d(Point2::new(eye[0], eye[1]), point(right), point(left)) > 0.0 {
                    true => Facing::Before,
                    false => Facing::Behind,
                }
            }
            Self::Axis { axis, upwards, at } => {
                let e = eye[usize::from(axis)];
                if slack > 0.0 && (at - e).abs() <= 2.0 * slack {
                    return Facing::Level;
                }
                if if upwards { e < at } else { e > at } { Facing::Before } else { Facing::Behind }
            }
            Self::Plane { point, normal, uneven, tilt } => {
                let v = sub(point, eye);
                let margin = uneven + norm(v) * (SMALL + tilt) + 3.0 * slack;
                let before = dot(normal, v);
                if before > margin {
                    Facing::Before
                } else if before < -margin {
                    Facing::Behind
                } else if slack > 0.0 || near(corners, eye, margin) {
                    Facing::Level
                } else if before_all_triangles(corners, eye) {
                    Facing::Before
                } else {
                    Facing::Behind
                }
            }
        }
    }
}

/// Whether the eye is before each triangle of a fan from the first corner; exact. For a flat portal: before it.
fn before_all_triangles(corners: &[Vector], eye: Vector) -> bool {
    let Some((&first, rest)) = corners.split_first() else { return false };
    // Crossed away from the eye, so as the eye sees them the corners are counter-clockwise. Triangles without area say
    // nothing.
    let mut signs = rest.windows(2).map(|pair| orient3d(first, pair[0], pair[1], eye));
    let (mut n_before, mut others) = (0, false);
    signs.by_ref().for_each(|sign| {
        n_before += usize::from(sign > 0.0);
        others |= sign < 0.0;
    });
    n_before > 0 && !others
}

/// Whether `eye` is in the box around the corners, or outside by at most `margin`.
fn near(corners: &[Vector], eye: Vector, margin: f64) -> bool {
    (0..3).all(|k| corners.iter().any(|c| eye[k] >= c[k] - margin) && corners.iter().any(|c| eye[k] <= c[k] + margin))
}

fn facing_line(eye: Vector, left: [f64; 2], right: [f64; 2], slack: f64) -> Facing {
    let along = [left[0] - right[0], left[1] - right[1]];
    let v = [right[0] - eye[0], right[1] - eye[1]];
    let before = v[0] * along[1] - v[1] * along[0];
    let size = along[0].abs() + along[1].abs();
    let margin = size * ((v[0].abs() + v[1].abs()) * SMALL + 2.0 * slack) + f64::MIN_POSITIVE;
    if before > margin {
        Facing::Before
    } else if before < -margin {
        Facing::Behind
    } else {
        Facing::Level
    }
}

/// A vector in the direction of crossing, as long as twice the area: Newell's sum, about the first corner.
fn towards(corners: &[Vector]) -> Vector {
    let mut sum = [0.0; 3];
    for pair in corners.windows(2) {
        let n = cross(sub(pair[1], corners[0]), sub(pair[0], corners[0]));
        (0..3).for_each(|k| sum[k] += n[k]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_reported() {
        // A door at x = 2, crossed towards larger x: the left end has the larger y.
        let line = Front::of(&[[2.0, 1.0, 0.0], [2.0, 0.0, 0.0]], true);
        for slack in [0.0, 1e-12] {
            assert_eq!(line.facing(&[], [1.0, 5.0, 0.0], slack), Facing::Before);
            assert_eq!(line.facing(&[], [3.0, 5.0, 0.0], slack), Facing::Behind);
        }
        assert_eq!(line.facing(&[], [2.0, 5.0, 0.0], 0.0), Facing::Behind);
        assert_eq!(line.facing(&[], [2.0, 5.0, 0.0], 1e-12), Facing::Level);
        // Counter-clockwise as seen from the origin.
        let square = [[2.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, 1.0, 1.0], [2.0, 1.0, 0.0]];
        let axis = Front::of(&square, false);
        assert_eq!(axis, Front::Axis { axis: 0, upwards: true, at: 2.0 });
        assert_eq!(
            [1.0, 2.0, 3.0].map(|x| axis.facing(&[], [x, 0.0, 0.0], 0.0)),
            [Facing::Before, Facing::Behind, Facing::Behind]
        );
        let tilted = square.map(|[x, y, z]| [x + 1e-3 * y, y, z]);
        let plane = Front::of(&tilted, false);
        assert!(matches!(plane, Front::Plane { .. }));
        assert_eq!(
            [1.0, 2.0, 3.0].map(|x| plane.facing(&tilted, [x, 0.0, 0.0], 0.0)),
            [Facing::Before, Facing::Level, Facing::Behind]
        );
        assert_eq!(plane.facing(&tilted, [2.0, 0.0, 5.0], 0.0), Facing::Behind);
        assert_eq!(plane.facing(&tilted, [2.0, 0.0, 5.0], 1e-9), Facing::Level);
    }

    /// Rounded products give a thin triangle's normal badly; exact signs are right.
    #[test]
    fn slivers_are_faced_exactly() {
        for (w, h) in [(1e-4, 4e-5), (1e-3, 4e-6), (1e-2, 4e-7), (1.0, 4e-9)] {
            let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, 1000.0], [w, -w, 500.0]];
            let front = Front::of(&corners, false);
            let (near, far) = ([4.0 - h / 2.0, -4.0 - h / 2.0, 500.0], [4.0 + h / 2.0, -4.0 + h / 2.0, 500.0]);
            let faces = [near, far].map(|eye| front.facing(&corners, eye, 0.0));
            assert!(faces.contains(&Facing::Before) && faces.contains(&Facing::Behind), "{faces:?}");
            // On the plane.
            assert_eq!(front.facing(&corners, [4.0, -4.0, 500.0], 0.0), Facing::Behind);
            let turned = [corners[1], corners[0], corners[2]];
            let back = Front::of(&turned, false);
            assert_eq!([far, near].map(|eye| back.facing(&turned, eye, 0.0)), faces);
        }
    }

    #[test]
    fn sides_of_nonsense_are_unknown() {
        assert_eq!(Front::of(&[[f64::NAN; 3]; 3], false).facing(&[], [0.0; 3], 1e-9), Facing::Level);
        assert_eq!(Front::of(&[], false).facing(&[], [0.0; 3], 1e-9), Facing::Level);
    }
}
