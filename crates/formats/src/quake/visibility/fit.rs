//! Whether portals and map are of the same map.

use super::orientation::inside_out;
use super::{Bsp, LeafClusters, VisibilityError};
use crate::quake::Prt;
use sightlines_geometry::Aabb;

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
        let fits = portals == map || has_more_clusters(bsp, leafs);
        return if fits { Ok(()) } else { Err(VisibilityError::Clusters { portals, map }) };
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
    let clusters = clusters_of_leafs(bsp, &leafs);
    // Around the leafs of each cluster.
    let mut boxes = vec![Aabb::around([]); leafs.n_clusters()];
    for (leaf, cluster) in bsp.visible_leafs().iter().zip(clusters.iter().skip(1)) {
        if let Some(bounds) = cluster.and_then(|cluster| boxes.get_mut(cluster as usize)) {
            *bounds = around_both(bounds, &Aabb { min: leaf.mins.map(f64::from), max: leaf.maxs.map(f64::from) });
        }
    }
    // Where nothing closes a leaf, as in a leaking map, its portals may go on beyond all of them.
    let all = boxes.iter().fold(Aabb::around([]), |all, bounds| around_both(&all, bounds));
    let (mut n_outside, mut n_sides) = (0, 0);
    for portal in prt.portals() {
        for cluster in portal.clusters {
            let leafs = &boxes[cluster as usize];
            // Of a cluster without leafs nothing is known.
            if leafs.min[0] > leafs.max[0] {
                continue;
            }
            let Aabb { min, max } = Aabb::around(portal.points.iter().copied());
            // Bounds are whole numbers in most formats, and may have been rounded.
            let is_in = |b: &Aabb<3>| (0..3).all(|k| b.min[k] - 1.0 <= min[k] && max[k] <= b.max[k] + 1.0);
            let meets = |b: &Aabb<3>| (0..3).all(|k| min[k] <= b.max[k] + 1.0 && max[k] >= b.min[k] - 1.0);
            n_sides += 1;
            n_outside += usize::from(!(is_in(leafs) || !is_in(&all) && meets(leafs)));
        }
    }
    if 2 * n_outside > n_sides {
        return Err(VisibilityError::OtherMap { n_outside, n_sides });
    }
    match inside_out(bsp, prt, &clusters) {
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

/// Along each axis by itself, whatever files have for bounds.
fn around_both(a: &Aabb<3>, b: &Aabb<3>) -> Aabb<3> {
    let least = |k: usize| a.min[k].min(b.min[k]);
    Aabb { min: [0, 1, 2].map(least), max: [0, 1, 2].map(|k| a.max[k].max(b.max[k])) }
}
