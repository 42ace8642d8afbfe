//! Portals that a file has more than once.

use super::{Prt, PrtPortal};
use std::collections::HashSet;

impl Prt {
    /// For each portal whether one before it joins the same clusters and has the same corners, whichever of them is the first and from whichever side they
    /// are seen. Once is enough: a line that passes the one passes the other, and a search would follow both. O(points).
    pub fn repeats(&self) -> Vec<bool> {
        let mut seen = HashSet::new();
        self.portals().map(|portal| !seen.insert(key(&portal))).collect()
    }

    /// Number of [repeats](Self::repeats).
    pub fn n_repeats(&self) -> usize {
        self.repeats().into_iter().filter(|&is_repeat| is_repeat).count()
    }
}

/// The same for equal portals: seen from the cluster with the larger number, beginning with the least corner.
fn key(portal: &PrtPortal<'_>) -> ([u32; 2], Vec<[u64; 3]>) {
    let [a, b] = portal.clusters;
    let mut corners: Vec<[u64; 3]> = portal.points.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    if a > b {
        corners.reverse();
    }
    let least = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or(0);
    corners.rotate_left(least);
    ([a.min(b), a.max(b)], corners)
}
