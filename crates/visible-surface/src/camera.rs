//! An eye and its picture.

use crate::vector::{cross, cross_size, dot, dot_size, sub};
use sightlines_geometry::vector::unit_of_any_size;
use sightlines_geometry::{Point3, check_coordinate};

/// Unit of rounding of doubles, 2^-53.
pub(crate) const U: f64 = f64::EPSILON / 2.0;
/// The largest number of pixels along a side.
pub const MAX_SIDE: u32 = 16_384;

/// An eye and the rays through the centres of its pixels. Pixels count to the right and down from the upper left corner.
///
/// The ray through the centre of pixel (x, y) is, without any rounding, `eye + t * (corner + (x + 1/2) * across + (y + 1/2) * down)`
/// with `t > 0`, which is the *depth*: the distance along the axis of view if `corner` lies in the plane at distance 1. This is what
/// the exact methods of this crate mean by a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: Point3,
    corner: Point3,
    across: Point3,
    down: Point3,
    size: [u32; 2],
    near: f64,
    far: f64,
    /// Normals that give a point's x, y and depth, and what their rounding is measured by.
    normals: [Point3; 3],
    normal_sizes: [Point3; 3],
    volume: f64,
    volume_error: f64,
}

/// Why there is no such camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is no number or too large.
    #[error("the eye is nowhere: its coordinates are not finite, or out of range")]
    Eye,
    /// There is no direction to look in, or none that is up.
    #[error("the eye looks nowhere: what it looks at is where it is, or straight up or down, or not finite")]
    Direction,
    /// The angle of view.
    #[error("the angle of view is not between 0 and 180 degrees")]
    Angle,
    /// The number of pixels.
    #[error("a picture has from 1 to 16384 pixels along each side")]
    Size,
    /// The range of depths.
    #[error("the nearest depth is not at least 0 and less than the farthest")]
    Depth,
}

impl Camera {
    /// An eye that looks at a point.
    ///
    /// * `up`: what is up in the picture, as a direction in the scene
    /// * `angle`: from the lower to the upper edge of the picture, in degrees
    /// * `size`: pixels to the right and down, square ones
    ///
    /// # Errors
    /// [`CameraError`]
    pub fn look_at(eye: Point3, at: Point3, up: Point3, angle: f64, size: [u32; 2]) -> Result<Self, CameraError> {
        if !(angle > 0.0 && angle < 180.0) {
            return Err(CameraError::Angle);
        }
        let ahead = unit_of_any_size(sub(at, eye)).ok_or(CameraError::Direction)?;
        let up = unit_of_any_size(up).ok_or(CameraError::Direction)?;
        let right = cross(ahead, up);
        // Of two unit vectors that are nearly parallel only noise is left.
        if dot(right, right) < 1e-24 {
            return Err(CameraError::Direction);
        }
        let right = unit_of_any_size(right).ok_or(CameraError::Direction)?;
        let up = cross(right, ahead);
        let pixel = 2.0 * tangent(angle / 2.0) / f64::from(size[1].max(1));
        let half = size.map(|n| f64::from(n) / 2.0 * pixel);
        let corner = [0, 1, 2].map(|k| ahead[k] - half[0] * right[k] + half[1] * up[k]);
        Self::new(eye, corner, right.map(|x| x * pixel), up.map(|x| -x * pixel), size)
    }

    /// An eye with any rays: see the type.
    ///
    /// # Errors
    /// [`CameraError`]; of the rays if they do not span space, or have a component above 2^100. Components below 2^-100 count as 0.
    pub fn new(eye: Point3, corner: Point3, across: Point3, down: Point3, size: [u32; 2]) -> Result<Self, CameraError> {
        let mut eye = eye;
        for x in &mut eye {
            *x = check_coordinate(*x).map_err(|_| CameraError::Eye)?;
        }
        if size.iter().any(|n| !(1..=MAX_SIDE).contains(n)) {
            return Err(CameraError::Size);
        }
        // A component too small to compute with is as good as none.
        let [corner, across, down] = [corner, across, down].map(|v| v.map(|x| if x.abs() < TINY { 0.0 } else { x }));
        if [corner, across, down].iter().flatten().any(|x| !x.is_finite() || x.abs() > 1.0 / TINY) {
            return Err(CameraError::Direction);
        }
        let pairs = [(down, corner), (corner, across), (across, down)];
        let volume = dot(across, cross(down, corner));
        let volume_error = 16.0 * U * dot_size(across, cross_size(down, corner));
        // Numbers of at most 2^100: nothing overflows.
        if volume.abs() <= 4.0 * volume_error {
            return Err(CameraError::Direction);
        }
        let sign = volume.signum();
        Ok(Self {
            eye,
            corner,
            across,
            down,
            size,
            near: 0.0,
            far: f64::INFINITY,
            normals: pairs.map(|(a, b)| cross(a, b).map(|x| sign * x)),
            normal_sizes: pairs.map(|(a, b)| cross_size(a, b)),
            volume: volume.abs(),
            volume_error,
        })
    }

    /// The same eye, which sees depths from `near` to `far` only; `far` may be infinite.
    ///
    /// # Errors
    /// [`CameraError::Depth`]
    pub fn with_depths(mut self, near: f64, far: f64) -> Result<Self, CameraError> {
        let fits = |x: f64| x == 0.0 || x == f64::INFINITY || check_coordinate(x).is_ok();
        if !(near >= 0.0 && near < far && fits(near) && fits(far)) {
            return Err(CameraError::Depth);
        }
        (self.near, self.far) = (near, far);
        Ok(self)
    }

    /// Where the eye is.
    pub fn eye(&self) -> Point3 {
        self.eye
    }

    /// Pixels to the right and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The least depth that is seen, and the greatest.
    pub fn depths(&self) -> [f64; 2] {
        [self.near, self.far]
    }

    /// What rays are made of: corner, across, down.
    pub fn rays(&self) -> [Point3; 3] {
        [self.corner, self.across, self.down]
    }

    /// The direction of the ray through a place in the picture, in pixels from its upper left corner; rounded.
    #[inline]
    pub fn ray(&self, x: f64, y: f64) -> Point3 {
        [0, 1, 2].map(|k| self.corner[k] + x * self.across[k] + y * self.down[k])
    }

    /// Normals of the planes through the eye that give, of a point, pixels to the right and down and depth; all times depth and volume.
    pub(crate) fn normals(&self) -> [Point3; 3] {
        self.normals
    }

    /// What the rounding of the normals is measured by.
    pub(crate) fn normal_sizes(&self) -> [Point3; 3] {
        self.normal_sizes
    }

    /// The volume that the rays span, positive, and how much it may be off.
    pub(crate) fn volume(&self) -> (f64, f64) {
        (self.volume, self.volume_error)
    }

    /// The sum of the magnitudes that [`Self::ray`] adds, for the lower right corner of the picture: what rounding in rays is measured by.
    pub(crate) fn reach(&self) -> Point3 {
        let [width, height] = self.size.map(f64::from);
        [0, 1, 2].map(|k| self.corner[k].abs() + width * self.across[k].abs() + height * self.down[k].abs())
    }

    /// Where a point is in the picture. See [`ProjectedPoint`].
    pub fn place(&self, p: Point3) -> ProjectedPoint {
        let way = sub(p, self.eye);
        ProjectedPoint {
            scaled: self.normals.map(|n| dot(n, way)),
            // A difference; a product and a difference in the normal; a product and two sums: six roundings.
            error: self.normal_sizes.map(|n| 16.0 * U * dot_size(n, way) + TINY_ERROR),
            volume: self.volume,
            volume_error: self.volume_error,
        }
    }
}

/// Below this, components of rays count as 0: 2^-100.
const TINY: f64 = f64::from_bits((1023 - 100) << 52);
/// More than what underflow can add to a product of differences of coordinates and of rays.
pub(crate) const TINY_ERROR: f64 = 1e-290;

/// A point as the camera sees it, with bounds of rounding: x and y in pixels are `scaled[0] / scaled[2]` and
/// `scaled[1] / scaled[2]`, the depth is `scaled[2] / volume`; negative depths are behind the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedPoint {
    /// Pixels to the right and down, times depth, and depth; all times `volume`.
    pub scaled: [f64; 3],
    /// How much each may be off.
    pub error: [f64; 3],
    /// Positive.
    pub volume: f64,
    /// How much it may be off.
    pub volume_error: f64,
}

impl ProjectedPoint {
    /// Bounds of the depth.
    pub fn depth(&self) -> [f64; 2] {
        let (low, high) = (self.scaled[2] - self.error[2], self.scaled[2] + self.error[2]);
        let (small, large) = (self.volume - self.volume_error, self.volume + self.volume_error);
        // One rounding of each operation is covered by going out by some more.
        let down = |x: f64| x - x.abs() * 8.0 * U - TINY_ERROR;
        let up = |x: f64| x + x.abs() * 8.0 * U + TINY_ERROR;
        let bounds = [
            down(if low > 0.0 { low / large } else { low / small }),
            up(if high > 0.0 { high / small } else { high / large }),
        ];
        if bounds.iter().any(|x| x.is_nan()) { [f64::NEG_INFINITY, f64::INFINITY] } else { bounds }
    }

    /// Bounds of the place in pixels, to the right and down; everything if the point may be behind the eye.
    #[inline]
    pub fn pixels(&self) -> [[f64; 2]; 2] {
        const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let (low, high) = (self.scaled[2] - self.error[2], self.scaled[2] + self.error[2]);
        // Half the bound again for the rounding of these very lines.
        if !(low > 0.5 * self.error[2] && high < f64::INFINITY) {
            return [ALL; 2];
        }
        let (most, least) = (1.0 / low, 1.0 / high);
        // Three roundings, of the sum, the inverse and the product, are covered by going out by some more.
        let down = |x: f64| x - x.abs() * 8.0 * U - TINY_ERROR;
        let up = |x: f64| x + x.abs() * 8.0 * U + TINY_ERROR;
        [0, 1].map(|axis| {
            let (a, b) = (self.scaled[axis] - self.error[axis], self.scaled[axis] + self.error[axis]);
            let bounds = [down(a * if a > 0.0 { least } else { most }), up(b * if b > 0.0 { most } else { least })];
            if bounds.iter().any(|x| x.is_nan()) { ALL } else { bounds }
        })
    }

    /// Whether the point is surely behind the eye.
    #[inline]
    pub(crate) fn is_behind(&self) -> bool {
        self.scaled[2] < -2.0 * self.error[2]
    }
}

/// The tangent of an angle from 0 to 90 degrees, by sums, products and quotients only: the same bits on every machine, which
/// those of the system's library need not be.
fn tangent(degrees: f64) -> f64 {
    if degrees > 45.0 {
        return 1.0 / tangent(90.0 - degrees);
    }
    if degrees == 45.0 {
        // So that a picture that is 90 degrees high has the rays that one expects.
        return 1.0;
    }
    let x = degrees * (std::f64::consts::PI / 180.0);
    let square = x * x;
    // Sine over x and cosine by their series, to x^20, which is less than the last bit for x below 0.8.
    let series = |first: i32| {
        (0..10)
            .rev()
            .map(|k| f64::from((2 * k + first) * (2 * k + first + 1)))
            .fold(1.0, |sum, n| 1.0 - square / n * sum)
    };
    x * series(2) / series(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};
    use proptest::prelude::*;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).expect("finite")
    }

    fn det([a, b, c]: [[BigRational; 3]; 3]) -> BigRational {
        let minor = |i: usize, j: usize| b[i].clone() * &c[j] - b[j].clone() * &c[i];
        a[0].clone() * minor(1, 2) + a[1].clone() * minor(2, 0) + a[2].clone() * minor(0, 1)
    }

    /// Points near and far, and on each other.
    fn point() -> impl Strategy<Value = Point3> {
        let one = (-8i32..9, prop::sample::select(vec![-20i32, -3, 0, 0, 1, 30]))
            .prop_map(|(x, e)| f64::from(x) * 0.3 * 2f64.powi(e));
        [one.clone(), one.clone(), one]
    }

    proptest! {
        /// Invariant: the bounds of a place hold the true place.
        #[test]
        fn bounds_hold(eye in point(), at in point(), p in point(), angle in 5u32..175) {
            let Ok(camera) = Camera::look_at(eye, at, [0.1, 1.0, 0.2], f64::from(angle), [64, 48]) else { return Ok(()) };
            let way = [0, 1, 2].map(|k| rational(p[k]) - rational(eye[k]));
            let [c, a, d] = camera.rays().map(|v| v.map(rational));
            let whole = det([a.clone(), d.clone(), c.clone()]);
            let [x, y, t] = [[&way, &d, &c], [&a, &way, &c], [&a, &d, &way]].map(|m| det(m.map(Clone::clone)) / &whole);
            let place = camera.place(p);
            let holds = |[low, high]: [f64; 2], x: &BigRational| {
                (low == f64::NEG_INFINITY || rational(low) <= *x) && (high == f64::INFINITY || rational(high) >= *x)
            };
            prop_assert!(holds(place.depth(), &t), "{:?} {}", place.depth(), t);
            // What is called behind is, and what is clearly behind is called so.
            let tiny = way.iter().fold(BigRational::zero(), |sum, w| sum + w.abs()) * rational(1e-12) + rational(1e-280);
            prop_assert!(!place.is_behind() || t.is_negative());
            prop_assert!(place.is_behind() || t > -tiny);
            if t.is_positive() {
                prop_assert!(holds(place.pixels()[0], &(&x / &t)), "x");
                prop_assert!(holds(place.pixels()[1], &(&y / &t)), "y");
            } else {
                prop_assert_eq!(place.pixels(), [[f64::NEG_INFINITY, f64::INFINITY]; 2]);
            }
            // And they are no wider than some roundings, where the point is not next to the eye's plane.
            let [low, high] = place.depth();
            let size = way.iter().map(|w| w.abs()).fold(BigRational::zero(), |a, b| a + b);
            prop_assert!(rational(high) - rational(low) <= size * rational(1e-13) + rational(1e-280));
        }
    }

    #[test]
    fn pixels_count_from_the_upper_left_corner() {
        let camera = Camera::look_at([0.; 3], [0., 0., -1.], [0., 1., 0.], 90.0, [200, 100]).unwrap();
        let place = camera.place([-2.0, 1.0, -1.0]);
        let middle = |b: [f64; 2]| (b[0] + b[1]) / 2.0;
        assert!(place.pixels().iter().all(|&b| middle(b).abs() < 1e-9));
        assert!((middle(place.depth()) - 1.0).abs() < 1e-12);
        let place = camera.place([1.0, -1.0, -2.0]);
        assert!((middle(place.pixels()[0]) - 125.0).abs() < 1e-9 && (middle(place.pixels()[1]) - 75.0).abs() < 1e-9);
    }

    #[test]
    fn tangents_are_tangents() {
        for k in 1..900 {
            let degrees = f64::from(k) * 0.1;
            let want = degrees.to_radians().tan();
            // The steeper, the more the rounding of the angle counts.
            assert!((tangent(degrees) - want).abs() <= 4e-15 * want * want.max(1.0), "{degrees}");
        }
        assert_eq!(tangent(45.0), 1.0);
    }

    #[test]
    fn what_is_no_camera_is_refused() {
        let look = |eye, at, up, angle, size| Camera::look_at(eye, at, up, angle, size).map(|_| ());
        let (o, z, y) = ([0.; 3], [0., 0., -1.], [0., 1., 0.]);
        assert_eq!(look(o, o, y, 60., [4; 2]), Err(CameraError::Direction));
        assert_eq!(look(o, y, y, 60., [4; 2]), Err(CameraError::Direction));
        assert_eq!(look(o, [0., f64::NAN, 0.], y, 60., [4; 2]), Err(CameraError::Direction));
        assert_eq!(look(o, [0., f64::INFINITY, 0.], y, 60., [4; 2]), Err(CameraError::Direction));
        assert_eq!(look([f64::NAN; 3], z, y, 60., [4; 2]), Err(CameraError::Direction));
        assert_eq!(look([1e300, 0., 0.], z, y, 60., [4; 2]), Err(CameraError::Eye));
        assert_eq!(look(o, z, y, 180., [4; 2]), Err(CameraError::Angle));
        assert_eq!(look(o, z, y, f64::NAN, [4; 2]), Err(CameraError::Angle));
        assert_eq!(look(o, z, y, 60., [0, 4]), Err(CameraError::Size));
        assert_eq!(look(o, z, y, 60., [4, MAX_SIDE + 1]), Err(CameraError::Size));
        assert_eq!(look(o, z, y, 1e-40, [4; 2]), Err(CameraError::Direction));
        let camera = Camera::look_at(o, z, y, 60., [4; 2]).unwrap();
        for [near, far] in [[-1., 1.], [1., 1.], [f64::NAN, 1.], [0., f64::NAN], [1., 0.5]] {
            assert_eq!(camera.with_depths(near, far), Err(CameraError::Depth));
        }
        assert!(camera.with_depths(0.5, f64::INFINITY).is_ok());
    }
}
