//! Between which pixels and depths a camera sees something.

use crate::camera::{Camera, ProjectedPoint};
use crate::window::Window;
use sightlines_geometry::Point3;

/// Bounds of what a camera sees of something, rounded outwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extents {
    /// From the left and from the top, in pixels; everything if a corner may be behind the eye.
    pub pixels: [[f64; 2]; 2],
    /// The least depth and the greatest.
    pub depth: [f64; 2],
}

impl Extents {
    const NONE: Self =
        Self { pixels: [[f64::INFINITY, f64::NEG_INFINITY]; 2], depth: [f64::INFINITY, f64::NEG_INFINITY] };

    /// Around places.
    pub(crate) fn around(places: impl IntoIterator<Item = ProjectedPoint>) -> Self {
        places.into_iter().fold(Self::NONE, |all, place| {
            let grown = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
            let pixels = place.pixels();
            Self { pixels: [0, 1].map(|k| grown(all.pixels[k], pixels[k])), depth: grown(all.depth, place.depth()) }
        })
    }

    /// Pixels whose centres may be covered; none if all of it is outside of the depths that the camera sees.
    pub(crate) fn window(&self, camera: &Camera) -> Window {
        let [near, far] = camera.depths();
        if self.depth[1] < near || self.depth[0] > far || self.depth[1] < 0.0 {
            return Window { min: [0; 2], max: [0; 2] };
        }
        Window::around(camera, self.pixels)
    }

    /// Whether two are surely apart: to the right, down or in depth.
    pub fn is_apart(&self, other: &Self) -> bool {
        let apart = |a: [f64; 2], b: [f64; 2]| a[1] < b[0] || b[1] < a[0];
        apart(self.pixels[0], other.pixels[0])
            || apart(self.pixels[1], other.pixels[1])
            || apart(self.depth, other.depth)
    }
}

impl Window {
    /// All pixels whose centres a triangle may cover; none if it is surely outside of what the camera sees.
    #[inline]
    pub(crate) fn of_triangle(camera: &Camera, corners: &[Point3; 3]) -> Self {
        if camera.depths() != [0.0, f64::INFINITY] {
            return Extents::around(corners.map(|p| camera.place(p))).window(camera);
        }
        let places = corners.map(|p| camera.place(p));
        if places.iter().all(ProjectedPoint::is_behind) {
            return Self { min: [0; 2], max: [0; 2] };
        }
        let [a, b, c] = places.map(|p| p.pixels());
        let of = |k: usize| [a[k][0].min(b[k][0]).min(c[k][0]), a[k][1].max(b[k][1]).max(c[k][1])];
        Self::around(camera, [of(0), of(1)])
    }
}
