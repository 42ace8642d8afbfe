//! Whether portals and map are of the same map.

use super::orientation::inside_out;
use super::{Bsp, LeafClusters, VisibilityError};
use crate::quake::Prt;

/// Whether portals of Quake II have more clusters than the map, and list those that are the map's as leafs: the others are what can be seen through, as
/// portals that are made from a map may have it.
pub(super) fn has_more_clusters(bsp: &Bsp, leafs: &LeafClusters) -> bool {
    let is_identity = || leafs.cluster_of_leaf().iter().zip(0..).all(|(&cluster, leaf)| cluster == leaf);
    let n = bsp.n_clusters();
    bsp.format().has_clusters() && leafs.n_clusters() > n && leafs.n_leafs() == n && is_identity()
}

/// Checks by their counts that portals and map belong together: visible leafs (Quake), or clusters (Quake II).
///
/// # Errors
/// [`VisibilityError::Leafs`], [`VisibilityError::Clusters`].
pub fn check_match(bsp: &Bsp, leafs: &LeafClusters) -> Result<(), VisibilityError> {
    if bsp.format().has_clusters() {
        let (portals, map) = (leafs.n_clusters(), bsp.n_clusters());
        return if portals == map || has_more_clusters(bsp, leafs) {
            Ok(())
        } else {
            Err(VisibilityError::Clusters { portals, map })
        };
    }
    let (portals, map) = (leafs.n_leafs(), bsp.n_visible_leafs());
    if portals == map { Ok(()) } else { Err(VisibilityError::Leafs { portals, map }) }
}

/// Checks that portals and map are of the same map: by their counts, as [`check_match`] does, and by their places,
/// because two maps may have as many leafs. Each portal should lie within the bounds of the leafs on both its
/// sides; if most do not, the map is another. O(leafs + points).
///
/// Portals do stick out where a cluster has solid detail, which is not in its leafs: one in twenty sides on the maps
/// that were examined, none on maps without detail, and all of them with the portals of another map. So the limit is
/// half of them. Of a portal that goes on beyond all leafs it is enough to meet those bounds. It catches mistakes and does not affect visibility.
///
/// # Errors
/// [`VisibilityError::Leafs`], [`VisibilityError::Clusters`], [`VisibilityError::OtherMap`]; [`VisibilityError::InsideOut`] for the first portal whose
/// corners go round the wrong way, as the tree of the map has it: through that, a search would see nothing of what is seen in truth.
pub fn check_portals(bsp: &Bsp, prt: &Prt) -> Result<(), VisibilityError> {
    let leafs = prt.leaf_clusters();
    check_match(bsp, &leafs)?;
    let boxes = cluster_boxes(bsp, &leafs);
    // Where nothing closes a leaf, as in a leaking map, its portals may go on beyond all of them.
    let all = boxes.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), (l, h)| {
        (std::array::from_fn(|k| low[k].min(l[k])), std::array::from_fn(|k| high[k].max(h[k])))
    });
    let (mut n_outside, mut n_sides) = (0, 0);
    for portal in prt.portals() {
        for cluster in portal.clusters {
            let (low, high) = boxes[cluster as usize];
            // Of a cluster without leafs nothing is known.
            if low[0] > high[0] {
                continue;
            }
            // Bounds are whole numbers in most formats, and may have been rounded.
            let is_between = |p: &[f64; 3], low: &[f64; 3], high: &[f64; 3]| {
                (0..3).all(|k| low[k] - 1.0 <= p[k] && p[k] <= high[k] + 1.0)
            };
            let is_inside = |p: &[f64; 3]| is_between(p, &low, &high);
            let meets = (0..3).all(|k| {
                let x = portal.points.iter().map(|p| p[k]);
                x.clone().fold(f64::INFINITY, f64::min) <= high[k] + 1.0
                    && x.fold(f64::NEG_INFINITY, f64::max) >= low[k] - 1.0
            });
            let goes_on = portal.points.iter().any(|p| !is_between(p, &all.0, &all.1));
            n_sides += 1;
            n_outside += usize::from(!(portal.points.iter().all(is_inside) || goes_on && meets));
        }
    }
    if 2 * n_outside > n_sides {
        return Err(VisibilityError::OtherMap { n_outside, n_sides });
    }
    match inside_out(bsp, prt, &clusters_of_leafs(bsp, &leafs)) {
        Some((portal, clusters)) => Err(VisibilityError::InsideOut { portal, clusters }),
        None => Ok(()),
    }
}

/// The cluster of each leaf of the map; `None` for what is solid, and for leafs of doors and the like.
pub fn clusters_of_leafs(bsp: &Bsp, leafs: &LeafClusters) -> Vec<Option<u32>> {
    if bsp.format().has_clusters() {
        return bsp.leafs().iter().map(|leaf| leaf.cluster().map(u32::from)).collect();
    }
    let visible = leafs.cluster_of_leaf().iter().map(|&cluster| Some(cluster));
    let all = std::iter::once(None).chain(visible).chain(std::iter::repeat(None));
    all.take(bsp.leafs().len()).collect()
}

/// Low and high corner of the leafs of each cluster; of one without leafs nothing is inside.
fn cluster_boxes(bsp: &Bsp, leafs: &LeafClusters) -> Vec<([f64; 3], [f64; 3])> {
    let mut boxes = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); leafs.n_clusters()];
    for (k, leaf) in bsp.visible_leafs().iter().enumerate() {
        let cluster = if bsp.format().has_clusters() {
            leaf.cluster().map(usize::from)
        } else {
            leafs.cluster_of_leaf().get(k).map(|&c| c as usize)
        };
        let Some((low, high)) = cluster.and_then(|c| boxes.get_mut(c)) else { continue };
        for axis in 0..3 {
            low[axis] = low[axis].min(f64::from(leaf.mins[axis]));
            high[axis] = high[axis].max(f64::from(leaf.maxs[axis]));
        }
    }
    boxes
}
