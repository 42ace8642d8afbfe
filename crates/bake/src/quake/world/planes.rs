//! The tree of a map, down to clusters, and how far its planes are to be trusted.

use crate::quake::PrtBakeError;
use sightlines_cells::{CellGraph, CellId, Convex};
use sightlines_formats::quake::bsp::{BspChild, BspNode, BspTree, ClusterPlaces};
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
    let mut around = ClusterPlaces::new(tree, clusters, graph.n_cells());
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
            let Some(by) = distance_towards(&around, exit.to.0, corners) else { continue };
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

/// How far the farthest of some points is from the nearest plane that has a part of the current cluster on one side
/// and a part of another on the other.
fn distance_towards(places: &ClusterPlaces<'_>, cluster: u32, points: &[Point3]) -> Option<f64> {
    let mut least: Option<f64> = None;
    places.planes_towards(cluster, |plane, _| {
        let by = points.iter().map(|&p| plane.height(p).abs()).fold(0.0, f64::max);
        least = Some(least.map_or(by, |least| least.min(by)));
    });
    least
}
