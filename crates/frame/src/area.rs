//! How much of the surfaces of a scene lies across an axis.

use sightlines_cells::Scene;
use sightlines_geometry::vector::{length, normal};
use sightlines_geometry::{Aabb, Point3};

/// Areas of what hides in a scene, in square units. Estimates: nothing is decided by them but which frame is worth taking.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Areas {
    /// Of all triangles.
    pub all: f64,
    /// Of those whose corners have one coordinate in common, to the last bit.
    pub axial: f64,
}

impl Areas {
    /// Of the triangles of a scene that hide what is behind them. O(n) for n triangles.
    pub fn of(scene: &Scene) -> Self {
        let mut areas = Self::default();
        for t in scene.occluding_triangles().chain(scene.front_occluding_triangles()) {
            let area = area(&t);
            areas.all += area;
            areas.axial += if (0..3).any(|k| spread(&t, k) == 0.0) { area } else { 0.0 };
        }
        areas
    }

    /// The share of the area that is axial; 1 if there is no area.
    pub fn axial_share(&self) -> f64 {
        if self.all > 0.0 { (self.axial / self.all).min(1.0) } else { 1.0 }
    }
}

pub(crate) fn area(t: &[Point3; 3]) -> f64 {
    length(normal(*t)) / 2.0
}

/// How far apart the corners of a triangle are along an axis.
pub(crate) fn spread(t: &[Point3; 3], axis: usize) -> f64 {
    let [a, b, c] = t.map(|p| p[axis]);
    a.max(b).max(c) - a.min(b).min(c)
}

/// The axis that a vector is nearest to; the first of several.
pub(crate) fn main_axis(v: Point3) -> usize {
    let size = v.map(f64::abs);
    if size[0] >= size[1] && size[0] >= size[2] {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    }
}

/// The largest magnitude of a coordinate.
pub(crate) fn magnitude(b: &Aabb<3>) -> f64 {
    if b.is_empty() { 0.0 } else { b.min.iter().chain(&b.max).fold(0.0, |m, x| m.max(x.abs())) }
}
