//! The tree of a Quake map, as tables are checked against it.

use crate::{MapChild, MapFace, MapNode, MapTree};
use sightlines_formats::Malformed;
use sightlines_formats::quake::bsp::BspChild;
use sightlines_formats::quake::{Bsp, Prt};

impl MapTree {
    /// The tree of a map, with the cluster of each leaf, and its faces. The portals are those of the map, as
    /// [`check_portals`](sightlines_formats::quake::visibility::check_portals) finds out.
    ///
    /// # Errors
    /// [`Malformed`] with the place in the map, if its tree or its faces are damaged.
    pub fn of_map(bsp: &Bsp, prt: &Prt) -> Result<Self, Malformed> {
        let (tree, faces, lists) = (bsp.world_tree()?, bsp.world_faces()?, bsp.leaf_faces()?);
        let of_leaf = prt.leaf_clusters();
        // Portal files count leafs from 0, maps from 1, and their leaf 0 is what is solid.
        let cluster = |leaf: u32| match (bsp.format().has_clusters(), leaf.checked_sub(1)) {
            (true, _) => bsp.leafs().get(leaf as usize).and_then(|leaf| leaf.cluster()).map(u32::from),
            (false, Some(leaf)) => of_leaf.cluster_of_leaf().get(leaf as usize).copied(),
            (false, None) => None,
        };
        let child = |child: BspChild| match child {
            BspChild::Node(node) => MapChild::Node(node),
            BspChild::Leaf(leaf) => cluster(leaf).map_or(MapChild::Solid, MapChild::Cluster),
        };
        let nodes = tree
            .nodes()
            .iter()
            .map(|n| MapNode { normal: n.normal, distance: n.distance, children: n.children.map(child) })
            .collect();
        let first = faces.range().start;
        let face = |k: usize| MapFace {
            name: format!("face {}", first as usize + k),
            polygons: faces.polygons(k).map(<[_]>::to_vec).collect(),
        };
        let mut listed = vec![Vec::new(); prt.n_clusters() as usize];
        for leaf in 0..lists.n_leafs() {
            if let Some(list) = cluster(leaf as u32 + 1).and_then(|cluster| listed.get_mut(cluster as usize)) {
                list.extend(lists.of(leaf).iter().filter(|face| faces.range().contains(face)).map(|face| face - first));
            }
        }
        listed.iter_mut().for_each(|list: &mut Vec<u32>| {
            list.sort_unstable();
            list.dedup();
        });
        Ok(MapTree { nodes, faces: (0..faces.n_faces()).map(face).collect(), listed })
    }
}
