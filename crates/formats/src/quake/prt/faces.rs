//! Hints of portals, and solid faces: what files of Quake III have besides. Visibility does not need them.

use super::{PORTAL_POINTS, Prt, beyond};
use crate::error::{Malformed, Within};
use crate::point::check_point;
use sightlines_cells::Point3;

/// Where a cluster ends at something solid.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidFace {
    /// The cluster.
    pub cluster: u32,
    /// Its 3 to 64 corners in turn, in scene units.
    pub points: Vec<Point3>,
}

impl Prt {
    /// The same portals in the form of Quake III: with a number for each that states whether it is a hint, and with solid faces. Lists of leafs
    /// are dropped, as the form has none.
    ///
    /// # Errors
    /// [`Malformed`] for another number of hints than of portals, and for a face with a cluster, a number of points or a coordinate that cannot be.
    pub fn with_faces(mut self, hints: Vec<u32>, mut faces: Vec<SolidFace>) -> Result<Self, Malformed> {
        let n = self.n_portals();
        if hints.len() != n {
            return Err(beyond(hints.len(), n..=n).within(format_args!("the hint of portal {}", hints.len().min(n))));
        }
        for (face, solid) in faces.iter_mut().enumerate() {
            if !PORTAL_POINTS.contains(&solid.points.len()) {
                let place = format_args!("the number of points of solid face {face}");
                return Err(beyond(solid.points.len(), PORTAL_POINTS).within(place));
            }
            if solid.cluster >= self.n_clusters() {
                let place = format_args!("the cluster of solid face {face}");
                return Err(beyond(solid.cluster, 0..=self.n_clusters() - 1).within(place));
            }
            for (point, p) in solid.points.iter_mut().enumerate() {
                *p = check_point(*p).within(format_args!("solid face {face}, point {point}"))?;
            }
        }
        (self.leafs, self.faces) = (None, Some((hints, faces)));
        Ok(self)
    }

    /// The numbers of portals that state whether they are hints; `None` in forms without them.
    pub fn hints(&self) -> Option<&[u32]> {
        self.faces.as_ref().map(|(hints, _)| &hints[..])
    }

    /// Where clusters end at something solid; empty in forms without that.
    pub fn solid_faces(&self) -> &[SolidFace] {
        self.faces.as_ref().map_or(&[], |(_, faces)| faces)
    }
}
