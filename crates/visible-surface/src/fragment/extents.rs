//! Between which pixels and depths a fragment lies.

use super::{Fragment, corner};
use crate::camera::{Camera, ProjectedPoint, U};
use crate::extents::Extents;
use crate::faces::Faces;

impl Fragment {
    /// Between which pixels and depths it lies: bounds, rounded outwards, of its corners.
    pub fn extents(&self, camera: &Camera, faces: &Faces) -> Extents {
        let corners = faces.of(self.face).map(|p| camera.place(p));
        let whole = Extents::around(corners);
        if self.is_whole() {
            return whole;
        }
        let edges = self.edges();
        let before = |k: usize| &edges[(k + edges.len() - 1) % edges.len()];
        let places = edges.iter().enumerate().map(|(k, edge)| mean(&corners, corner(before(k), edge)));
        let Some(places) = places.collect::<Option<Vec<ProjectedPoint>>>() else { return whole };
        let own = Extents::around(places);
        // Both hold.
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Extents { pixels: [0, 1].map(|k| both(own.pixels[k], whole.pixels[k])), depth: both(own.depth, whole.depth) }
    }
}

/// The place of a point given by its barycentric coordinates; none if they are too rough to say.
fn mean(corners: &[ProjectedPoint; 3], (weight, error): ([f64; 3], [f64; 3])) -> Option<ProjectedPoint> {
    let sum: f64 = weight.iter().sum();
    let off: f64 = error.iter().sum::<f64>() + 4.0 * U * weight.iter().map(|w| w.abs()).sum::<f64>();
    if !(sum > 2.0 * off && sum.is_finite()) {
        return None;
    }
    let mut place = ProjectedPoint { scaled: [0.0; 3], error: [0.0; 3], ..corners[0] };
    for axis in 0..3 {
        let (mut value, mut bound) = (0.0, 0.0);
        for (c, (w, e)) in corners.iter().zip(weight.iter().zip(&error)) {
            value += w * c.scaled[axis];
            let size = w.abs() + e;
            bound += size * c.error[axis] + e * c.scaled[axis].abs() + 8.0 * U * size * c.scaled[axis].abs();
        }
        (place.scaled[axis], place.error[axis]) = (value, bound * (1.0 + 64.0 * U) + f64::MIN_POSITIVE);
    }
    // The depth is divided by the sum of the weights as well.
    place.volume_error = (place.volume_error * (sum + off) + place.volume * (off + 4.0 * U * sum)) * (1.0 + 64.0 * U)
        + f64::MIN_POSITIVE;
    place.volume *= sum;
    Some(place)
}
