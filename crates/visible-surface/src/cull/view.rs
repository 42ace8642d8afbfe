//! A camera made ready to place many points.

use crate::camera::{Camera, Place, TINY_ERROR, U};
use crate::vector::{cross, cross_size, dot, dot_size, minus};
use sightlines_geometry::Point3;

/// The largest magnitude of a coordinate that a scene may have: 2^200.
const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);

/// The three functions whose quotients are places in the picture, once for all points. Gives what [`Camera::place`] gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    pub(crate) eye: Point3,
    /// Times depth and volume: pixels to the right and down, and 1.
    pub(crate) normals: [Point3; 3],
    /// What the rounding of the normals is measured by.
    pub(crate) sizes: [Point3; 3],
    /// Positive.
    pub(crate) volume: f64,
    pub(crate) volume_error: f64,
}

impl View {
    pub(crate) fn of(camera: &Camera) -> Self {
        let [c, a, d] = camera.rays();
        let pairs = [(d, c), (c, a), (a, d)];
        let volume = dot(a, cross(d, c));
        let sign = volume.signum();
        Self {
            eye: camera.eye(),
            normals: pairs.map(|(a, b)| cross(a, b).map(|x| x * sign)),
            sizes: pairs.map(|(a, b)| cross_size(a, b)),
            volume: volume.abs(),
            volume_error: 16.0 * U * dot_size(a, cross_size(d, c)),
        }
    }

    /// Where a point is in the picture. Its coordinates must be of a size that [`is_usable`] accepts.
    #[inline]
    pub(crate) fn place(&self, p: Point3) -> Place {
        let way = minus(p, self.eye);
        Place {
            scaled: self.normals.map(|n| dot(n, way)),
            // Two roundings in a normal, one in the difference, three in the product; the rest is for this bound itself.
            error: self.sizes.map(|s| 16.0 * U * dot_size(s, way) + TINY_ERROR),
            volume: self.volume,
            volume_error: self.volume_error,
        }
    }
}

/// Whether coordinates are numbers of a size with which nothing overflows. Smaller ones than a scene may have do no harm.
pub(crate) fn is_usable(points: &[Point3]) -> bool {
    points.iter().flatten().all(|x| x.abs() <= LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn points_are_placed_as_the_camera_does(p in [-9i32..9, -9..9, -9..9], at in [-9i32..9, -9..9, 10..19]) {
            let [p, at] = [p, at].map(|p| p.map(|x| f64::from(x) / 7.0));
            let camera = Camera::look_at([0.1, 0.2, -0.3], at, [0.0, 1.0, 0.2], 60.0, [17, 9]).unwrap();
            let (ours, its) = (View::of(&camera).place(p), camera.place(p));
            for k in 0..3 {
                let off = (ours.scaled[k] - its.scaled[k]).abs();
                prop_assert!(off <= ours.error[k].min(its.error[k]), "axis {k}: {off:e}");
            }
            prop_assert_eq!((ours.volume, ours.volume_error), (its.volume, its.volume_error));
        }
    }
}
