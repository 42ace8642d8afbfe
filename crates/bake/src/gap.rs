//! How precise the coordinates of a scene are.

use sightlines_cells::Scene;
use sightlines_formats::SceneInfo;
use sightlines_formats::scene::SceneFormat;

/// How precise the coordinates of a scene are: openings narrower than this may count as closed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Gap {
    /// As precise as the format of the file is ([`Gap::of_file`]), where a frame makes walls of much that is none without it; else
    /// exactly as they are.
    #[default]
    OfFile,
    /// This width, in scene units; 0 takes all coordinates exactly as they are.
    Width(f64),
}

impl Gap {
    /// The precision of a scene from a file, in scene units; 0 for what is in doubles or in decimals.
    ///
    /// glTF stores coordinates in single precision. Let M be the largest magnitude of a coordinate and u = 2^-24, so that
    /// rounding a coordinate moves it by at most u M. Whoever turns a building in single precision has rounded the entries of
    /// the rotation (3 u M for a sum of three products with them), the products and their sums (3 u M more), and the place in the end
    /// (u M): below 7 u M along each axis of the file, and so below √3 × 7 u M < 13 u M along any other. Coordinates of one plane then
    /// differ by no more than 26 u M from each other; that is what half the gap has to hold in the worst case, but these bounds are
    /// far from what is met: errors are of either sign, and most programs turn in double precision and round once (√3 u M). Half the gap is
    /// therefore 8 u M, and the gap 16 u M = 2^-20 M: 0.03 mm for a building of 30 m.
    pub fn of_file(scene: &Scene, file: &SceneInfo) -> f64 {
        let bounds = scene.bounds();
        if file.format != SceneFormat::Gltf || bounds.is_empty() {
            return 0.0;
        }
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0f64, |m, x| m.max(x.abs()));
        largest / f64::from(1 << 20)
    }
}
