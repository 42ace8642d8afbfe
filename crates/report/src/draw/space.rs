//! Directions of pictures of scenes in space.

use sightlines_geometry::{Aabb, Point2};

/// Which axis of a scene points up, in its positive direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// The first coordinate.
    X,
    /// The second coordinate, as in glTF.
    #[default]
    Y,
    /// The third coordinate.
    Z,
}

impl Up {
    /// The axis, 0 to 2.
    pub fn axis(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// A point as seen from above: to the right, and upwards in the picture. Nothing is mirrored or rounded.
    pub(super) fn on_floor(self, p: [f64; 3]) -> [f64; 2] {
        match self {
            Self::X => [p[1], p[2]],
            // Zero less the coordinate, so that zero stays positive.
            Self::Y => [p[0], 0.0 - p[2]],
            Self::Z => [p[0], p[1]],
        }
    }

    /// A box as seen from above.
    pub(super) fn seen_from_above(self, min: [f64; 3], max: [f64; 3]) -> Aabb<2> {
        Aabb::around([self.on_floor(min), self.on_floor(max)])
    }

    /// The two horizontal axes, of which the first runs to the lower right and the second to the lower left
    /// for a viewer who looks down from the positive side of all axes.
    pub(super) fn sideways(self) -> [usize; 2] {
        [(self.axis() + 2) % 3, (self.axis() + 1) % 3]
    }
}

/// Whether something that reaches from `low` to `high` is cut at a height: on a border the upper one is.
pub(super) fn cut_by(height: f64, low: f64, high: f64) -> bool {
    low <= height && height < high
}

/// Cosine of 30 degrees, rounded; a picture is not a predicate.
const COS_30: f64 = 0.866_025_403_784_438_6;

/// A point in the plane of the picture: all three axes are equally short.
pub(super) fn project(p: [f64; 3], up: Up) -> Point2 {
    let [right, left] = up.sideways().map(|axis| p[axis]);
    Point2::new((right - left) * COS_30, p[up.axis()] - 0.5 * (right + left))
}

/// How near a point is to the viewer: the sum of its coordinates.
pub(super) fn depth_of(p: [f64; 3]) -> f64 {
    p[0] + p[1] + p[2]
}

/// The point that [`project`] and [`depth_of`] are of.
pub(super) fn point_at(at: Point2, depth: f64, up: Up) -> [f64; 3] {
    let [right, left] = up.sideways();
    let (both, apart) = ((depth - at.y) / 1.5, at.x / COS_30);
    let mut p = [0.0; 3];
    p[up.axis()] = at.y + 0.5 * both;
    (p[right], p[left]) = (0.5 * (both + apart), 0.5 * (both - apart));
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Invariant: right, then up in the picture, then towards the viewer is a right-handed system, so no
    /// picture shows a mirrored scene.
    #[test]
    fn pictures_are_not_mirrored() {
        for up in [Up::X, Up::Y, Up::Z] {
            let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let [a, b, c] = units.map(|e| {
                let [right, ahead] = up.on_floor(e);
                [right, ahead, e[up.axis()]]
            });
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            assert_eq!((0..3).map(|k| cross[k] * c[k]).sum::<f64>(), 1.0, "{up:?}");
            // Going round from left to right to up is a right-handed turn as well.
            let [right, left] = up.sideways();
            assert_eq!([(left + 1) % 3, (left + 2) % 3], [right, up.axis()], "{up:?}");
        }
    }

    #[test]
    fn borders_belong_to_what_is_above() {
        assert!(cut_by(1.0, 1.0, 2.0) && !cut_by(1.0, 0.0, 1.0) && !cut_by(1.0, 1.0, 1.0));
    }

    #[test]
    fn points_are_found_again() {
        let mut n = 0;
        for up in [Up::X, Up::Y, Up::Z] {
            for k in 0..27 {
                let p: [f64; 3] = [k % 3, k / 3 % 3, k / 9].map(|k| f64::from(k) * 1.5 - 2.0);
                let found = point_at(project(p, up), depth_of(p), up);
                assert!((0..3).all(|k| (found[k] - p[k]).abs() < 1e-12), "{up:?}: {p:?}, {found:?}");
                n += 1;
            }
        }
        assert_eq!(n, 81);
    }
}
