//! The contract of from-region methods, which determine what is hidden from a volume.

use crate::{BackendError, Volume};
use sightlines_geometry::Aabb;
use std::fmt;

/// The guarantee of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guarantee {
    /// What it reports hidden is hidden, for every scene.
    Conservative,
    /// What it reports hidden is hidden if the scene satisfies the condition in the text, such as `"closed surfaces
    /// only"`.
    ConservativeIf(&'static str),
}

/// A from-region method, prepared for a scene.
pub trait FromRegion: fmt::Debug {
    /// Stable lower-case name for test titles and charts.
    fn name(&self) -> String;

    /// Its guarantee.
    fn guarantee(&self) -> Guarantee;

    /// Whether eyes inside solid matter are excluded from the guarantee, because the method uses its inside as an
    /// occluder.
    fn only_in_air(&self) -> bool {
        false
    }

    /// Prepares the umbra of one volume.
    ///
    /// # Errors
    /// [`BackendError`], if a backend is used and nothing could take over.
    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError>;
}

/// What is hidden from one volume.
pub trait Umbra {
    /// Whether all of `target`, a closed box, is certainly hidden from all of the volume: every segment from
    /// an eye to a point of it meets an occluder before that point, or at it where an occluder touches the border of the box; no open set
    /// of segments gets through. A box that meets the volume never is.
    fn hides(&mut self, target: &Aabb<3>) -> bool;

    /// The same of a box around so many triangles, whose number says how much the answer may cost: unless the box is hidden, each of
    /// them is looked at, up to the first that is not hidden.
    fn hides_box_of(&mut self, target: &Aabb<3>, _n_triangles: usize) -> bool {
        self.hides(target)
    }

    /// Whether all of a polygon, or of the convex hull of points, is certainly hidden. By default tests the box around
    /// it.
    fn hides_points(&mut self, points: &[sightlines_geometry::Point3]) -> bool {
        self.hides(&Aabb::around(points.iter().copied()))
    }

    /// Forgets what earlier questions have taught, which may make later ones quicker and other targets hidden: what is answered from here on does not depend
    /// on what was asked before.
    fn forget(&mut self) {}

    /// The same by every method, if there are several of which only some are asked about points.
    fn hides_points_by_any(&mut self, points: &[sightlines_geometry::Point3]) -> bool {
        self.hides_points(points)
    }
}
