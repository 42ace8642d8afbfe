//! Which pixels a convex piece of the picture covers: row by row, exactly.

use crate::camera::{Camera, Place};
use crate::faces::Faces;
use crate::fragment::Extents;
use crate::side::Side;
use sightlines_geometry::Point3;

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

    /// The same of a triangle; none if it is surely outside of what the camera sees.
    #[inline]
    pub(crate) fn of_triangle(camera: &Camera, corners: &[Point3; 3]) -> Self {
        if camera.depths() != [0.0, f64::INFINITY] {
            return Extents::around(corners.map(|p| camera.place(p))).window(camera);
        }
        let places = corners.map(|p| camera.place(p));
        if places.iter().all(Place::is_behind) {
            return Self { min: [0; 2], max: [0; 2] };
        }
        let [a, b, c] = places.map(|p| p.pixels());
        let of = |k: usize| [a[k][0].min(b[k][0]).min(c[k][0]), a[k][1].max(b[k][1]).max(c[k][1])];
        Self::around(camera, [of(0), of(1)])
    }

    pub(crate) fn is_empty(&self) -> bool {
        (0..2).any(|k| self.min[k] >= self.max[k])
    }
}

/// The least whole number that is not less; 0 for negative numbers, the largest for larger ones. (The library's is a call where
/// processors are not known to round.)
#[inline]
fn ceil(x: f64) -> u32 {
    let whole = x as u32;
    whole.saturating_add(u32::from(f64::from(whole) < x))
}

/// Calls `span(y, from, to)` for each row of `window` that has pixels with centres inside of all `sides`: those from `from` to
/// before `to`. Returns how many times doubles could not tell.
#[inline]
pub(crate) fn spans(
    camera: &Camera,
    faces: &Faces,
    sides: &[Side],
    window: Window,
    mut span: impl FnMut(u32, u32, u32),
) -> u64 {
    let mut doubts = 0;
    'rows: for y in window.min[1]..window.max[1] {
        let (mut from, mut to) = (window.min[0], window.max[0]);
        for side in sides {
            (from, to) = narrowed(camera, faces, side, y, from, to, &mut doubts);
            if from >= to {
                continue 'rows;
            }
        }
        span(y, from, to);
    }
    doubts
}

/// Those of the pixels from `from` to before `to` of a row whose centres are inside a side.
#[inline]
fn narrowed(camera: &Camera, faces: &Faces, side: &Side, y: u32, from: u32, to: u32, doubts: &mut u64) -> (u32, u32) {
    let base = side.b * (f64::from(y) + 0.5) + side.c;
    let at = |x: u32| side.a * (f64::from(x) + 0.5) + base;
    let (first, last) = (at(from), at(to - 1));
    let error = side.error;
    if first > error && last > error {
        return (from, to);
    }
    if first < -error && last < -error {
        return (from, from);
    }
    // Where the function crosses zero; at the first pixel behind it what is inside begins or ends.
    let x = ceil(-base / side.a - 0.5);
    if x > from && x < to {
        let (before, after) = (at(x - 1), at(x));
        if before < -error && after > error {
            return (x, to);
        }
        if before > error && after < -error {
            return (from, x);
        }
    }
    *doubts += 1;
    search(camera, faces, side, y, from, to)
}

/// The same, asking for single pixels: along a row a side is entered or left once.
#[cold]
#[inline(never)]
fn search(camera: &Camera, faces: &Faces, side: &Side, y: u32, from: u32, to: u32) -> (u32, u32) {
    let has = |x: u32| side.has(camera, faces, x, y);
    match (has(from), has(to - 1)) {
        (true, true) => (from, to),
        (false, false) => (from, from),
        (inside, _) => {
            // The pixel `low` is as the first one, and `high` as the last.
            let (mut low, mut high) = (from, to - 1);
            while high - low > 1 {
                let middle = low + (high - low) / 2;
                if has(middle) == inside {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if inside { (from, high) } else { (high, to) }
        }
    }
}
