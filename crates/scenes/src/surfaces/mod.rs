//! Triangles that are hard to draw in order: for each method of visible-surface determination a family on which it
//! performs badly.
//!
//! All are made to be seen from [`EYE`] towards [`AT`] with [`UP`] up and an angle of [`ANGLE`]: nothing is behind the
//! eye, and little is outside the picture. Coordinates are integers of steps until the last division, by a power of
//! two.

mod crossing;
mod depth;
mod misleading;
mod random;

pub use crossing::{lattice, split_worst};
pub use depth::{DepthPairsOptions, depth_pairs};
pub use misleading::{cycles, interleaved};
pub use random::{SurfaceOptions, coplanar, slivers, soup};

use sightlines_cells::{Point3, Scene, SceneObject};

/// The eye of these scenes.
pub const EYE: Point3 = [0.0; 3];
/// The point that the eye looks at.
pub const AT: Point3 = [0.0, 0.0, 1.0];
/// The upward direction.
pub const UP: Point3 = [0.0, 1.0, 0.0];
/// The angle from the lower to the upper edge of the picture, in degrees. Positions in the picture extend half a unit
/// to all sides at distance 1, for which 53.2 degrees are enough.
pub const ANGLE: f64 = 60.0;

/// Steps in a unit.
const FINE: i64 = 1024;

/// Three corners, in steps.
type Steps = [[i64; 3]; 3];

fn real(p: [i64; 3], steps: i64) -> Point3 {
    // Steps are a power of two and places below 2^53, so that nothing is rounded.
    p.map(|x| x as f64 / steps as f64)
}

/// An object of separate triangles.
fn object(name: String, triangles: &[Steps], steps: i64) -> SceneObject {
    let vertices = triangles.iter().flatten().map(|&p| real(p, steps)).collect();
    SceneObject {
        name,
        vertices,
        triangles: (0..triangles.len() as u32).map(|k| [0, 1, 2].map(|i| 3 * k + i)).collect(),
    }
}

fn scene(objects: Vec<SceneObject>) -> Scene {
    Scene::new(objects).expect("whole numbers of steps make a scene")
}

/// A square part of the picture, with the positions in it.
#[derive(Debug, Clone, Copy)]
struct Tile {
    /// Its lower corner, in places.
    corner: [i64; 2],
    /// Number of positions in a unit at distance 1: a power of two.
    places: i64,
}

impl Tile {
    /// The `n` tiles of `side` by `side` positions that a picture is divided into, row by row.
    fn all(n: u32, side: i64) -> impl Iterator<Item = Self> {
        let row = i64::from(n.saturating_sub(1).isqrt()) + 1;
        let places = (row * side).unsigned_abs().next_power_of_two().cast_signed();
        (0..i64::from(n)).map(move |k| {
            let at = |i: i64| i * side - row * side / 2;
            Self { corner: [at(k % row), at(k / row)], places }
        })
    }

    /// The point that is seen at a position of the tile, at a depth; in steps, `places` times as many in a unit as for
    /// the depth.
    fn at(&self, place: [i64; 2], depth: i64) -> [i64; 3] {
        [(self.corner[0] + place[0]) * depth, (self.corner[1] + place[1]) * depth, self.places * depth]
    }
}

#[cfg(test)]
mod tests;
