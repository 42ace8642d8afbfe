//! Random rays from each cell: what discrete sampling finds.

use super::{Opening, PortalGraph, Ray};
use sightlines::pvs::BitMatrix;
use sightlines_testkit::Random;

/// Which cells see each other as `n_rays` random rays from each cell show, cells by cells; symmetric.
///
/// A ray begins between two random points of the cell's openings, in a random direction, and goes on until it
/// meets no opening. It errs towards hidden, which is the unsafe side: what no ray happens to pass is missed. What is
/// found is visible, as rays keep clear of borders. The same seed gives the same answer. O(cells · rays · length of a ray).
pub fn sampled<O: Opening>(graph: &PortalGraph<O>, n_rays: u64, seed: u64) -> BitMatrix {
    let n = graph.n_cells();
    let mut seen = BitMatrix::identity(n);
    for cell in (0..n).filter(|&cell| !graph.out_of(cell).is_empty()) {
        let mut random = Random::new(seed, cell as u64);
        let out = graph.out_of(cell);
        for _ in 0..n_rays {
            let [a, b] = [0; 2].map(|_| out[random.below(out.len())].opening.point(&mut random));
            let t = random.unit();
            let origin = [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]));
            let ray = Ray { origin, direction: O::direction(&mut random) };
            let mut at = cell;
            // A straight line enters no convex cell twice; rounding shall not lead around in circles.
            for _ in 0..n {
                let passed = |w: &&super::PortalEdge<O>| w.opening.is_passed(&ray, graph.clearance);
                let Some(edge) = graph.out_of(at).iter().find(passed) else { break };
                at = edge.to;
                seen.set(cell, at, true);
                seen.set(at, cell, true);
            }
        }
    }
    seen
}
