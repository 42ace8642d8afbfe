//! How to cut a scene in space.

use crate::build::KdOptions;
use sightlines_geometry::Aabb;

/// How to cut a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneOptions {
    /// Where a viewer can be, in scene units; the scene's box if none is given. The box around it and the scene is cut.
    /// Rooms that cannot be reached from a given region are left out.
    pub view_region: Option<Aabb<3>>,
    /// Obscuration threshold, see [`KdOptions::tau`].
    pub tau: f64,
    /// Things that are smaller than this in every direction, in scene units, are drawn, but hide nothing
    /// and divide nothing. 0 keeps everything; none takes
    /// [`default_detail_below`](crate::default_detail_below).
    pub detail_below: Option<f64>,
    /// Limit for the number of cells, those that are left out included, see [`KdOptions::max_cells`].
    pub max_cells: u32,
    /// Whether the insides of walls and other solid things stay cells.
    pub keep_solid: bool,
    /// Whether what hides from its front only divides cells and hides nothing, but where two such walls stand back to back.
    pub only_both_sides: bool,
}

/// Number of cells beyond which a visibility table takes gigabytes: 2^32 bits are half of one.
const MAX_CELLS: u32 = 1 << 16;

impl Default for SceneOptions {
    fn default() -> Self {
        let (tau, max_cells) = (KdOptions::default().tau, MAX_CELLS);
        Self { view_region: None, tau, detail_below: None, max_cells, keep_solid: false, only_both_sides: false }
    }
}
