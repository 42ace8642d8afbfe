//! Line space as a method by name.

use super::{Entry, Prepared, triangles};
use sightlines_geometry::Point3;
use sightlines_line_space::{Effort, LineSpace, Surface};
use sightlines_multifocal::FromRegion;
use sightlines_multifocal::mesh::Mesh;
use std::sync::Arc;

pub(super) const ENTRY: Entry = Entry {
    name: "line-space",
    about: "Surfaces in any direction, several together: line space subdivided",
    prepare: |scene, _| {
        let fronts: Vec<_> = scene.front_occluding_triangles().collect();
        Ok(with_fronts(&triangles(scene), &fronts))
    },
};

/// Line space for these triangles.
pub(super) fn prepared(mesh: Mesh) -> Box<dyn Prepared> {
    Box::new(Shared(Arc::new(Surface::of(mesh))))
}

/// The same of these, and of others that hide from their fronts only.
pub(super) fn with_fronts(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]]) -> Box<dyn Prepared> {
    Box::new(Shared(Arc::new(Surface::with_fronts(both_sides, fronts))))
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
