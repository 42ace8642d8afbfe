//! The surfaces of a scene, prepared for lines: a mesh, a tree of its triangles, and what estimates need.

use crate::conform::conform;
use sightlines_geometry::vector::{add, dot, length, normal, scale, sub};
use sightlines_geometry::{Aabb, BoxTree, Point3, ray_box, ray_triangle};
use sightlines_multifocal::mesh::Mesh;

/// A mesh with what is looked up for every line. Can be shared by threads.
#[derive(Debug)]
pub struct Surface {
    mesh: Mesh,
    /// For each triangle whether it blocks lines from its front only; empty if none does.
    front_only: Vec<bool>,
    corners: Vec<[Point3; 3]>,
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
    areas: Vec<f64>,
    reach: Point3,
}

/// A triangle that a segment meets, as doubles have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// The part of the segment before.
    pub(crate) at: f64,
    pub(crate) triangle: u32,
}

/// By how much segments may miss triangles and still start a chain there. More hits only cost time: chains are checked exactly.
const SLACK: f64 = 1e-9;

impl Surface {
    /// Welds the triangles, and cuts flat faces along the edges that stand on them. O(n log² n), and quadratic at worst in the
    /// edges on one face.
    pub fn new(triangles: &[[Point3; 3]]) -> Self {
        Self::of(Mesh::weld(triangles))
    }

    /// The same of triangles that are welded already.
    pub fn of(mesh: Mesh) -> Self {
        let front_only = mesh.front_only().to_vec();
        Self::build(mesh, front_only)
    }

    /// The same of triangles that block lines in both directions, and of others that block only those that pass them from their front, where
    /// their corners go around counterclockwise, to their back.
    pub fn with_fronts(both_sides: &[[Point3; 3]], fronts: &[[Point3; 3]]) -> Self {
        Self::of(Mesh::weld_with_fronts(both_sides, fronts))
    }

    fn build(mut mesh: Mesh, mut front_only: Vec<bool>) -> Self {
        if let Some(cut) = conform(&mesh, &front_only) {
            drop(mesh);
            let (triangles, are_front_only): (Vec<[Point3; 3]>, Vec<bool>) = cut.into_iter().unzip();
            mesh = Mesh::weld(&triangles);
            let n = mesh.triangles().len() as u32;
            front_only = if front_only.is_empty() {
                Vec::new()
            } else {
                (0..n).map(|t| are_front_only[mesh.source(t) as usize]).collect()
            };
        }
        let corners: Vec<[Point3; 3]> = (0..mesh.triangles().len() as u32).map(|t| mesh.corners(t)).collect();
        let all = || corners.iter().copied();
        let boxes: Vec<Aabb<3>> = all().map(Aabb::around).collect();
        let tree = BoxTree::build(&boxes, 4);
        let areas = all().map(|t| length(normal(t)) / 2.0).collect();
        let size = |k: usize| mesh.vertices().iter().map(|p| p[k].abs()).fold(0.0, f64::max);
        let reach = [0, 1, 2].map(size);
        Self { mesh, front_only, corners, boxes, tree, areas, reach }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether a triangle blocks lines from its front only.
    pub(crate) fn is_front_only(&self, triangle: u32) -> bool {
        self.front_only.get(triangle as usize) == Some(&true)
    }

    /// Whether any triangle does.
    pub(crate) fn has_fronts(&self) -> bool {
        !self.front_only.is_empty()
    }

    /// Whether no point of a box is behind a triangle. Exact.
    pub(crate) fn is_in_front(&self, triangle: u32, volume: &Aabb<3>) -> bool {
        self.mesh.is_in_front(triangle, volume)
    }

    /// Whether a line meets the front of a triangle, as doubles have it.
    pub(crate) fn is_met_from_front(&self, triangle: u32, [p, q]: &[Point3; 2]) -> bool {
        dot(normal(self.corners(triangle)), sub(*q, *p)) < 0.0
    }

    /// Whether the edge at a place of the outline of a triangle is passed from its lower end to its higher one: 1, or else -1.
    pub(crate) fn way_along(&self, triangle: u32, place: usize) -> i8 {
        let outline = self.mesh.outline(triangle);
        if outline[place] < outline[(place + 1) % outline.len()] { 1 } else { -1 }
    }

    /// The same of an edge of the outline by its index. 1 if no triangle has a front, for then nothing depends on it.
    pub(crate) fn way_at(&self, triangle: u32, edge: u32) -> i8 {
        let place = self.mesh.outline_edges(triangle).iter().position(|&e| e == edge);
        if self.has_fronts() { place.map_or(1, |place| self.way_along(triangle, place)) } else { 1 }
    }

    /// The largest magnitudes of coordinates.
    pub(crate) fn reach(&self) -> Point3 {
        self.reach
    }

    /// The ends of an edge.
    pub(crate) fn edge(&self, edge: u32) -> [Point3; 2] {
        self.mesh.edges()[edge as usize].map(|v| self.mesh.vertices()[v as usize])
    }

    pub(crate) fn corners(&self, triangle: u32) -> [Point3; 3] {
        self.corners[triangle as usize]
    }

    pub(crate) fn bounds(&self, triangle: u32) -> &Aabb<3> {
        &self.boxes[triangle as usize]
    }

    pub(crate) fn middle(&self, triangle: u32) -> Point3 {
        let [a, b, c] = self.corners(triangle);
        scale(add(add(a, b), c), 1.0 / 3.0)
    }

    pub(crate) fn area(&self, triangle: u32) -> f64 {
        self.areas[triangle as usize]
    }

    /// The triangles that the segment from `p` to `q` meets, in no particular order.
    pub(crate) fn hits(&self, p: Point3, q: Point3, hits: &mut Vec<Hit>) {
        hits.clear();
        let d = sub(q, p);
        // An axis along which the segment does not move is left out for boxes around it; others it misses.
        let inverse = d.map(|x| 1.0 / x);
        let enters = |b: &Aabb<3>| {
            if (0..3).any(|k| d[k] == 0.0 && (p[k] < b.min[k] || p[k] > b.max[k])) {
                return false;
            }
            let [first, last] = ray_box(b, p, [0, 1, 2].map(|k| if d[k] == 0.0 { f64::NAN } else { inverse[k] }));
            first.max(-SLACK) <= last.min(1.0 + SLACK) + SLACK
        };
        self.tree.visit(enters, |triangle| {
            let [x, y, at] = ray_triangle(&self.corners[triangle as usize], p, d);
            if x >= -SLACK && y >= -SLACK && x + y <= 1.0 + SLACK && (-SLACK..=1.0).contains(&at) {
                hits.push(Hit { at, triangle });
            }
        });
    }
}
