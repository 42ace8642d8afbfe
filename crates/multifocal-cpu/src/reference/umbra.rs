//! What is blocked.

use sightlines_geometry::{Point3, orient3d};
use sightlines_multifocal::{Occluder, Volume};

/// An occluder and the volume that is wholly on one side of it.
pub(super) struct Hiding<'a> {
    occluder: &'a Occluder,
    eyes: [Point3; 8],
    /// 1 if the eyes are in front of the facets, -1 if behind.
    sign: f64,
}

impl<'a> Hiding<'a> {
    /// None if the volume is not strictly on one side of all facets: then nothing is hidden.
    pub(super) fn new(occluder: &'a Occluder, volume: &Volume) -> Option<Self> {
        let eyes = volume.corners();
        let sign = if occluder.side_of(&eyes)? { 1.0 } else { -1.0 };
        Some(Self { occluder, eyes, sign })
    }

    pub(super) const fn occluder(&self) -> &Occluder {
        self.occluder
    }

    /// Whether the eyes are in front of the facets, else they are behind.
    pub(super) fn is_in_front(&self) -> bool {
        self.sign > 0.0
    }

    pub(super) const fn eyes(&self) -> &[Point3; 8] {
        &self.eyes
    }

    /// Whether every segment from the volume to the convex hull of `points` is blocked: each of `points` lies behind
    /// or on the plane of each facet, and each segment from a corner of the volume to it passes all edges of the
    /// outline on the inner side, or touches them. Exact.
    pub(super) fn hides(&self, points: &[Point3]) -> bool {
        points.iter().all(|&p| self.is_behind(p) && self.eyes.iter().all(|&v| self.passes_inside(v, p)))
    }

    fn is_behind(&self, p: Point3) -> bool {
        self.occluder.facets().iter().all(|&[a, b, c]| self.sign * orient3d(a, b, c, p) <= 0.0)
    }

    /// Seen from in front the outline goes round counter-clockwise, so that of two corners and the eye before
    /// them the right-hand normal points away from what is inside.
    fn passes_inside(&self, v: Point3, p: Point3) -> bool {
        let outline = self.occluder.outline();
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).all(|(&a, &b)| self.sign * orient3d(v, a, b, p) <= 0.0)
    }
}
