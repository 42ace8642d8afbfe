//! Which faces touch which clusters.

use super::planes::ClusterTree;
use sightlines_formats::quake::bsp::{LeafFaces, WorldFaces};
use sightlines_geometry::Point3;
use sightlines_pvs::{PlaneChild, PlaneNode};

/// The faces of clusters.
pub(super) struct FaceLists {
    /// For each cluster the faces that touch it, counted from the first of the world, ascending.
    pub(super) of_clusters: Vec<Vec<u32>>,
    pub(super) n_unlisted_faces: usize,
    pub(super) n_listed: usize,
    pub(super) n_reaching: usize,
}

/// What leafs list, and what reaches into clusters besides: compilers leave out faces of a leaf that they merged with
/// others, or that lie in it by less than they look at. Of lists, faces of other models are left out.
///
/// * `leafs`: the cluster of each leaf, as the map counts.
pub(super) fn lists(
    tree: &ClusterTree,
    leafs: &[Option<u32>],
    faces: &WorldFaces,
    listed: &LeafFaces,
    n_clusters: usize,
) -> FaceLists {
    let mut of_clusters = vec![Vec::new(); n_clusters];
    let mut is_listed = vec![false; faces.n_faces()];
    for leaf in 0..listed.n_leafs() {
        let Some(cluster) = leafs[leaf + 1] else { continue };
        for face in listed.of(leaf).iter().filter(|face| faces.range().contains(face)) {
            let k = face - faces.range().start;
            is_listed[k as usize] = true;
            of_clusters[cluster as usize].push(k);
        }
    }
    let in_order = |list: &mut Vec<u32>| {
        list.sort_unstable();
        list.dedup();
        list.len()
    };
    let n_listed = of_clusters.iter_mut().map(in_order).sum();
    for k in 0..faces.n_faces() {
        for cluster in faces.polygons(k).flat_map(|corners| reached(tree, corners)) {
            of_clusters[cluster as usize].push(k as u32);
        }
    }
    let n_all: usize = of_clusters.iter_mut().map(in_order).sum();
    let n_unlisted_faces = is_listed.iter().filter(|listed| !**listed).count();
    FaceLists { of_clusters, n_unlisted_faces, n_listed, n_reaching: n_all - n_listed }
}

/// The clusters that a polygon reaches into: what is left of it on a side of a plane goes there if it is further away
/// than the slack, and all of it goes to both sides if none of it is. Ascending, some more than once.
fn reached(tree: &ClusterTree, corners: &[Point3]) -> Vec<u32> {
    let mut found = Vec::new();
    let mut open = vec![(PlaneChild::Node(0), corners.to_vec())];
    if tree.n_nodes() == 0 || corners.is_empty() {
        return found;
    }
    while let Some((child, polygon)) = open.pop() {
        let node = match child {
            PlaneChild::Nothing => continue,
            PlaneChild::Cell(cell) => {
                found.push(cell.0);
                continue;
            }
            PlaneChild::Node(node) => &tree.nodes()[node as usize],
        };
        let heights: Vec<f64> = polygon.iter().map(|&p| height(node, p)).collect();
        let [above, below] = [1.0, -1.0].map(|sign| heights.iter().any(|h| sign * h > tree.slack()));
        for (side, (is_there, sign)) in [(above, 1.0), (below, -1.0)].into_iter().enumerate() {
            match (is_there, above && below) {
                (true, true) => open.push((node.children[side], part(&polygon, &heights, sign))),
                (true, false) => open.push((node.children[side], polygon.clone())),
                (false, _) if !above && !below => open.push((node.children[side], polygon.clone())),
                (false, _) => {}
            }
        }
    }
    found.sort_unstable();
    found
}

/// The part of a polygon that is above a plane, or below it for a negative sign, rounded.
fn part(polygon: &[Point3], heights: &[f64], sign: f64) -> Vec<Point3> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let j = (i + 1) % polygon.len();
        let [h, next] = [i, j].map(|k| sign * heights[k]);
        if h >= 0.0 {
            out.push(polygon[i]);
        }
        if (h > 0.0 && next < 0.0) || (h < 0.0 && next > 0.0) {
            let t = h / (h - next);
            out.push(std::array::from_fn(|k| polygon[i][k] + t * (polygon[j][k] - polygon[i][k])));
        }
    }
    out
}

fn height(node: &PlaneNode, p: Point3) -> f64 {
    (0..3).map(|k| node.normal[k] * p[k]).sum::<f64>() - node.offset
}
