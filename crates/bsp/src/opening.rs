//! The polygons in which the regions below a tree meet.

use crate::corner::Corner;
use crate::outwards::outwards;
use crate::plane::{Oriented, Plane, PlaneId, Planes};
use crate::polygon::{Cut, Polygon};
use crate::{Child, Region, Tree};
use rayon::prelude::*;
use sightlines_geometry::Point3;
use std::rc::Rc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Two regions that meet, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// The node on whose plane they meet.
    pub node: u32,
    /// What is in front of that plane, and what is behind it.
    pub regions: [Region; 2],
    /// At least three corners, in scene units, counter-clockwise as seen from in front. They are rounded outwards: the polygon that
    /// they go round has all of the exact one within, seen along the axis nearest to the plane's normal. Corners that
    /// doubles hold are exact.
    pub corners: Vec<Point3>,
}

/// How many corners of polygons are compared with planes for each node, on average. Real maps take some hundred; a tree that was made to be slow would
/// take many times as many as it has nodes.
const MOST_CUTS: u64 = 1 << 15;
/// How many openings are found for each node, on average, beside some for small trees. Real maps have two.
const MOST_OPENINGS: u64 = 32;
const FEW_OPENINGS: u64 = 1 << 16;

/// All pairs of regions that meet in an area, for which `is_wanted` says so, within a cube of `size` in all directions from the origin.
/// Sorted by their node, and in the order of the tree below it. Parallel; the same for any number of threads.
///
/// Whether two regions meet is decided exactly. A region without volume meets nothing.
///
/// `None` if, for each node, the tree takes more than 2^15 comparisons of a corner with a plane, or has more than 32 openings (and 2^16 more), as
/// only a hostile one does.
///
/// # Panics
/// If `size` is not a power of two from 1 to 2^60.
///
/// # Source
/// Convex polygons as planes: Bernstein and Fussell, "Fast, exact, linear Booleans" (2009), section 3.
pub fn openings(tree: &Tree, size: f64, is_wanted: impl Fn([Region; 2]) -> bool + Sync) -> Option<Vec<Opening>> {
    assert!((1.0..=2f64.powi(60)).contains(&size) && size.log2().fract() == 0.0, "a power of two: {size}");
    let mut planes = Planes::default();
    let of_node: Vec<Oriented> = tree.nodes().iter().map(|node| planes.add(node.plane)).collect();
    let walls = [0, 1, 2].map(|axis| {
        [-size, size].map(|distance| {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            planes.add(Plane { normal, distance }).id
        })
    });
    let (n_cuts, n_openings) = (AtomicU64::new(0), AtomicU64::new(0));
    let walk = Walk { tree, planes, of_node, walls, n_cuts, n_openings };
    let found: Option<Vec<Vec<Opening>>> =
        (0..tree.nodes().len()).into_par_iter().map(|node| walk.openings_of(node, &is_wanted)).collect();
    found.map(|found| found.into_iter().flatten().collect())
}

/// A tree with its planes, each once.
struct Walk<'t> {
    tree: &'t Tree,
    planes: Planes,
    of_node: Vec<Oriented>,
    /// The planes of the cube.
    walls: [[PlaneId; 2]; 3],
    n_cuts: AtomicU64,
    n_openings: AtomicU64,
}

impl Walk<'_> {
    /// The openings on the plane of a node. `None` if cuts or openings are used up.
    fn openings_of(&self, node: usize, is_wanted: &(impl Fn([Region; 2]) -> bool + Sync)) -> Option<Vec<Opening>> {
        let mut all = Vec::new();
        let Some(polygon) = self.polygon(node)? else { return Some(all) };
        for (front, part) in self.below(node, 0, polygon)? {
            for (back, part) in self.below(node, 1, part)? {
                let regions = [front, back];
                if is_wanted(regions) {
                    let limit = FEW_OPENINGS + MOST_OPENINGS * self.tree.nodes().len() as u64;
                    if self.n_openings.fetch_add(1, Ordering::Relaxed) >= limit {
                        return None;
                    }
                    let corners = self.corners(node, part.corners());
                    all.push(Opening { node: node as u32, regions, corners });
                }
            }
        }
        Some(all)
    }

    /// What the nodes above leave of a node's plane: nothing, if one of them has the same plane.
    fn polygon(&self, node: usize) -> Option<Option<Polygon>> {
        let mut polygon = Polygon::of_plane(self.of_node[node].id, &self.walls, &self.planes);
        for (above, side) in self.tree.above(node) {
            let Some(whole) = polygon else { break };
            self.count(whole.corners().len())?;
            let plane = self.of_node[above];
            polygon = whole.on_side(plane.id, plane.sign_of(side), &self.planes);
        }
        Some(polygon)
    }

    /// The regions on a side of a node that a polygon on its plane touches, with the part that touches each.
    fn below(&self, node: usize, side: usize, polygon: Polygon) -> Option<Vec<(Region, Polygon)>> {
        let start = Region { node: node as u32, side: side as u8, leaf: 0 };
        let (mut found, mut open) = (Vec::new(), vec![(start, polygon)]);
        while let Some((region, polygon)) = open.pop() {
            let at = match self.tree.nodes()[region.node as usize].children[usize::from(region.side)] {
                Child::Leaf(leaf) => {
                    found.push((Region { leaf, ..region }, polygon));
                    continue;
                }
                Child::Node(below) => below,
            };
            let plane = self.of_node[at as usize];
            self.count(polygon.corners().len())?;
            let on = |sign: i32| Region { node: at, side: plane.side_of(sign) as u8, leaf: 0 };
            match polygon.cut(plane.id, &self.planes) {
                Cut::Whole(sign) => open.push((on(sign), polygon)),
                Cut::Both(front, back) => {
                    let mut parts = [(on(1), front), (on(-1), back)];
                    parts.sort_by_key(|(region, _)| std::cmp::Reverse(region.side));
                    open.extend(parts);
                }
                // A plane below that is the node's again: what is next to the polygon is on its side of it.
                Cut::On => open.push((on(self.sign_next_to(node, side, plane.id)), polygon)),
            }
        }
        Some(found)
    }

    /// On which side of a plane that is the same as a node's the space on a side of the node is.
    fn sign_next_to(&self, node: usize, side: usize, plane: PlaneId) -> i32 {
        let own = self.of_node[node];
        let (a, b) = (self.planes.row(own.id), self.planes.row(plane));
        // Parallel: all coordinates that are not 0 tell the same.
        let agrees = (0..3).find(|&k| a[k] != 0.0).is_none_or(|k| (a[k] > 0.0) == (b[k] > 0.0));
        own.sign_of(side) * if agrees { 1 } else { -1 }
    }

    fn count(&self, n: usize) -> Option<()> {
        let limit = MOST_CUTS * self.tree.nodes().len() as u64;
        (self.n_cuts.fetch_add(n as u64, Ordering::Relaxed) < limit).then_some(())
    }

    /// Corners as doubles, counter-clockwise as seen from in front of the node.
    fn corners(&self, node: usize, corners: &[Rc<Corner>]) -> Vec<Point3> {
        let plane = self.of_node[node];
        let normal = self.planes.row(plane.id);
        let exact: Vec<_> = corners.iter().map(|corner| corner.rounded(&self.planes)).collect();
        let mut rounded = outwards(&exact, [normal[0], normal[1], normal[2]]);
        if plane.is_flipped {
            rounded.reverse();
        }
        rounded
    }
}
