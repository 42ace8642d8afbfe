//! What is seen from a volume of viewpoints: a lower bound by rays that seek the gaps.
//!
//! What one ray reaches is not hidden; what no ray reaches may still be seen through a slit, so the rest is an
//! upper bound of what is hidden. Uniform rays seldom find slits. So a ray that is stopped is turned past an
//! edge of what stopped it, again and again: a search along silhouettes.

mod chain;
#[cfg(test)]
mod tests;

use crate::rays::{RayScene, length, sub};
use chain::Chain;
use rayon::prelude::*;
use sightlines_cells::{Point3, Scene};
use sightlines_geometry::Aabb;

/// Rays in a batch, after which the targets that were seen are left out.
const BATCH: u64 = 256;

/// A segment that nothing blocks, nor its four parallels one [`RayScene::shift`] beside it, nor itself with its ends as far inside of their
/// boxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClearSegment {
    /// In the volume.
    pub eye: Point3,
    /// In the target.
    pub point: Point3,
}

/// What rays from a volume found.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledView {
    /// For each target the first segment of it, if there was one.
    pub first: Vec<Option<ClearSegment>>,
    /// How many rays were cast.
    pub n_rays: u64,
}

impl SampledView {
    /// Targets that no ray reached, ascending: all that are hidden, and some that are not.
    pub fn unseen(&self) -> impl Iterator<Item = usize> + '_ {
        self.first.iter().enumerate().filter(|(_, segment)| segment.is_none()).map(|(i, _)| i)
    }

    /// Of the targets called hidden, those that were seen: none, if the caller is sound.
    pub fn refuted(&self, hidden: impl IntoIterator<Item = usize>) -> Vec<(usize, ClearSegment)> {
        hidden.into_iter().filter_map(|i| Some((i, self.first[i]?))).collect()
    }
}

/// Casts rays from `volume` to each of `targets` past the triangles of `scene` until it is seen, or the rays are spent.
///
/// Both sides of triangles block, and targets block nothing. Eyes and points are anywhere in the closed boxes, with a
/// preference for their corners, edges and faces, where extreme lines end. Empty targets are never seen.
///
/// * `n_rays`: about how many rays to cast in all; the targets not yet seen share them equally, each at least 256
///
/// The same seed gives the same answer with any number of threads.
pub fn sampled_view(scene: &Scene, volume: &Aabb<3>, targets: &[Aabb<3>], n_rays: u64, seed: u64) -> SampledView {
    let rays = RayScene::new(scene);
    let boxes: Vec<Aabb<3>> = scene.objects().iter().map(|o| Aabb::around(o.corners().flatten())).collect();
    let mut found = SampledView { first: vec![None; targets.len()], n_rays: 0 };
    let mut left: Vec<usize> = (0..targets.len()).filter(|&i| !targets[i].is_empty() && !volume.is_empty()).collect();
    for round in 0u64.. {
        let planned = BATCH * left.len() as u64;
        if left.is_empty() || (round > 0 && found.n_rays + planned > n_rays) {
            break;
        }
        let seek = |&i: &usize| {
            let mut chain = Chain::new(&rays, scene, &boxes, [*volume, targets[i]], seed, round << 32 | i as u64);
            (i, chain.segment(BATCH), chain.n_rays())
        };
        for (i, segment, n) in left.par_iter().map(seek).collect::<Vec<_>>() {
            found.first[i] = segment;
            found.n_rays += n;
        }
        left.retain(|&i| found.first[i].is_none());
    }
    found
}

/// Whether a segment is clear, and its four parallels too.
fn is_clear(rays: &RayScene, from: Point3, to: Point3) -> bool {
    let direction = sub(to, from);
    let far = length(direction);
    if rays.is_blocked(from, to) {
        return false;
    }
    if far == 0.0 {
        return true;
    }
    // Two directions across: the axis that the segment is least along, without its part along the segment.
    let d = direction.map(|x| x / far);
    let axis = (0..3).min_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).expect("there are three axes");
    let mut across = d.map(|x| -x * d[axis]);
    across[axis] += 1.0;
    let u = across.map(|x| x / length(across));
    let v = [d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]];
    let s = rays.shift();
    [(u, s), (u, -s), (v, s), (v, -s)].iter().all(|(w, by)| {
        let moved = |p: Point3| [0, 1, 2].map(|k| p[k] + by * w[k]);
        !rays.is_blocked(moved(from), moved(to))
    })
}
