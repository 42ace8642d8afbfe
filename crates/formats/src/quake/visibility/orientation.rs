//! Whether the corners of portals go round the way that the map's tree demands.

use super::clusters_of_leafs;
use crate::quake::bsp::{BspChild, BspNode, BspTree};
use crate::quake::prt::MAX_UNEVENNESS;
use crate::quake::{Bsp, Prt};
use sightlines_geometry::{Point3, Portal3};

/// Cosine of the angle between a portal and a plane of the tree up to which they are taken for parallel. Chosen: portals lie on planes, and a narrow
/// one may be tilted by the rounding of its corners.
const PARALLEL: f64 = 0.5;

/// A portal of which the tree says that its second cluster lies where the corners say that the first does, with its clusters. It lies on a plane
/// that divides the two.
///
/// Rounded arithmetic: it catches mistakes, and errs towards silence. Of no map whose tree cannot be read, and of no two clusters without a plane
/// between them at the portal, anything is said. O(nodes + portals * depth), where clusters have a leaf or two.
pub(super) fn inside_out(bsp: &Bsp, prt: &Prt) -> Option<(usize, [u32; 2])> {
    let tree = bsp.world_tree().ok()?;
    let mut places = Places::new(&tree, &clusters_of_leafs(bsp, &prt.leaf_clusters()), prt.n_clusters() as usize);
    let mut of_first: Vec<usize> = (0..prt.n_portals()).collect();
    of_first.sort_by_key(|&k| prt.portal(k).clusters[0]);
    let mut wrong: Option<usize> = None;
    for k in of_first {
        let portal = prt.portal(k);
        places.stand_in(portal.clusters[0]);
        let Some(shape) = Portal3::around(portal.points) else { continue };
        if wrong.is_none_or(|first| k < first) && places.contradict(portal.clusters[1], &shape) {
            wrong = Some(k);
        }
    }
    wrong.map(|k| (k, prt.portal(k).clusters))
}

/// Where clusters lie in a tree.
struct Places<'t> {
    tree: &'t BspTree,
    /// For each node its parent and the side that it is on there; none for the root.
    parents: Vec<Option<(u32, usize)>>,
    /// For each cluster the nodes that its leafs are on, with the side.
    of_cluster: Vec<Vec<(u32, usize)>>,
    /// The sides of each node that the current cluster is on.
    sides: Vec<[bool; 2]>,
    /// Nodes with such a side.
    marked: Vec<u32>,
    current: Option<u32>,
}

impl<'t> Places<'t> {
    fn new(tree: &'t BspTree, clusters: &[Option<u32>], n_clusters: usize) -> Self {
        let (mut parents, mut of_cluster) = (vec![None; tree.nodes().len()], vec![Vec::new(); n_clusters]);
        for (node, parent) in tree.nodes().iter().zip(0..) {
            for (side, child) in node.children.into_iter().enumerate() {
                match child {
                    BspChild::Node(below) => parents[below as usize] = Some((parent, side)),
                    BspChild::Leaf(leaf) => {
                        let cluster = clusters.get(leaf as usize).copied().flatten();
                        let place = cluster.and_then(|cluster| of_cluster.get_mut(cluster as usize));
                        place.into_iter().for_each(|place: &mut Vec<_>| place.push((parent, side)));
                    }
                }
            }
        }
        let sides = vec![[false; 2]; tree.nodes().len()];
        Self { tree, parents, of_cluster, sides, marked: Vec::new(), current: None }
    }

    fn stand_in(&mut self, cluster: u32) {
        if self.current == Some(cluster) {
            return;
        }
        self.current = Some(cluster);
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

    /// Whether all planes at a portal that have a part of the current cluster on one side and a part of another on the other have them the other way
    /// round than the portal's corners, and there is one.
    fn contradict(&self, cluster: u32, shape: &Portal3) -> bool {
        let mut is_contradicted = false;
        for place in &self.of_cluster[cluster as usize] {
            let mut at = Some(*place);
            while let Some((node, side)) = at {
                at = self.parents[node as usize];
                let plane = &self.tree.nodes()[node as usize];
                let is_near = || shape.corners().iter().all(|&p| height(plane, p).abs() <= MAX_UNEVENNESS);
                if !self.sides[node as usize][1 - side] || !is_near() {
                    continue;
                }
                let cosine = cosine(plane.normal, shape.normal()) * if side == 0 { 1.0 } else { -1.0 };
                if cosine > PARALLEL {
                    return false;
                }
                is_contradicted |= cosine < -PARALLEL;
            }
        }
        is_contradicted
    }
}

/// How far a point is above a plane, rounded.
fn height(plane: &BspNode, p: Point3) -> f64 {
    dot(plane.normal, p) - plane.distance
}

fn dot(a: Point3, b: Point3) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// 0 for a vector without a direction.
fn cosine(a: Point3, b: Point3) -> f64 {
    let largest = b.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let b = b.map(|x| x / largest);
    let cosine = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
    if cosine.is_finite() { cosine } else { 0.0 }
}
