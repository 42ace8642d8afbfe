//! Faces close behind each other, near and far, to test the precision of depths.

use super::{FINE, Steps, Tile, object, scene};
use crate::error::{GenerateError, check_range};
use sightlines_cells::Scene;

/// Options of [`depth_pairs`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DepthPairsOptions {
    /// Number of pairs, from 1 to 40.
    pub pairs: u32,
    /// The distance of the faces of each pair along the axis of view, in 1/1024 units; from 1 to 64 for each unit of
    /// `nearest`.
    pub gap: u32,
    /// The depth of the nearest pair in units, from 1 to 1024.
    pub nearest: u32,
}

impl Default for DepthPairsOptions {
    /// 24 pairs 1/64 apart, from depth 1 to depth 3072.
    fn default() -> Self {
        Self { pairs: 24, gap: 16, nearest: 1 }
    }
}

/// Places along the side of a tile.
const SIDE: i64 = 32;

/// Pairs of parallel faces with the same gap, each pair in its own tile, with depths that grow alternately by about a
/// half and a third. The faces are sloped: a quarter deeper on one side than on the other. Each is two triangles, an
/// object `back_0`, `front_0`, `back_1` and so on. The front face has the higher id, so that depths that cannot be
/// distinguished show the wrong one.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn depth_pairs(options: DepthPairsOptions) -> Result<Scene, GenerateError> {
    let pairs = check_range("pairs", options.pairs, 1, 40)?;
    let nearest = i64::from(check_range("nearest", options.nearest, 1, 1024)?);
    let gap = i64::from(check_range("gap", options.gap, 1, 64 * options.nearest)?);
    let mut objects = Vec::new();
    for (tile, k) in Tile::all(pairs, SIDE).zip(0..) {
        let halves = if k % 2 == 1 { 3 } else { 2 };
        let depth = (nearest << (k / 2)) * FINE / 2 * halves;
        for (name, behind) in [("back", 0), ("front", -gap)] {
            let corner = |place: [i64; 2], depth: i64| {
                let [x, y, z] = tile.at(place, depth);
                [x, y, z + behind * tile.places]
            };
            let deep = depth * 5 / 4;
            let [a, b, c, d] =
                [corner([4, 4], depth), corner([4, 28], depth), corner([28, 28], deep), corner([28, 4], deep)];
            let triangles: [Steps; 2] = [[a, b, c], [a, c, d]];
            objects.push(object(format!("{name}_{k}"), &triangles, tile.places * FINE));
        }
    }
    Ok(scene(objects))
}
