//! Line space as a method by name.

use super::{Entry, Prepared, welded};
use sightlines_line_space::{Effort, LineSpace, Surface};
use sightlines_multifocal::FromRegion;
use sightlines_multifocal::mesh::Mesh;
use std::sync::Arc;

pub(super) const ENTRY: Entry = Entry {
    name: "line-space",
    about: "Surfaces in any direction, several together: line space subdivided",
    prepare: |scene, _| Ok(prepared(welded(scene))),
};

/// Line space for a mesh.
pub(super) fn prepared(mesh: Mesh) -> Box<dyn Prepared> {
    Box::new(Shared(Arc::new(Surface::of(mesh))))
}

/// What the instances of all threads share.
struct Shared(Arc<Surface>);

impl Prepared for Shared {
    fn instance(&self) -> Box<dyn FromRegion + Send> {
        Box::new(LineSpace::shared(Arc::clone(&self.0), Effort::default()))
    }

    fn surface(&self) -> Option<Arc<Surface>> {
        Some(Arc::clone(&self.0))
    }
}
