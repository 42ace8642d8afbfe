//! Rectangles of pixels.

use crate::camera::Camera;

/// Pixels from `min` to before `max`, to the right and down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) min: [u32; 2],
    pub(crate) max: [u32; 2],
}

impl Window {
    /// All pixels whose centres lie within bounds in pixels, [to the right, down].
    pub(crate) fn around(camera: &Camera, bounds: [[f64; 2]; 2]) -> Self {
        let size = camera.size();
        let min = [0, 1].map(|k| ceil(bounds[k][0] - 0.5).min(size[k]));
        let last = |x: f64| if x < 0.0 { 0 } else { (x as u32).saturating_add(1) };
        let max = [0, 1].map(|k| last(bounds[k][1] - 0.5).min(size[k]));
        Self { min, max }
    }

    pub(crate) fn is_empty(&self) -> bool {
        (0..2).any(|k| self.min[k] >= self.max[k])
    }
}

/// The least whole number that is not less; 0 for negative numbers, the largest for larger ones. (The library's is a call where
/// processors are not known to round.)
#[inline]
pub(crate) fn ceil(x: f64) -> u32 {
    let whole = x as u32;
    whole.saturating_add(u32::from(f64::from(whole) < x))
}
