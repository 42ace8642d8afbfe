//! The planes that buffers lie on.

use crate::Volume;
use sightlines_geometry::{CoordinateError, Point3, check_coordinate};

/// Most texels along one side of a buffer.
pub const MAX_TEXELS: u32 = 1 << 13;

/// Why a plane with texels is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BufferPlaneError {
    /// Not 0, 1 or 2.
    #[error("axis {0} is none of 0, 1 and 2")]
    Axis(usize),
    /// No texels, or more than [`MAX_TEXELS`] along a side.
    #[error("a buffer of {0} x {1} texels; both have to be from 1 to {MAX_TEXELS}")]
    Texels(u32, u32),
    /// The window has no area, or is too small for its position to have texels of non-zero size.
    #[error("the window from {min:?} to {max:?} is empty, or too small to be divided into texels")]
    Window {
        /// Lower corner.
        min: [f64; 2],
        /// Upper corner.
        max: [f64; 2],
    },
    /// A coordinate that predicates cannot take.
    #[error("the plane's {0}")]
    Coordinate(#[from] CoordinateError),
    /// The plane touches or cuts the view volume, or lies on its other side.
    #[error("the plane at {at} along axis {axis} is not in front of the view volume, which reaches to {reach}")]
    Through {
        /// Of the plane.
        axis: usize,
        /// Of the plane.
        at: f64,
        /// The largest coordinate of the volume towards the plane.
        reach: f64,
    },
}

/// A plane perpendicular to an axis, with a window of square or oblong texels on it.
///
/// The corners of all texels are doubles without rounding, so that predicates accept them: the requested window is
/// widened to a grid that has this property, by less than one part in 2^20 of a texel on each side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BufferPlane {
    axis: usize,
    positive: bool,
    at: f64,
    origin: [f64; 2],
    step: [f64; 2],
    texels: [u32; 2],
}

impl BufferPlane {
    /// A plane with a window.
    ///
    /// * `axis`: 0 to 2, the axis that the plane is perpendicular to
    /// * `positive`: whether viewers look along the axis (else against it)
    /// * `at`: where along the axis, in scene units
    /// * `min`, `max`: the window along axes `(axis + 1) % 3` and `(axis + 2) % 3`, in scene units
    /// * `texels`: their numbers along these two
    ///
    /// # Errors
    /// [`BufferPlaneError`]
    pub fn new(
        axis: usize,
        positive: bool,
        at: f64,
        min: [f64; 2],
        max: [f64; 2],
        texels: [u32; 2],
    ) -> Result<Self, BufferPlaneError> {
        if axis > 2 {
            return Err(BufferPlaneError::Axis(axis));
        }
        if texels.iter().any(|n| !(1..=MAX_TEXELS).contains(n)) {
            return Err(BufferPlaneError::Texels(texels[0], texels[1]));
        }
        let at = check_coordinate(at)?;
        let (mut origin, mut step) = ([0.0; 2], [0.0; 2]);
        for k in 0..2 {
            let (low, high) = (check_coordinate(min[k])?, check_coordinate(max[k])?);
            let grid = grid(low, high, texels[k]).ok_or(BufferPlaneError::Window { min, max })?;
            (origin[k], step[k]) = grid;
        }
        Ok(Self { axis, positive, at, origin, step, texels })
    }

    /// The axis that it is perpendicular to.
    pub const fn axis(&self) -> usize {
        self.axis
    }

    /// The axes of its window.
    pub const fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Whether viewers look along the axis, else against it.
    pub const fn positive(&self) -> bool {
        self.positive
    }

    /// Where it is along its axis, in scene units.
    pub const fn at(&self) -> f64 {
        self.at
    }

    /// Number of texels along each axis.
    pub const fn texels(&self) -> [u32; 2] {
        self.texels
    }

    /// Lower corner of the window, in scene units.
    pub const fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// Size of a texel, in scene units.
    pub const fn step(&self) -> [f64; 2] {
        self.step
    }

    /// Upper corner of the window, in scene units.
    pub fn end(&self) -> [f64; 2] {
        std::array::from_fn(|k| self.origin[k] + self.step[k] * f64::from(self.texels[k]))
    }

    /// Corner `(x, y)` of the grid of texels, exactly: 0 to the number of texels along each axis.
    pub fn corner(&self, x: u32, y: u32) -> Point3 {
        let [u, v] = self.across();
        let mut p = [0.0; 3];
        p[self.axis] = self.at;
        p[u] = self.origin[0] + self.step[0] * f64::from(x);
        p[v] = self.origin[1] + self.step[1] * f64::from(y);
        p
    }

    /// The difference of `p` to the plane along the axis, positive on the viewers' side; rounded to nearest.
    pub fn height(&self, p: Point3) -> f64 {
        if self.positive { self.at - p[self.axis] } else { p[self.axis] - self.at }
    }

    /// Checks that all of `volume` is strictly on the viewers' side.
    ///
    /// # Errors
    /// [`BufferPlaneError::Through`]
    pub fn check_in_front_of(&self, volume: &Volume) -> Result<(), BufferPlaneError> {
        let b = volume.bounds();
        let reach = if self.positive { b.max[self.axis] } else { b.min[self.axis] };
        let in_front = if self.positive { reach < self.at } else { reach > self.at };
        if in_front { Ok(()) } else { Err(BufferPlaneError::Through { axis: self.axis, at: self.at, reach }) }
    }
}

/// Origin and step of a grid of `n` steps around `low` to `high`, all of whose points are exact.
///
/// Both are multiples of a power of two `g` with `|origin| / g` and `|origin + n * step| / g` below 2^52, so
/// products and sums are exact. None if `g` would be more than a part in 2^20 of a step.
fn grid(low: f64, high: f64, n: u32) -> Option<(f64, f64)> {
    if low >= high {
        return None;
    }
    let step = (high - low) / f64::from(n);
    // 2^23 parts of a step, or as many as the magnitude of the ends leaves.
    let fine = power_of_two_at_most(step) / f64::from(1 << 23);
    let coarse = power_of_two_at_most(low.abs().max(high.abs())) / (1u64 << 50) as f64;
    let g = fine.max(coarse);
    if g * f64::from(1 << 20) > step || check_coordinate(g).is_err() {
        return None;
    }
    let origin = (low / g).floor() * g;
    let step = ((high - origin) / (f64::from(n) * g)).ceil() * g;
    // The quotient may have been rounded down onto a whole number.
    let step = if origin + step * f64::from(n) < high { step + g } else { step };
    Some((origin, step))
}

/// The largest power of two that is no larger than `x`, a positive normal number.
pub(crate) fn power_of_two_at_most(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}
