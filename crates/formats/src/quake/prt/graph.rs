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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quake::prt::parse_prt;

    #[test]
    fn a_portal_leads_from_the_first_cluster_into_the_second() {
        let text = "PRT1\n3\n2\n4 1 0 (0 0 0 ) (0 1 0 ) (0 1 1 ) (0 0 1 )\n3 1 2 (-9 0 0 ) (-9 1 0 ) (-9 2 0 )\n";
        let graph = graph_of_prt(&parse_prt(text.as_bytes()).unwrap());
        assert_eq!((graph.n_cells(), graph.portals().len()), (3, 1), "a portal without area is none");
        assert_eq!(graph.portals()[0].cells, [CellId(1), CellId(0)]);
        assert_eq!(graph.portals()[0].shape.normal(), [2.0, 0.0, 0.0]);
    }
}
