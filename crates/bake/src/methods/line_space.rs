//! Line space as a method by name.

use super::{Entry, Prepared, triangles};
use sightlines_geometry::Point3;
use sightlines_line_space::{Effort, LineSpace, Surface};
use sightlines_multifocal::FromRegion;
use std::sync::Arc;

pub(super) const ENTRY: Entry = Entry {
    name: "line-space",
    about: "Surfaces in any direction, several together: line space subdivided",
    prepare: |scene, _| Ok(prepared(&triangles(scene))),
};

/// Line space for these triangles.
pub(super) fn prepared(triangles: &[[Point3; 3]]) -> Box<dyn Prepared> {
    Box::new(Shared(Arc::new(Surface::new(triangles))))
}

/// What the instances of all threads share.
struct Shared(Arc<Surface>);

impl Prepared for Shared {
    fn instance(&self) -> Box<dyn FromRegion + Send> {
        Box::new(LineSpace::shared(Arc::clone(&self.0), Effort::default()))
    }
}
