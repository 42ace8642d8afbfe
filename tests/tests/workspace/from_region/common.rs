//! The methods, and how they are run.

use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines::multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod, Volume};
use sightlines::multifocal_cpu::Fast;
use std::sync::Arc;

/// The triangles of a scene.
pub(crate) fn triangles(scene: &sightlines::cells::Scene) -> Vec<[Point3; 3]> {
    scene.objects().iter().flat_map(|o| o.corners()).collect()
}

/// The box around a scene and targets.
pub(crate) fn around(scene: &sightlines::cells::Scene, targets: &[Aabb<3>]) -> Aabb<3> {
    let ends = targets.iter().flat_map(|b| [b.min, b.max]);
    Aabb::around(ends.chain([scene.bounds().min, scene.bounds().max]))
}

/// Buffers with a layout, for a scene whose patches hide.
pub(crate) fn buffers(triangles: &[[Point3; 3]], around: Aabb<3>, layout: Layout) -> Multifocal<Fast> {
    let occluders = Arc::new(OccluderSelection::new(patches(triangles, &PatchOptions::default()), 2000));
    Multifocal::new(Fast::new(), occluders, around, layout)
}

/// What is shipped: buffers, and sheets where they say nothing.
pub(crate) fn shipped(triangles: &[[Point3; 3]], around: Aabb<3>) -> UnionMethod {
    let buffers = buffers(triangles, around, Layout::default());
    UnionMethod::new(vec![Box::new(buffers), Box::new(SheetMethod::new(triangles))])
}

/// Which targets a method calls hidden.
pub(crate) fn hidden(method: &mut dyn FromRegion, volume: &Aabb<3>, targets: &[Aabb<3>]) -> Vec<usize> {
    let volume = Volume::new(*volume).expect("a box of good numbers");
    let mut umbra = method.umbra(&volume).expect("the CPU does not fail");
    (0..targets.len()).filter(|&i| umbra.hides(&targets[i])).collect()
}
