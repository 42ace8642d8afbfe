//! A scene, cut for its table only.

use crate::error::BakeError;
use crate::scene::{PortalMode, merge_portals};
use sightlines_cells::{Axial, CellGraph, Scene};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneCutter, SceneOptions, SceneSummary};

/// A scene, cut, with all portals open.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    pub(super) graph: CellGraph<Axial>,
    pub(super) solid: Vec<Aabb<3>>,
    pub(super) summary: SceneSummary,
}

impl Cut {
    /// The cells and portals that [`subdivide_scene`](sightlines_kdtree::subdivide_scene) finds.
    pub(super) fn of(
        cutter: &mut SceneCutter,
        scene: &Scene,
        cutting: &SceneOptions,
        portals: PortalMode,
    ) -> Result<Self, BakeError> {
        let cut = cutter.cut(scene, cutting)?;
        let solid = cut.left_out();
        let graph = match portals {
            PortalMode::Bounding => merge_portals(&cut.graph),
            PortalMode::Exact => cut.graph,
        };
        Ok(Self { graph, solid, summary: cut.summary })
    }
}
