//! Fields on the planes of buffers: for each texel the nearest feature of the scene, and how far away it is.
//!
//! Diagnostic, as in the slides: what hides is decided by buffers alone. A map of nearest features is the Voronoi
//! map of the scene on the plane.

mod features;
mod nearest;

pub use features::{FeatureKind, Features};
pub use nearest::Nearest;

use rayon::prelude::*;
use sightlines_geometry::Point3;
use sightlines_multifocal::BufferPlane;

/// What is nearest to the centre of each texel of a plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NearestField {
    texels: [u32; 2],
    nearest: Vec<Option<Nearest>>,
}

impl NearestField {
    /// Finds the nearest feature of each texel's centre, rows in parallel.
    ///
    /// Cost: about O(log n) a texel for n triangles; what is equally far from the texel costs more.
    pub fn new(features: &Features, plane: &BufferPlane) -> Self {
        let [width, height] = plane.texels();
        let mut nearest = vec![None; width as usize * height as usize];
        nearest.par_chunks_exact_mut(width as usize).zip(0..height).for_each(|(row, y)| {
            for (out, x) in row.iter_mut().zip(0..width) {
                *out = features.nearest(centre(plane, x, y));
            }
        });
        Self { texels: [width, height], nearest }
    }

    /// How many texels along each axis of the plane.
    pub const fn texels(&self) -> [u32; 2] {
        self.texels
    }

    /// What is nearest to each texel, row by row (`y * width + x`); none if there are no features at all.
    pub fn nearest(&self) -> &[Option<Nearest>] {
        &self.nearest
    }

    /// The largest distance, in scene units; 0 if there is none.
    pub fn farthest(&self) -> f64 {
        self.nearest.iter().flatten().map(|nearest| nearest.distance).fold(0.0, f64::max)
    }
}

/// The middle of a texel, rounded to nearest.
fn centre(plane: &BufferPlane, x: u32, y: u32) -> Point3 {
    let (low, high) = (plane.corner(x, y), plane.corner(x + 1, y + 1));
    std::array::from_fn(|k| low[k] + 0.5 * (high[k] - low[k]))
}

#[cfg(test)]
mod tests;
