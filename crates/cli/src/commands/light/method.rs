//! The from-region methods as arguments.

use sightlines::from_region::ViewShafts;
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines::multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod};
use sightlines::multifocal_cpu::Fast;
use std::sync::Arc;

/// Occluders that are drawn on each side of the light.
const MOST_OCCLUDERS: usize = 1024;

/// A method as an argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Kind {
    /// Sheets: surfaces that as a whole separate the light from a piece
    Sheets,
    /// View shafts: single occluders that cut all lines between the light and a piece
    Shafts,
    /// Multifocal buffers around the light
    Multifocal,
}

/// What any of these methods hides.
pub(super) fn made(kinds: &[Kind], triangles: &[[Point3; 3]], scene: Aabb<3>) -> UnionMethod {
    let one = |&kind: &Kind| -> Box<dyn FromRegion + Send> {
        let occluders = || patches(triangles, &PatchOptions::default());
        match kind {
            Kind::Sheets => Box::new(SheetMethod::new(triangles)),
            Kind::Shafts => Box::new(ViewShafts::new(occluders())),
            Kind::Multifocal => {
                let chosen = Arc::new(OccluderSelection::new(occluders(), MOST_OCCLUDERS));
                Box::new(Multifocal::new(Fast::new(), chosen, scene, Layout::default()))
            }
        }
    };
    let mut unlike: Vec<Kind> = Vec::new();
    kinds.iter().for_each(|kind| {
        if !unlike.contains(kind) {
            unlike.push(*kind)
        }
    });
    UnionMethod::for_polygons(unlike.iter().map(one).collect())
}
