//! What a user wants a map to show and hide, whatever is visible.
//!
//! Visibility is found as ever, and changed behind that: the report tells what was changed, and what is visible stays in [`VisMap`](super::VisMap).

use super::PrtBakeError;
use sightlines_cells::{CellGraph, Convex};
use sightlines_formats::quake::overrides::Override;
use sightlines_formats::quake::visibility::clusters_of_leafs;
use sightlines_formats::quake::{Bsp, Prt};
use sightlines_geometry::Aabb;
use sightlines_pvs::BitMatrix;

/// What a user wants.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VisWishes {
    /// Hide pairs of clusters whose boxes are farther from each other than this, in map units. Everything nearer is shown as without it.
    ///
    /// The box of a cluster is that which the map states for its leafs, widened by a unit because formats round it, with its portals. The distance
    /// of two boxes is rounded down. A cluster without leafs, or with a leaf whose box is not sound, is never too far.
    pub farthest: Option<f64>,
    /// What to say of pairs, behind that and in this order: the last one counts.
    pub overrides: Vec<Override>,
}

/// What was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WishReport {
    /// Pairs of different clusters that see each other and were hidden because they are too far away.
    pub n_far: u64,
    /// Overrides that show a pair that was hidden, in one direction at least.
    pub n_shown: usize,
    /// Overrides that hide what was shown.
    pub n_hidden: usize,
    /// Overrides that changed nothing.
    pub n_without_effect: usize,
}

/// By how much the bounds of leafs may be too small: formats round them to whole numbers.
const BOUNDS_ROUNDING: f64 = 1.0;

/// Wishes by the clusters of a map.
pub(super) struct Granting {
    /// If there is a farthest distance, with the boxes of all clusters that are known.
    farthest: Option<(f64, Vec<Option<Aabb<3>>>)>,
    overrides: Vec<(bool, [u32; 2])>,
}

impl Granting {
    /// Refuses wishes that cannot be granted, before anything is computed.
    pub(super) fn new(
        wishes: &VisWishes,
        (bsp, prt): (&Bsp, &Prt),
        graph: &CellGraph<Convex>,
    ) -> Result<Self, PrtBakeError> {
        let clusters = clusters_of_leafs(bsp, &prt.leaf_clusters());
        let cluster = |leaf: u32| {
            let found = clusters.get(leaf as usize).copied().flatten();
            found.filter(|&cluster| cluster < prt.n_clusters()).ok_or(PrtBakeError::NoLeaf { leaf })
        };
        let resolve = |&Override { shows, leafs }: &Override| {
            let pair = [cluster(leafs[0])?, cluster(leafs[1])?];
            if !shows && pair[0] == pair[1] { Err(PrtBakeError::OneCluster { leafs }) } else { Ok((shows, pair)) }
        };
        let overrides = wishes.overrides.iter().map(resolve).collect::<Result<_, _>>()?;
        let farthest = wishes.farthest.map(|farthest| (farthest, boxes(bsp, &clusters, graph)));
        Ok(Self { farthest, overrides })
    }

    /// What the map is to say, and what that changes.
    pub(super) fn grant(&self, found: &BitMatrix) -> (BitMatrix, WishReport) {
        let (mut seen, mut report) = (found.clone(), WishReport::default());
        if let Some((farthest, boxes)) = &self.farthest {
            for a in 0..seen.n_rows() {
                let Some(own) = &boxes[a] else { continue };
                let others: Vec<usize> = found.iter_ones(a).filter(|&b| b != a).collect();
                for b in others {
                    if boxes[b].as_ref().is_some_and(|other| is_farther(own, other, *farthest)) {
                        seen.set(a, b, false);
                        report.n_far += u64::from(a < b);
                    }
                }
            }
        }
        for &(shows, pair) in &self.overrides {
            let [a, b] = pair.map(|cluster| cluster as usize);
            let before = [seen.get(a, b), seen.get(b, a)];
            seen.set(a, b, shows);
            if shows {
                seen.set(b, a, true);
            }
            let changed = [seen.get(a, b), seen.get(b, a)] != before;
            let n = match (changed, shows) {
                (false, _) => &mut report.n_without_effect,
                (true, true) => &mut report.n_shown,
                (true, false) => &mut report.n_hidden,
            };
            *n += 1;
        }
        (seen, report)
    }
}

/// The box of each cluster; `None` where it is not known.
fn boxes(bsp: &Bsp, clusters: &[Option<u32>], graph: &CellGraph<Convex>) -> Vec<Option<Aabb<3>>> {
    let n = graph.cells().len();
    let mut boxes: Vec<Option<Aabb<3>>> = graph.cells().iter().map(|cell| Some(cell.bounds)).collect();
    let mut n_leafs = vec![0_u32; n];
    for (leaf, cluster) in bsp.leafs().iter().zip(clusters) {
        let Some(cluster) = cluster.map(|cluster| cluster as usize).filter(|&cluster| cluster < n) else { continue };
        let (low, high) = (leaf.mins.map(f64::from), leaf.maxs.map(f64::from));
        let is_sound = (0..3).all(|k| low[k].is_finite() && high[k].is_finite() && low[k] <= high[k]);
        n_leafs[cluster] += 1;
        boxes[cluster] = boxes[cluster]
            .filter(|_| is_sound)
            .map(|around| around.with(low.map(|x| x - BOUNDS_ROUNDING)).with(high.map(|x| x + BOUNDS_ROUNDING)));
    }
    boxes.iter_mut().zip(n_leafs).filter(|(_, n)| *n == 0).for_each(|(around, _)| *around = None);
    boxes
}

/// Whether two boxes are certainly farther from each other than a distance: their distance is rounded down, the other up.
fn is_farther(a: &Aabb<3>, b: &Aabb<3>, farthest: f64) -> bool {
    let down = |x: f64| x.next_down().max(0.0);
    let square = (0..3).fold(0.0, |sum, k| {
        let gap = down((a.min[k] - b.max[k]).max(b.min[k] - a.max[k]));
        down(sum + down(gap * gap))
    });
    square > (farthest * farthest).next_up()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two boxes are farther than what is less than their distance, by a few units in the last place, and not farther than it.
    #[test]
    fn distances_of_boxes_are_rounded_down() {
        let at = |min: [f64; 3]| Aabb { min, max: min.map(|x| x + 1.0) };
        let origin = at([0.0; 3]);
        let mut n = 0;
        for (min, distance) in
            [([4.0, 5.0, 0.5], 5.0), ([-6.0, 0.0, 0.0], 5.0), ([3.0, 3.0, 2.0], 3.0), ([1.1, 0.0, 0.0], 1.1 - 1.0)]
        {
            let other = at(min);
            for (a, b) in [(&origin, &other), (&other, &origin)] {
                assert!(!is_farther(a, b, distance) && is_farther(a, b, distance * (1.0 - 1e-12)), "{min:?}");
                n += 1;
            }
        }
        assert_eq!(n, 8);
        // Boxes that meet are not farther than anything.
        assert!(!is_farther(&origin, &at([1.0, 0.5, 0.0]), 0.0) && !is_farther(&origin, &origin, 0.0));
    }
}
