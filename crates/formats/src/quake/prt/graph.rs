//! Clusters and portals of a file as cells and portals.

use super::Prt;
use sightlines_cells::{CellGraph, CellId, Convex, Portal3};

/// The graph of clusters: cell `k` is cluster `k`. Portals without area are left out, as nothing is seen through
/// them, and so are [repeats](Prt::repeats); corners that convex polygons do not have are left out too, which only widens a portal. O(n log n).
pub fn graph_of_prt(prt: &Prt) -> CellGraph<Convex> {
    let shape = |points: &[_]| Portal3::around(points);
    let once = prt.portals().zip(prt.repeats()).filter(|(_, is_repeat)| !is_repeat).map(|(portal, _)| portal);
    let portals = once.filter_map(|p| Some((p.clusters.map(CellId), shape(p.points)?)));
    CellGraph::of_portals(prt.n_clusters() as usize, portals.collect())
}
