//! The frame of a table: axes of its own, for scenes that do not stand along those of their file.

/// By how much the products of the axes may differ from those of unit vectors at right angles: 32 units of rounding.
///
/// A right angle is not needed for soundness: lines stay lines under any linear map. It is what makes a length in the frame the same
/// as one in the scene.
const OFF: f64 = 1.0 / (1u64 << 48) as f64;

/// The axes along which a table stands, and the premise of precision under which it holds.
///
/// Cells, portals, objects and mirrors of a table with a frame have coordinates along these axes. Points and boxes that
/// *queries* take are those of the scene; the queries take them into the frame. What a table
/// with a frame hides is hidden in *some* scene of which each coordinate, along the axes of the frame, is within
/// [`Frame::gap`] of that of the scene: openings narrower than the gap may count as closed, and what is
/// thinner, or stands out by less, as hidden. Along a diagonal that is up to √3 times the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    axes: [[f64; 3]; 3],
    gap: f64,
}

/// Why numbers are no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// NaN or an infinity, or axes that are not unit vectors at right angles in the order of the right hand.
    #[error("the axes of the frame are not three unit vectors at right angles, right-handed")]
    Axes,
    /// NaN, an infinity, or below 0.
    #[error("the gap of the frame is not a finite number from 0 on")]
    Gap,
    /// In a plane.
    #[error("only a table of space can have a frame")]
    Plane,
}

impl Frame {
    /// The frame with these axes, each as a unit vector of the scene.
    ///
    /// * `gap`: how far each coordinate of the table may be from that of the scene, in scene units
    ///
    /// # Errors
    /// [`FrameError`] for axes that are not unit vectors at right angles to within 2^-48, and gaps that are no width.
    pub fn new(axes: [[f64; 3]; 3], gap: f64) -> Result<Self, FrameError> {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // Comparisons with NaN are false.
        let are_right = (0..3).all(|i| (0..=i).all(|j| (dot(axes[i], axes[j]) - f64::from(i == j)).abs() <= OFF));
        let [x, y, z] = axes;
        let across = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        if !are_right || dot(across, z) <= 0.0 {
            return Err(FrameError::Axes);
        }
        if gap >= 0.0 && gap.is_finite() { Ok(Self { axes, gap }) } else { Err(FrameError::Gap) }
    }

    /// The axes, each as a unit vector of the scene.
    pub const fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    /// How far each coordinate of the table may be from that of the scene, along the axes of the frame, in scene units.
    pub const fn gap(&self) -> f64 {
        self.gap
    }

    /// A point of the scene along the axes of the frame, rounded: each coordinate is off by at most
    /// [`Frame::rounding`]. The same on every machine.
    #[inline]
    pub fn to_frame(&self, p: [f64; 3]) -> [f64; 3] {
        self.axes.map(|a| a[0] * p[0] + a[1] * p[1] + a[2] * p[2])
    }

    /// A point along the axes of the frame as a point of the scene, rounded: for people, and for pictures.
    #[inline]
    pub fn to_scene(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.axes[0][k] * p[0] + self.axes[1][k] * p[1] + self.axes[2][k] * p[2])
    }

    /// Bounds on the error of each coordinate of [`Frame::to_frame`]: three products and two sums are off by less than 3.01 units of
    /// rounding (2^-53) of the sum of the magnitudes of the products; four times that, and the smallest normal number for underflow.
    #[inline]
    pub fn rounding(&self, p: [f64; 3]) -> [f64; 3] {
        self.axes.map(|a| {
            let size = (a[0] * p[0]).abs() + (a[1] * p[1]).abs() + (a[2] * p[2]).abs();
            size * (8.0 * f64::EPSILON) + f64::MIN_POSITIVE
        })
    }

    /// A box of the frame, lower and upper corner, that contains everything that lies within the gap of a box of the scene. It
    /// is the smallest one but for rounding. A NaN bounds nothing: where one is in the way, a side of the result is infinite or NaN.
    #[inline]
    pub fn around(&self, min: [f64; 3], max: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        self.box_along(self.axes, [1.0; 3], min, max)
    }

    /// A box of the scene that contains everything that lies within the gap of a box of the frame, along each axis of the frame. The axes
    /// are taken to be exactly at right angles, as they are to within 2^-48.
    pub fn around_in_scene(&self, min: [f64; 3], max: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let [x, y, z] = self.axes;
        let axes = std::array::from_fn(|k| [x[k], y[k], z[k]]);
        // A step of one gap along each axis of the frame. Rounded up by `box_along`, as the sum is off by less than two units of rounding.
        let n_gaps = axes.map(|[a, b, c]| a.abs() + b.abs() + c.abs());
        self.box_along(axes, n_gaps, min, max)
    }

    /// The box along these axes around a box, widened along each by a number of gaps and by rounding.
    #[inline]
    fn box_along(&self, axes: [[f64; 3]; 3], n_gaps: [f64; 3], min: [f64; 3], max: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let (mut lower, mut upper) = ([0.0; 3], [0.0; 3]);
        for (k, a) in axes.iter().enumerate() {
            let (mut low, mut high, mut size) = (0.0, 0.0, 0.0);
            for i in 0..3 {
                if a[i] == 0.0 {
                    continue;
                }
                let [from, to] = if a[i] > 0.0 { [min[i], max[i]] } else { [max[i], min[i]] };
                let (from, to) = (a[i] * from, a[i] * to);
                // A NaN bounds nothing; of two numbers, one of them NaN, `min` and `max` take the other.
                low += if from.is_nan() { f64::NEG_INFINITY } else { from.min(to) };
                high += if to.is_nan() { f64::INFINITY } else { to.max(from) };
                size += from.abs().max(to.abs());
            }
            // As in `rounding`; widening rounds once more, by a unit of the size and of the gap. The rest is for axes that are not quite
            // at right angles.
            let wide =
                self.gap * n_gaps[k] * (1.0 + 8.0 * f64::EPSILON) + size * (128.0 * f64::EPSILON) + f64::MIN_POSITIVE;
            (lower[k], upper[k]) = (low - wide, high + wide);
        }
        (lower, upper)
    }

    /// The frame as the bytes of its section: the axes, then the gap, as little-endian doubles.
    pub fn to_bytes(&self) -> [u8; FRAME_LEN] {
        let mut out = [0; FRAME_LEN];
        let numbers = self.axes.as_flattened().iter().chain([&self.gap]);
        out.chunks_exact_mut(8).zip(numbers).for_each(|(bytes, x)| bytes.copy_from_slice(&x.to_le_bytes()));
        out
    }

    /// Reads what [`Frame::to_bytes`] writes.
    ///
    /// # Errors
    /// [`FrameError`] for numbers that are no frame.
    pub fn from_bytes(bytes: &[u8; FRAME_LEN]) -> Result<Self, FrameError> {
        let number = |i: usize| f64::from_le_bytes(std::array::from_fn(|k| bytes[8 * i + k]));
        Self::new(std::array::from_fn(|i| std::array::from_fn(|k| number(3 * i + k))), number(9))
    }
}

/// Bytes of a frame in a file.
pub const FRAME_LEN: usize = 80;

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned by an angle whose sine and cosine are 3/5 and 4/5, about z.
    fn turned(gap: f64) -> Frame {
        Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], gap).unwrap()
    }

    #[test]
    fn points_and_boxes_are_taken_along() {
        let frame = turned(0.0);
        let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        assert!(close(frame.to_frame([4.0, 3.0, 7.0]), [5.0, 0.0, 7.0]));
        assert!(close(frame.to_scene([5.0, 0.0, 7.0]), [4.0, 3.0, 7.0]));
        let (min, max) = frame.around([0.0; 3], [1.0; 3]);
        assert!(close(min, [0.0, -0.6, 0.0]) && close(max, [1.4, 0.8, 1.0]));
        let (wide, _) = turned(0.5).around([0.0; 3], [1.0; 3]);
        assert!(close(wide, [-0.5, -1.1, -0.5]));
        // Back in the scene, a step of a gap along two axes at once is inside.
        let (low, high) = turned(0.5).around_in_scene([0.0; 3], [0.0; 3]);
        assert!(close(low, [-0.7, -0.7, -0.5]) && close(high, [0.7, 0.7, 0.5]), "{low:?}");
        let off = turned(0.0).to_scene([0.5, -0.5, 0.5]);
        assert!((0..3).all(|k| low[k] <= off[k] && off[k] <= high[k]));
        // Each corner is inside, by its exact coordinates: 0.8 and 0.6 as doubles are off by less than a unit of rounding.
        for i in 0..8 {
            let p: [f64; 3] = std::array::from_fn(|k| f64::from(i >> k & 1));
            let (at, off) = (frame.to_frame(p), frame.rounding(p));
            assert!((0..3).all(|k| min[k] <= at[k] - off[k] && at[k] + off[k] <= max[k]), "{p:?}");
        }
    }

    /// A box that is open to one side is open along every axis that has a part of it, and bounded along the others.
    #[test]
    fn a_nan_bounds_nothing() {
        let is_open = |x: f64| !x.is_finite();
        let (min, max) = turned(0.5).around([f64::NAN, 0.0, 0.0], [1.0; 3]);
        assert_eq!(min.map(is_open), [true, false, false], "{min:?}");
        assert_eq!(max.map(is_open), [false, true, false], "{max:?}");
        let (min, max) = turned(0.5).around([f64::NAN, 0.0, 0.0], [f64::NAN, 1.0, 1.0]);
        assert_eq!((min.map(is_open), max.map(is_open)), ([true, true, false], [true, true, false]));
        let (min, max) = turned(0.5).around([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        assert!(min.iter().chain(&max).all(|&x| is_open(x)), "{min:?} {max:?}");
    }

    #[test]
    fn what_is_no_frame_is_refused() {
        let right = turned(0.25).axes();
        assert_eq!(Frame::from_bytes(&turned(0.25).to_bytes()), Ok(turned(0.25)));
        assert_eq!(Frame::new(right, -1.0), Err(FrameError::Gap));
        assert_eq!(Frame::new(right, f64::NAN), Err(FrameError::Gap));
        let mut wrong = right;
        wrong[0][0] += 1e-9;
        assert_eq!(Frame::new(wrong, 0.0), Err(FrameError::Axes));
        wrong[0][0] = f64::NAN;
        assert_eq!(Frame::new(wrong, 0.0), Err(FrameError::Axes));
        assert_eq!(Frame::new([right[1], right[0], right[2]], 0.0), Err(FrameError::Axes), "left-handed");
        assert_eq!(Frame::new([[0.0; 3]; 3], 0.0), Err(FrameError::Axes));
    }
}
