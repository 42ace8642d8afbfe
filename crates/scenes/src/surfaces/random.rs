//! Random triangles: in space, in one plane, and almost without area.

use super::{FINE, Steps, object, scene};
use crate::error::{GenerateError, check_range};
use crate::rng::Rng;
use sightlines_cells::Scene;

/// The number of triangles and their density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceOptions {
    /// Determines every random choice.
    pub seed: u64,
    /// From 1 to 2^20.
    pub triangles: u32,
    /// Approximate number of triangles that cover each point of the picture, whatever their number; from 1 to 64.
    pub layers: u32,
}

impl Default for SurfaceOptions {
    /// A thousand triangles in four layers.
    fn default() -> Self {
        Self { seed: 1, triangles: 1000, layers: 4 }
    }
}

/// The depth around which everything is, in units, and the width of the picture there.
const DEPTH: i64 = 16;

impl SurfaceOptions {
    fn checked(self) -> Result<Self, GenerateError> {
        check_range("triangles", self.triangles, 1, 1 << 20)?;
        check_range("layers", self.layers, 1, 64)?;
        Ok(self)
    }

    /// Half of the side of a cube, in steps, such that triangles with random corners in it cover the picture with the
    /// requested number of layers.
    fn half(&self) -> i32 {
        // The mean area of a triangle in a square of side s is 11/144 s^2; with s = 2 half, 11/36 half^2.
        let picture = (DEPTH * FINE).unsigned_abs();
        let square = picture * picture * 36 * u64::from(self.layers) / (11 * u64::from(self.triangles));
        i32::try_from(square.isqrt().clamp(8, picture / 4)).expect("at most a quarter of the picture")
    }

    fn made(&self, name: &str, mut triangle: impl FnMut() -> Steps) -> Scene {
        let triangles: Vec<Steps> = (0..self.triangles)
            .map(|_| {
                loop {
                    let t = triangle();
                    if has_area(&t) {
                        return t;
                    }
                }
            })
            .collect();
        scene(vec![object(name.to_owned(), &triangles, FINE)])
    }
}

fn has_area([a, b, c]: &Steps) -> bool {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    [(1, 2), (2, 0), (0, 1)].iter().any(|&(i, j)| u[i] * v[j] != u[j] * v[i])
}

/// A position in the visible volume, from depth 8 to 24.
fn centre(rng: &mut Rng) -> [i64; 3] {
    let fine = i32::try_from(FINE).expect("a thousand");
    let z = rng.between(8 * fine, 24 * fine);
    [rng.between(-z / 2, z / 2), rng.between(-z / 2, z / 2), z].map(i64::from)
}

/// Triangles of any position, size and slope, which intersect each other. The more there are, the fewer intersect:
/// since the number of layers stays the same, the size falls with the root of the number, and so does the share of
/// others that each meets.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn soup(options: SurfaceOptions) -> Result<Scene, GenerateError> {
    let options = options.checked()?;
    let (mut rng, half) = (Rng::new(options.seed, 21), options.half());
    Ok(options.made("soup", || {
        let centre = centre(&mut rng);
        // Equally large in the picture at any depth.
        let half = i64::from(half) * centre[2] / (DEPTH * FINE);
        let half = i32::try_from(half).expect("no larger than twice the half at the mean depth");
        [0; 3].map(|_| centre.map(|x| x + i64::from(rng.between(-half, half))))
    }))
}

/// Triangles that overlap in one sloped plane: only a rule decides which of them is visible.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn coplanar(options: SurfaceOptions) -> Result<Scene, GenerateError> {
    let options = options.checked()?;
    let (mut rng, half) = (Rng::new(options.seed, 22), options.half());
    let reach = i32::try_from(DEPTH * FINE / 2).expect("a picture is small");
    Ok(options.made("coplanar", || {
        let centre = [0; 2].map(|_| rng.between(-reach, reach));
        [0; 3].map(|_| {
            // Multiples of 4, so that a quarter is a whole number.
            let [x, y] = centre.map(|c| i64::from(c + rng.between(-half, half)) / 4 * 4);
            [x, y, DEPTH * FINE + (x + y) / 4]
        })
    }))
}

/// Triangles as long as a part of the picture and from one to 64 steps wide, in all directions.
///
/// # Errors
/// [`GenerateError::OutOfRange`]
pub fn slivers(options: SurfaceOptions) -> Result<Scene, GenerateError> {
    let options = options.checked()?;
    let mut rng = Rng::new(options.seed, 23);
    // Each crosses about 16 others per layer in the picture.
    let crossed = u64::from(16 * options.layers);
    let long = (DEPTH * FINE).unsigned_abs().pow(2) * crossed / u64::from(options.triangles);
    let long = i32::try_from(long.isqrt().min((DEPTH * FINE).unsigned_abs())).expect("at most the picture") / 2;
    Ok(options.made("slivers", || {
        let centre = centre(&mut rng);
        let way = [0; 3].map(|_| i64::from(rng.between(-long, long)));
        let wide = 1 << rng.below(7);
        let along = i64::from(rng.between(-8, 8));
        let [from, to] = [-1, 1].map(|s| [0, 1, 2].map(|k| centre[k] + s * way[k]));
        let third = [0, 1, 2].map(|k| centre[k] + way[k] * along / 8 + i64::from(rng.between(-wide, wide)));
        // Corners behind depth 1 are reflected.
        [from, to, third].map(|[x, y, z]| [x, y, if z < FINE { 2 * FINE - z } else { z }])
    }))
}
