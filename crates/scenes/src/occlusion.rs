//! A benchmark of visibility from a volume: rectangles as occluders, and boxes behind and beside them.
//!
//! The rectangles stand between a volume around the origin and most of the boxes, in no order; about half of the boxes
//! are hidden, most of them by several rectangles together or by one with a small margin. So methods with bounds of
//! different tightness find different numbers of them.

use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;

/// Options of [`occlusion`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OcclusionOptions {
    /// Determines every random choice. Another tilt tilts the same rectangles differently.
    pub seed: u64,
    /// Rectangles, from 1 to 65536.
    pub occluders: u32,
    /// Boxes, from 1 to 65536.
    pub occludees: u32,
    /// How steep rectangles may be, in hundredths, from 0 to 100: the depth along a rectangle differs by at most this
    /// much for each unit across, along either of its sides. 0: all face the volume.
    pub tilt: u32,
}

impl Default for OcclusionOptions {
    /// 36 rectangles that face the volume, and 400 boxes.
    fn default() -> Self {
        Self { seed: 1, occluders: 36, occludees: 400, tilt: 0 }
    }
}

/// A benchmark.
#[derive(Debug, Clone, PartialEq)]
pub struct Occlusion {
    /// The occluders: objects `occluder_0` and so on, each of four corners in a plane and two triangles that face the
    /// origin.
    pub scene: Scene,
    /// The boxes that may be hidden, and hide nothing.
    pub occludees: Vec<Aabb<3>>,
}

impl Occlusion {
    /// The corners of each rectangle, counter-clockwise as seen from the origin.
    pub fn rectangles(&self) -> impl ExactSizeIterator<Item = [Point3; 4]> + '_ {
        self.scene.objects().iter().map(|o| [0, 1, 2, 3].map(|k| o.vertices[k]))
    }

    /// The cube of eyes around the origin.
    ///
    /// * `half`: half of its side in units, at most 0.5 so that it is in front of everything
    pub const fn volume(half: f64) -> Aabb<3> {
        Aabb { min: [-half; 3], max: [half; 3] }
    }

    /// A depth in units beyond everything: where a plane can be.
    pub const FAR: f64 = 20.0;
}

/// Steps in a unit.
const FINE: i32 = 256;

/// A benchmark in the direction of z: centres of rectangles are 3 to 15 units away, and of boxes 5 to 18. Coordinates
/// are multiples of 1/256.
///
/// Source: the setting is that of our own measurements; numbers and sizes were chosen so that 30 to 60 % of
/// the boxes are hidden from the volume of half size 0.25, by sampling.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn occlusion(options: OcclusionOptions) -> Result<Occlusion, GenerateError> {
    let n_occluders = check_range("occluders", options.occluders, 1, 1 << 16)?;
    let n_occludees = check_range("occludees", options.occludees, 1, 1 << 16)?;
    let tilt = check_range("tilt", options.tilt, 0, 100)?;
    let tilt = i32::try_from(tilt).expect("at most 100");
    let mut rng = Rng::new(options.seed, 11);
    let (mut walls, mut boxes) = (Rng::new(rng.next(), 0), Rng::new(rng.next(), 0));
    let objects = (0..n_occluders).map(|i| rectangle(&mut walls, tilt, format!("occluder_{i}"))).collect();
    let scene = Scene::new(objects).expect("corners on a grid of 256ths make a scene");
    Ok(Occlusion { scene, occludees: (0..n_occludees).map(|_| cuboid(&mut boxes)).collect() })
}

fn real(p: [i32; 3]) -> Point3 {
    p.map(|x| f64::from(x) / f64::from(FINE))
}

/// The position of a centre in steps: uniform over depths, and over the view at each depth, 45 degrees wide and high.
fn centre(rng: &mut Rng, near: i32, far: i32) -> [i32; 3] {
    let z = rng.between(near * FINE, far * FINE);
    let wide = z * 2 / 5;
    [rng.between(-wide, wide), rng.between(-wide, wide), z]
}

/// A parallelogram that is a rectangle as seen along z; a rectangle if it is tilted along one side or none.
fn rectangle(rng: &mut Rng, tilt: i32, name: String) -> SceneObject {
    let [x, y, z] = centre(rng, 3, 15);
    // Grows with depth, so that near ones do not hide everything.
    let mut half = || FINE / 4 + rng.between(z / 24, z / 8);
    let [a, b] = [half(), half()];
    // Drawn for every tilt, so that the rest does not depend on the tilt.
    let [s, t] = [rng.between(-FINE, FINE), rng.between(-FINE, FINE)];
    let rise = |slope: i32, half: i32| slope * tilt / 100 * half / FINE;
    let (p, q) = (rise(s, a), rise(t, b));
    let corners = [[-a, -b, -p - q], [-a, b, q - p], [a, b, p + q], [a, -b, p - q]];
    let vertices = corners.map(|[u, v, w]| real([x + u, y + v, z + w])).to_vec();
    SceneObject { name, vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

fn cuboid(rng: &mut Rng) -> Aabb<3> {
    let middle = centre(rng, 5, 18);
    let half = [0; 3].map(|_| rng.between(FINE / 16, FINE / 2));
    Aabb { min: real([0, 1, 2].map(|k| middle[k] - half[k])), max: real([0, 1, 2].map(|k| middle[k] + half[k])) }
}

#[cfg(test)]
mod tests;
