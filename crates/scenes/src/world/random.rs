//! Randomly cut worlds.

use super::World;
use super::build::{Builder, Decision, EPSILON};
use super::plane::WorldPlane;
use super::polytope::Polytope;
use crate::error::{GenerateError, check_range};
use crate::rng::Rng;

/// Options of [`bsp_world`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BspWorldOptions {
    /// Different seeds give different worlds.
    pub seed: u64,
    /// Approximate number of leafs, 1 to 20000: fewer if pieces become too small to cut.
    pub leafs: u32,
    /// Percentage of solid leafs, 0 to 90.
    pub solid_percent: u32,
    /// Percentage of cuts that are not axial, 0 to 100.
    pub tilted_percent: u32,
}

impl Default for BspWorldOptions {
    fn default() -> Self {
        Self { seed: 1, leafs: 40, solid_percent: 35, tilted_percent: 50 }
    }
}

/// Half the side of the world, in scene units.
const HALF: f64 = 256.0;
/// Smallest thickness of a piece, in scene units.
const THICKNESS: f64 = 4.0;

/// A cube of 512 units, cut by random planes, axial or with normals of small integers; leafs are solid at random.
///
/// # Errors
/// [`GenerateError::OutOfRange`].
pub fn bsp_world(options: BspWorldOptions) -> Result<World, GenerateError> {
    let leafs = check_range("leafs", options.leafs, 1, 20_000)?;
    let solid = check_range("solid_percent", options.solid_percent, 0, 90)? as usize;
    let tilted = check_range("tilted_percent", options.tilted_percent, 0, 100)? as usize;
    let mut rng = Rng::new(options.seed, 0xB590);
    let region = Polytope::cuboid([-HALF; 3], [HALF; 3]);
    Ok(Builder::grow(region, leafs, |piece, wanted| {
        let cut = (0..12).take_while(|_| wanted > 1).find_map(|_| {
            let plane = random_plane(piece, &mut rng, tilted);
            let [low, high] = piece.range(&plane);
            if low > -THICKNESS || high < THICKNESS {
                return None;
            }
            Some((plane, piece.split(&plane, EPSILON)?))
        });
        match cut {
            None => Decision::Leaf { is_solid: rng.below(100) < solid },
            Some((plane, halves)) => {
                // From a third to two thirds to either side.
                let front = (wanted / 3 + rng.below(wanted as usize / 3 + 1) as u32).clamp(1, wanted - 1);
                Decision::Cut { plane, halves, data: [front, wanted - front] }
            }
        }
    }))
}

/// A plane near the middle of a piece.
fn random_plane(piece: &Polytope, rng: &mut Rng, tilted_percent: usize) -> WorldPlane {
    let middle = piece.middle();
    let mut normal = [0; 3];
    if rng.below(100) < tilted_percent {
        while normal.iter().filter(|&&n| n != 0).count() < 2 {
            normal = std::array::from_fn(|_| rng.between(-3, 3));
        }
    } else {
        // Across the longest side more often than not.
        let bounds = |k: usize| {
            let range = piece.range(&WorldPlane::axial(k, 0.0));
            range[1] - range[0]
        };
        let longest = (1..3).fold(0, |best, k| if bounds(k) > bounds(best) { k } else { best });
        normal[if rng.one_in(2) { longest } else { rng.below(3) }] = 1;
    }
    // Through a point of the grid of eight units near the middle.
    let grid = |x: f64| (x / 8.0).round() * 8.0 + f64::from(rng.between(-3, 3)) * 8.0;
    let through = middle.map(grid);
    let offset = (0..3).map(|k| f64::from(normal[k]) * through[k]).sum();
    WorldPlane { normal, offset }
}
