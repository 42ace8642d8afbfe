//! Weights of faces and edges: from which sides they are seen, and how large they are.

use crate::views::Views;
use sightlines_geometry::vector::{length, normal};
use sightlines_geometry::{Point3, orient3d};
use sightlines_visible_surface::Faces;

/// From which sides faces are seen.
pub(crate) struct Fronts(Vec<[bool; 2]>);

impl Fronts {
    pub(crate) fn new(faces: &Faces, views: &Views) -> Self {
        let corners: Vec<Point3> = views.parts().iter().flat_map(|v| v.volume.corners()).collect();
        let of = |face: u32| {
            let [a, b, c] = *faces.of(face);
            let mut sides = [false; 2];
            for &eye in &corners {
                let side = orient3d(a, b, c, eye);
                sides[0] |= side > 0.0;
                sides[1] |= side < 0.0;
            }
            sides
        };
        Self(faces.ids().map(of).collect())
    }

    /// Whether some eye may be on one side of one face and on the other side of the other.
    pub(crate) fn may_differ(&self, f: u32, g: u32) -> bool {
        let (f, g) = (self.0[f as usize], self.0[g as usize]);
        f != g || f == [true, true]
    }
}

/// Areas of faces as shares of the total.
pub(crate) struct Areas {
    of: Vec<f64>,
    sum: f64,
}

impl Areas {
    pub(crate) fn new(faces: &Faces) -> Self {
        let area = |t: &[Point3; 3]| length(normal(*t)) / 2.0;
        let of: Vec<f64> = faces.corners().iter().map(area).collect();
        Self { sum: of.iter().sum(), of }
    }

    pub(crate) fn share(&self, face: u32) -> f64 {
        let share = self.of[face as usize] / self.sum;
        if share.is_finite() { share } else { 0.0 }
    }
}
