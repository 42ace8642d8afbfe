//! Which pixels a convex piece of the picture covers: row by row, exactly.

use crate::camera::Camera;
use crate::faces::Faces;
use crate::side::Side;
use crate::window::{Window, ceil};

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
