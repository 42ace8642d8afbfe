//! Where the clusters of a map lie in its tree.

use super::tree::{BspChild, BspNode, BspTree};

/// Where clusters lie in a tree, and one of them to stand in.
#[derive(Debug)]
pub struct ClusterPlaces<'t> {
    tree: &'t BspTree,
    /// For each node its parent and the side that it is on there; none for the root.
    parents: Vec<Option<(u32, usize)>>,
    /// For each cluster the nodes that its leafs are on, with the side.
    of_cluster: Vec<Vec<(u32, usize)>>,
    /// The sides of each node that the current cluster is on.
    sides: Vec<[bool; 2]>,
    /// Nodes with such a side.
    marked: Vec<u32>,
}

impl<'t> ClusterPlaces<'t> {
    /// Nowhere yet. `clusters` are those of the leafs; leafs that are not in it, and clusters from `n_clusters` on, are left out. O(nodes).
    pub fn new(tree: &'t BspTree, clusters: &[Option<u32>], n_clusters: usize) -> Self {
        let (mut parents, mut of_cluster) = (vec![None; tree.nodes().len()], vec![Vec::new(); n_clusters]);
        for (node, parent) in tree.nodes().iter().zip(0..) {
            for (side, child) in node.children.into_iter().enumerate() {
                match child {
                    BspChild::Node(below) => parents[below as usize] = Some((parent, side)),
                    BspChild::Leaf(leaf) => {
                        let cluster = clusters.get(leaf as usize).copied().flatten();
                        let places = cluster.and_then(|cluster| of_cluster.get_mut(cluster as usize));
                        places.into_iter().for_each(|places: &mut Vec<_>| places.push((parent, side)));
                    }
                }
            }
        }
        let sides = vec![[false; 2]; tree.nodes().len()];
        Self { tree, parents, of_cluster, sides, marked: Vec::new() }
    }

    /// The number of leafs of a cluster that the tree has.
    pub fn n_places(&self, cluster: u32) -> usize {
        self.of_cluster[cluster as usize].len()
    }

    /// Stands in another cluster. O(depth) for each of its leafs.
    pub fn stand_in(&mut self, cluster: u32) {
        self.marked.drain(..).for_each(|node| self.sides[node as usize] = [false; 2]);
        for place in &self.of_cluster[cluster as usize] {
            let mut at = Some(*place);
            while let Some((node, side)) = at.filter(|&(node, side)| !self.sides[node as usize][side]) {
                self.sides[node as usize][side] = true;
                self.marked.push(node);
                at = self.parents[node as usize];
            }
        }
    }

    /// The planes that have a part of the current cluster on one side and a part of another on the other, each with the side of the other, as
    /// often as parts of it are there. O(depth) for each of its leafs.
    pub fn planes_towards(&self, cluster: u32, mut each: impl FnMut(&BspNode, usize)) {
        for place in &self.of_cluster[cluster as usize] {
            let mut at = Some(*place);
            while let Some((node, side)) = at {
                if self.sides[node as usize][1 - side] {
                    each(&self.tree.nodes()[node as usize], side);
                }
                at = self.parents[node as usize];
            }
        }
    }
}
