//! A scene, cut for its table only.

use crate::plan::BakeError;
use crate::scene::{PortalMode, loosened};
use sightlines_cells::{Axial, CellGraph, Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, SceneSummary, default_detail_below, subdivide_scene};

/// A scene, cut, with all portals open.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    pub(super) graph: CellGraph<Axial>,
    pub(super) solid: Vec<Aabb<3>>,
    /// Counts of triangles leave out those of detail.
    pub(super) summary: SceneSummary,
}

impl Cut {
    /// The cells and portals that [`subdivide_scene`] finds.
    pub(super) fn of(scene: &Scene, cutting: &SceneOptions, portals: PortalMode) -> Result<Self, BakeError> {
        let cut = match without_detail(scene, cutting.detail_below) {
            Some((scene, detail_below)) => {
                subdivide_scene(&scene, &SceneOptions { detail_below: Some(detail_below), ..*cutting })?
            }
            None => subdivide_scene(scene, cutting)?,
        };
        let solid = cut.left_out();
        let graph = match portals {
            PortalMode::Bounding => loosened(&cut.graph),
            PortalMode::Exact | PortalMode::TwoLevel => cut.graph,
        };
        Ok(Self { graph, solid, summary: cut.summary })
    }
}

/// The same scene with no more of each object that is detail than two corners of its box, which is all that cutting
/// looks at; and the size below which things are detail. `None` for a size that is refused anyway. O(vertices).
fn without_detail(scene: &Scene, detail_below: Option<f64>) -> Option<(Scene, f64)> {
    let bounds: Vec<Aabb<3>> = scene.objects().iter().map(SceneObject::bounds).collect();
    let corners = |b: &Aabb<3>| {
        let vertices = if b.is_empty() { Vec::new() } else { vec![b.min, b.max] };
        SceneObject { name: String::new(), vertices, triangles: Vec::new() }
    };
    let below = match detail_below {
        Some(size) => Some(size).filter(|size| *size >= 0.0)?,
        None => default_detail_below(&Scene::new(bounds.iter().map(corners).collect()).ok()?),
    };
    let is_detail = |b: &Aabb<3>| (0..3).all(|k| b.max[k] - b.min[k] < below);
    let objects = scene.objects().iter().zip(&bounds);
    let kept = objects.map(|(object, b)| if is_detail(b) && !b.is_empty() { corners(b) } else { object.clone() });
    Some((Scene::new(kept.collect()).ok()?, below))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sightlines_kdtree::PortalForm;
    use sightlines_scenes::{TowerOptions, tower};

    /// Invariant: what is left of detail makes the same cells as all of it.
    #[test]
    fn detail_divides_nothing() {
        for (seed, detail_below) in [(1, None), (2, Some(0.0)), (3, Some(1.0)), (4, Some(9.0))] {
            let options = TowerOptions { seed, floors: 2, rooms_x: 2, rooms_y: 1, ..TowerOptions::default() };
            let scene = tower(options).expect("a tower");
            let cutting = SceneOptions { detail_below, portals: PortalForm::Exact, ..SceneOptions::default() };
            let plain = subdivide_scene(&scene, &cutting).expect("cells");
            let cut = Cut::of(&scene, &cutting, PortalMode::Exact).expect("cells");
            assert!(cut.graph == plain.graph && cut.solid == plain.left_out(), "{detail_below:?}");
            assert_eq!(cut.summary.detail_below, plain.summary.detail_below);
            assert_eq!(cut.summary.n_detail_objects, plain.summary.n_detail_objects);
            let n_read = |summary: &SceneSummary| summary.n_axial_triangles + summary.n_other_triangles;
            assert_eq!(n_read(&cut.summary) < n_read(&plain.summary), plain.summary.n_detail_objects > 0);
        }
        let refused = SceneOptions { detail_below: Some(f64::NAN), ..SceneOptions::default() };
        let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() });
        assert!(Cut::of(&scene.expect("a tower"), &refused, PortalMode::Exact).is_err());
    }
}
