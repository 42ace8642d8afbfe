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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_are_found_whatever_their_order() {
        let square = [[8.0, 0.0, 0.0], [8.0, 4.0, 0.0], [8.0, 4.0, 4.0], [8.0, 0.0, 4.0]];
        let turned = [square[2], square[3], square[0], square[1]];
        let mut reversed = turned;
        reversed.reverse();
        let mut moved = square;
        moved[0][1] = -1.0;
        let mut prt = Prt::new(3).unwrap();
        let all: [([u32; 2], &[[f64; 3]]); 7] = [
            ([0, 1], &square),
            ([0, 1], &turned),
            ([1, 0], &reversed),
            ([0, 1], &moved),
            ([0, 2], &square),
            ([0, 1], &square),
            ([0, 1], &square[..3]),
        ];
        all.iter().for_each(|(clusters, points)| prt.push_portal(*clusters, points).unwrap());
        assert_eq!(prt.repeats(), [false, true, true, false, false, true, false]);
        assert_eq!(prt.n_repeats(), 3);
        assert_eq!(crate::quake::graph_of_prt(&prt).portals().len(), 4);
    }
}
