//! The tree of a map, down to clusters, and how far its planes are to be trusted.

use crate::quake::PrtBakeError;
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_formats::quake::bsp::{BspChild, BspNode, BspTree};
use sightlines_formats::quake::prt::MAX_UNEVENNESS;
use sightlines_geometry::Point3;
use sightlines_pvs::{PlaneChild, PlaneNode, PlaneTree};

/// The tree of a map with clusters instead of leafs.
pub(super) struct ClusterTree {
    /// Empty if nothing is cut.
    nodes: Vec<PlaneNode>,
    slack: f64,
}

/// The leafs that a tree has, each as often as it has it.
pub(super) fn leafs_of(tree: &BspTree) -> impl Iterator<Item = u32> + '_ {
    let children = tree.nodes().iter().flat_map(|node| node.children);
    children.chain([tree.root()]).filter_map(|child| if let BspChild::Leaf(leaf) = child { Some(leaf) } else { None })
}

impl ClusterTree {
    /// Puts the clusters of leafs into the tree, without planes that have the same on both sides. O(nodes + portals ×
    /// depth), where clusters have a leaf or two.
    ///
    /// # Errors
    /// [`PrtBakeError::OffPlane`].
    pub(super) fn new(
        tree: &BspTree,
        clusters: &[Option<u32>],
        graph: &CellGraph<Convex>,
    ) -> Result<Self, PrtBakeError> {
        let slack = slack(tree, clusters, graph)?;
        let child = |child: BspChild, of_node: &[PlaneChild]| match child {
            BspChild::Node(node) => of_node[node as usize],
            BspChild::Leaf(leaf) => {
                clusters[leaf as usize].map_or(PlaneChild::Nothing, |cluster| PlaneChild::Cell(CellId(cluster)))
            }
        };
        // Children come behind their parents: what a node comes to is known when its parent is looked at.
        let mut of_node: Vec<PlaneChild> = (0..tree.nodes().len() as u32).map(PlaneChild::Node).collect();
        for (at, node) in tree.nodes().iter().enumerate().rev() {
            let [above, below] = node.children.map(|c| child(c, &of_node));
            // The root stays, as a tree has one.
            if at > 0 && above == below && !matches!(above, PlaneChild::Node(_)) {
                of_node[at] = above;
            }
        }
        let mut place = vec![0u32; tree.nodes().len()];
        // What is above a node that stays has a node below, and stays too.
        let is_kept = |at: usize| of_node[at] == PlaneChild::Node(at as u32);
        (0..place.len()).filter(|&at| is_kept(at)).zip(0..).for_each(|(at, kept)| place[at] = kept);
        let placed = |c: BspChild| match child(c, &of_node) {
            PlaneChild::Node(node) => PlaneChild::Node(place[node as usize]),
            other => other,
        };
        let node = |(_, node): (usize, &BspNode)| PlaneNode {
            normal: node.normal,
            offset: node.distance,
            children: node.children.map(placed),
        };
        let nodes = tree.nodes().iter().enumerate().filter(|(at, _)| is_kept(*at)).map(node).collect();
        Ok(Self { nodes, slack })
    }

    pub(super) fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn nodes(&self) -> &[PlaneNode] {
        &self.nodes
    }

    pub(super) fn slack(&self) -> f64 {
        self.slack
    }

    /// The tree as tables have it; `None` if nothing is cut.
    pub(super) fn into_planes(self) -> Option<PlaneTree> {
        if self.nodes.is_empty() {
            return None;
        }
        Some(PlaneTree::new(self.nodes, self.slack).expect("a tree of a map is one, and not too deep"))
    }
}

/// How near to a plane of the tree a point may be in the cell of its other side, in map units: as far as portals are from
/// the planes that they are on. A cell of the portals ends at a portal, one of the tree at the plane, which is rounded
/// to floats; what lies between the two is no wider than the farthest corner of the portal is from the plane, for heights
/// above a plane are largest at corners. At least as much as portals are uneven, and as doubles of such size are
/// rounded by ([`sightlines_stabtree`] takes 2^-44 of the largest coordinate).
fn slack(tree: &BspTree, clusters: &[Option<u32>], graph: &CellGraph<Convex>) -> Result<f64, PrtBakeError> {
    let mut around = Surroundings::new(tree, clusters, graph.n_cells());
    let mut slack = 0f64;
    for a in graph.cell_ids() {
        let own = graph.exits(a).iter().filter(|exit| exit.forward);
        if own.clone().next().is_none() {
            continue;
        }
        around.stand_in(a.0);
        for exit in own {
            let corners = graph.portals()[exit.portal.idx()].shape.corners();
            // Clusters that no plane divides have no places of their own in the tree.
            let Some(by) = around.distance_towards(exit.to.0, corners) else { continue };
            if by > MAX_UNEVENNESS {
                let clusters = [a.0, exit.to.0];
                return Err(PrtBakeError::OffPlane { portal: exit.portal.idx(), clusters, by });
            }
            slack = slack.max(by);
        }
    }
    let shapes = || graph.portals().iter().map(|portal| &portal.shape);
    let largest = shapes().flat_map(|s| s.corners().as_flattened()).fold(0.0, |m: f64, x| m.max(x.abs()));
    let uneven = shapes().map(|shape| shape.unevenness()).fold(0.0, f64::max);
    Ok(slack.max(uneven).max(largest * 2f64.powi(-44)))
}

/// A tree that is climbed from the leafs of clusters.
struct Surroundings<'t> {
    tree: &'t BspTree,
    /// For each node its parent and the side that it is on there; none for the root.
    parents: Vec<Option<(u32, usize)>>,
    /// For each cluster the nodes that its leafs are on, with the side.
    places: Vec<Vec<(u32, usize)>>,
    /// The sides of each node that the current cluster is on.
    sides: Vec<[bool; 2]>,
    /// Nodes with such a side.
    marked: Vec<u32>,
}

impl<'t> Surroundings<'t> {
    fn new(tree: &'t BspTree, clusters: &[Option<u32>], n_clusters: usize) -> Self {
        let n_nodes = tree.nodes().len();
        let (mut parents, mut places) = (vec![None; n_nodes], vec![Vec::new(); n_clusters]);
        for (node, parent) in tree.nodes().iter().zip(0..) {
            for (side, child) in node.children.into_iter().enumerate() {
                match child {
                    BspChild::Node(below) => parents[below as usize] = Some((parent, side)),
                    BspChild::Leaf(leaf) => {
                        if let Some(cluster) = clusters[leaf as usize] {
                            places[cluster as usize].push((parent, side));
                        }
                    }
                }
            }
        }
        Self { tree, parents, places, sides: vec![[false; 2]; n_nodes], marked: Vec::new() }
    }

    fn stand_in(&mut self, cluster: u32) {
        self.marked.drain(..).for_each(|node| self.sides[node as usize] = [false; 2]);
        for place in &self.places[cluster as usize] {
            let mut at = Some(*place);
            while let Some((node, side)) = at.filter(|&(node, side)| !self.sides[node as usize][side]) {
                self.sides[node as usize][side] = true;
                self.marked.push(node);
                at = self.parents[node as usize];
            }
        }
    }

    /// How far the farthest of some points is from the nearest plane that has a part of the current cluster on one side
    /// and a part of another on the other.
    fn distance_towards(&self, cluster: u32, points: &[Point3]) -> Option<f64> {
        let mut least: Option<f64> = None;
        for place in &self.places[cluster as usize] {
            let mut at = Some(*place);
            while let Some((node, side)) = at {
                if self.sides[node as usize][1 - side] {
                    let plane = &self.tree.nodes()[node as usize];
                    let by = points.iter().map(|&p| height(plane, p).abs()).fold(0.0, f64::max);
                    least = Some(least.map_or(by, |least| least.min(by)));
                }
                at = self.parents[node as usize];
            }
        }
        least
    }
}

/// How far a point is above a plane, rounded: by some units in the last place of the largest product, which is less
/// than the 2^-44 of the largest coordinate that a slack has at least.
fn height(plane: &BspNode, p: Point3) -> f64 {
    (0..3).map(|k| plane.normal[k] * p[k]).sum::<f64>() - plane.distance
}
