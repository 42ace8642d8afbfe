//! Merged equal corners, and the edges that triangles share.

use super::vector::collinear;
use sightlines_geometry::{Aabb, BoxTree, Point3, check_coordinate};

/// Triangles that share corners and edges wherever these are exactly equal.
///
/// An edge may have any number of triangles. Where a corner lies exactly on an edge that would otherwise have an odd
/// number of them, the edge is cut there: so the long edge of a wall meets the short ones of its neighbours, and what
/// is closed as a surface is closed as a mesh. Corners near an edge, but not on it, leave a crack, as they do
/// for lines of sight.
///
/// Leaves out triangles without area, triangles with coordinates that predicates do not accept, and all but the first
/// of triangles with the same three corners.
///
/// The same triangles in the same order give the same mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    vertices: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
    sources: Vec<u32>,
    /// Where the loop of each triangle starts, and the end.
    loop_starts: Vec<u32>,
    /// Vertices around each triangle.
    loops: Vec<u32>,
    /// The edge from each vertex of a loop to the next one.
    loop_edges: Vec<u32>,
    edges: Vec<[u32; 2]>,
    /// Where the triangles of each edge start, and the end.
    around_starts: Vec<u32>,
    around: Vec<u32>,
    /// For each triangle whether it hides from its front only; empty if none does.
    pub(super) front_only: Vec<bool>,
}

impl Mesh {
    /// Welds `triangles`. O(n log n) where few edges are open, with another logarithm for the open ones.
    pub fn weld(triangles: &[[Point3; 3]]) -> Self {
        let mut mesh = Self::default();
        mesh.weld_corners(triangles);
        let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect::<Vec<_>>();
        let cuts = mesh.cuts(&sides);
        mesh.make_loops(&sides, &cuts);
        mesh.make_edges();
        mesh
    }

    /// The corners, in ascending order of their coordinates.
    pub fn vertices(&self) -> &[Point3] {
        &self.vertices
    }

    /// The corners of each triangle, turning as they were given.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Point3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }

    /// The index of the given triangle.
    pub fn source(&self, triangle: u32) -> u32 {
        self.sources[triangle as usize]
    }

    /// The vertices around a triangle, starting with its first corner: its corners, and vertices on its sides
    /// where these are cut.
    pub fn outline(&self, triangle: u32) -> &[u32] {
        &self.loops[self.loop_range(triangle)]
    }

    /// The edges of [`Self::outline`]: each from the vertex of the same index to the next one.
    pub fn outline_edges(&self, triangle: u32) -> &[u32] {
        &self.loop_edges[self.loop_range(triangle)]
    }

    /// The ends of each edge, the lower first.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The triangles of an edge, ascending.
    pub fn triangles_at(&self, edge: u32) -> &[u32] {
        let [start, end] = [edge, edge + 1].map(|e| self.around_starts[e as usize] as usize);
        &self.around[start..end]
    }

    fn loop_range(&self, triangle: u32) -> std::ops::Range<usize> {
        let [start, end] = [triangle, triangle + 1].map(|t| self.loop_starts[t as usize] as usize);
        start..end
    }

    /// Vertices, triangles and their sources.
    fn weld_corners(&mut self, triangles: &[[Point3; 3]]) {
        let good = |&(_, t): &(u32, &[Point3; 3])| {
            t.iter().flatten().all(|&x| check_coordinate(x).is_ok()) && !collinear(t[0], t[1], t[2])
        };
        let good: Vec<(u32, &[Point3; 3])> = (0..).zip(triangles).filter(good).collect();
        let mut corners: Vec<([u64; 3], u32)> = Vec::with_capacity(3 * good.len());
        for (i, (_, t)) in (0u32..).zip(&good) {
            corners.extend((0..).zip(t.iter()).map(|(k, p)| (p.map(ascending_bits), 3 * i + k)));
        }
        corners.sort_unstable();
        let mut ids = vec![0; corners.len()];
        for same in corners.chunk_by(|a, b| a.0 == b.0) {
            let at = same[0].1 as usize;
            same.iter().for_each(|c| ids[c.1 as usize] = self.vertices.len() as u32);
            self.vertices.push(good[at / 3].1[at % 3].map(|x| x + 0.0));
        }
        let sorted = |i: usize| {
            let mut t = [ids[3 * i], ids[3 * i + 1], ids[3 * i + 2]];
            t.sort_unstable();
            t
        };
        let mut order: Vec<([u32; 3], u32)> = (0..good.len()).map(|i| (sorted(i), i as u32)).collect();
        order.sort_unstable();
        order.dedup_by_key(|o| o.0);
        let mut kept: Vec<u32> = order.iter().map(|o| o.1).collect();
        kept.sort_unstable();
        let corners_of = |&i: &u32| [0, 1, 2].map(|k| ids[3 * i as usize + k]);
        self.triangles = kept.iter().map(corners_of).collect();
        self.sources = kept.iter().map(|&i| good[i as usize].0).collect();
    }

    /// Where sides with an odd number of triangles are split: the ends of each side in ascending order, and the vertex.
    fn cuts(&self, sides: &[[u32; 2]]) -> Vec<([u32; 2], u32)> {
        let mut all: Vec<[u32; 2]> = sides.iter().map(|&s| ascending(s)).collect();
        all.sort_unstable();
        let odd: Vec<[u32; 2]> = all.chunk_by(|a, b| a == b).filter(|c| c.len() % 2 == 1).map(|c| c[0]).collect();
        let mut ends: Vec<u32> = odd.iter().copied().flatten().collect();
        ends.sort_unstable();
        ends.dedup();
        let at = |v: u32| self.vertices[v as usize];
        let boxes: Vec<Aabb<3>> = odd.iter().map(|&[a, b]| Aabb::around([at(a), at(b)])).collect();
        let tree = BoxTree::build(&boxes, 8);
        let mut cuts = Vec::new();
        for &v in &ends {
            let p = at(v);
            tree.visit(
                |b| b.contains(p),
                |i| {
                    let [a, b] = odd[i as usize];
                    if boxes[i as usize].contains(p) && v != a && v != b && collinear(at(a), p, at(b)) {
                        cuts.push(([a, b], v));
                    }
                },
            );
        }
        // Vertices ascend along every line from a lower to a higher one, and so do their ids.
        cuts.sort_unstable();
        cuts
    }

    fn make_loops(&mut self, sides: &[[u32; 2]], cuts: &[([u32; 2], u32)]) {
        self.loop_starts.push(0);
        for (i, &side) in sides.iter().enumerate() {
            self.loops.push(side[0]);
            let key = ascending(side);
            let start = cuts.partition_point(|c| c.0 < key);
            let on_it = || cuts[start..].iter().take_while(|c| c.0 == key).map(|c| c.1);
            if side[0] < side[1] {
                self.loops.extend(on_it());
            } else {
                let mut back: Vec<u32> = on_it().collect();
                back.reverse();
                self.loops.extend(back);
            }
            if i % 3 == 2 {
                self.loop_starts.push(self.loops.len() as u32);
            }
        }
    }

    fn make_edges(&mut self) {
        let mut uses: Vec<([u32; 2], u32, u32)> = Vec::with_capacity(self.loops.len());
        for t in 0..self.triangles.len() as u32 {
            let range = self.loop_range(t);
            let ring = &self.loops[range.clone()];
            for (i, at) in range.enumerate() {
                uses.push((ascending([ring[i], ring[(i + 1) % ring.len()]]), t, at as u32));
            }
        }
        uses.sort_unstable();
        self.loop_edges = vec![0; uses.len()];
        self.around_starts.push(0);
        for same in uses.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|u| self.loop_edges[u.2 as usize] = self.edges.len() as u32);
            self.edges.push(same[0].0);
            self.around.extend(same.iter().map(|u| u.1));
            self.around_starts.push(self.around.len() as u32);
        }
    }
}

fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Bits that ascend as finite doubles do; both zeros give the same.
fn ascending_bits(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}
