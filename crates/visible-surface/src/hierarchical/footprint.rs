//! What a box or a face may cover of a picture, and how near it comes.

use super::Rays;
use crate::camera::{Camera, U};
use crate::fragment::Extents;
use crate::window::Window;
use sightlines_geometry::Point3;

/// Pixels that may be covered, and the greatest nearness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Footprint {
    /// None where nothing is covered.
    pub(super) pixels: Window,
    /// Infinite for what may reach the eye or behind it.
    pub(super) nearness: f64,
}

impl Footprint {
    /// Of the convex hull of points with coordinates of usable size.
    pub(super) fn of(camera: &Camera, rays: Rays, points: impl IntoIterator<Item = Point3>) -> Self {
        let extents = Extents::around(points.into_iter().map(|p| camera.place(p)));
        let pixels = match rays {
            Rays::Centres => extents.window(camera),
            Rays::All => touched(camera, &extents),
        };
        Self { pixels, nearness: nearness_above(extents.depth[0]) }
    }
}

/// Pixels that are touched, if any is by what the camera sees of it.
fn touched(camera: &Camera, extents: &Extents) -> Window {
    let [near, far] = camera.depths();
    let size = camera.size();
    let outside = |k: usize| extents.pixels[k][1] < 0.0 || extents.pixels[k][0] > f64::from(size[k]);
    if extents.depth[1] < near || extents.depth[0] > far || extents.depth[1] < 0.0 || outside(0) || outside(1) {
        return Window { min: [0; 2], max: [0; 2] };
    }
    // The casts stop at 0. A ray along the line between two pixels is one of each, so one of them is enough.
    let min = [0, 1].map(|k| (extents.pixels[k][0].floor() as u32).min(size[k] - 1));
    let max = [0, 1].map(|k| (extents.pixels[k][1].ceil() as u32).clamp(min[k] + 1, size[k]));
    Window { min, max }
}

/// An upper bound of one over a depth, of which a lower bound is given.
pub(super) fn nearness_above(depth: f64) -> f64 {
    // One rounding in the quotient.
    if depth > 0.0 { 1.0 / depth * (1.0 + 4.0 * U) } else { f64::INFINITY }
}

/// A lower bound of one over a depth that is at most the positive one given; infinite for 0.
pub(super) fn nearness_below(depth: f64) -> f64 {
    1.0 / depth * (1.0 - 4.0 * U)
}
