//! Patches of triangles that grow over shared edges.
//!
//! A patch is a disc: a set of consistently oriented triangles, with one loop around them that visits no vertex twice.
//! A triangle joins if it shares one chain of edges with the loop and no other vertex.
//!
//! The worth of a patch is the area of the kernel of its loop: an occluder hides on lines that pass all edges on the
//! same side, so a notch loses all that lies beyond the lines of its edges. Growth continues for a while after the
//! kernel has shrunk, as the triangles of a convex polygon are rarely in an order in which all prefixes are convex too,
//! and then returns to the best state.

use super::PatchOptions;
use super::polygon::{is_inside, kernel_area};
use super::vector::{add, basis, collinear, cross, dot, length, normal, sub, unit, vector_area};
use super::weld::Mesh;
use crate::Occluder;
use sightlines_geometry::{Point2, Point3, orient3d};

/// Grows patches on a mesh; keeps its memory.
#[derive(Debug)]
pub(super) struct Grower<'a> {
    mesh: &'a Mesh,
    options: &'a PatchOptions,
    /// Twice the area of each triangle.
    normals: Vec<Point3>,
    epoch: u32,
    /// When each triangle joined, or was rejected for good.
    joined: Vec<u32>,
    /// When each vertex came onto the outline.
    on_outline: Vec<u32>,
    /// Plane of each triangle that joined: an index into `facets`.
    facet_of: Vec<u32>,
    outline: Vec<u32>,
    /// From each vertex of the outline to the next one.
    edges: Vec<u32>,
    triangles: Vec<(u32, bool)>,
    facets: Vec<u32>,
    normal: Point3,
    /// Number of neighbours examined so far.
    pub(super) work: u64,
    flat: Vec<Point2>,
    scratch: [Vec<Point2>; 2],
}

/// The best state of a patch.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Its triangles, in the order in which they joined, and whether each is reversed.
    pub(super) triangles: Vec<(u32, bool)>,
    outline: Vec<u32>,
    worth: f64,
}

/// Most vertices around a patch, including those that are not corners.
const MAX_LOOP: usize = 128;

/// A triangle that could join.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    triangle: u32,
    /// Where on the outline, and where on its own loop, the shared edge starts.
    at: usize,
    there: usize,
    /// Whether it has to be reversed.
    turned: bool,
    /// Triangles that fill notches come first, by how much; then those that make none, by area; then those that make
    /// the smallest.
    rank: (u8, f64),
}

impl<'a> Grower<'a> {
    pub(super) fn new(mesh: &'a Mesh, options: &'a PatchOptions) -> Self {
        let n = mesh.triangles().len();
        Self {
            mesh,
            options,
            normals: (0..n as u32).map(|t| normal(mesh.corners(t))).collect(),
            epoch: 0,
            joined: vec![0; n],
            on_outline: vec![0; mesh.vertices().len()],
            facet_of: vec![0; n],
            outline: Vec::new(),
            edges: Vec::new(),
            triangles: Vec::new(),
            facets: Vec::new(),
            normal: [0.0; 3],
            work: 0,
            flat: Vec::new(),
            scratch: [Vec::new(), Vec::new()],
        }
    }

    /// Twice the area of a triangle.
    pub(super) fn twice_area(&self, triangle: u32) -> f64 {
        length(self.normals[triangle as usize])
    }

    /// The best patch that grows from a triangle.
    pub(super) fn grow(&mut self, seed: u32) -> Patch {
        self.start(seed);
        let mut best = self.state(self.twice_area(seed) / 2.0);
        let mut since = 0;
        // A row along one side takes up to two triangles for each vertex on it.
        while since < self.options.patience + best.outline.len() && self.triangles.len() < self.options.max_triangles {
            let Some(next) = self.best_candidate() else { break };
            if !self.join(next) {
                self.joined[next.triangle as usize] = self.epoch;
                continue;
            }
            let worth = self.worth();
            if worth > best.worth * (1.0 + 1e-9) && self.n_corners() <= self.options.max_corners {
                best = self.state(worth);
                since = 0;
            } else {
                since += 1;
            }
        }
        best
    }

    fn start(&mut self, seed: u32) {
        self.epoch += 1;
        self.outline.clear();
        self.outline.extend_from_slice(self.mesh.outline(seed));
        self.edges.clear();
        self.edges.extend_from_slice(self.mesh.outline_edges(seed));
        self.outline.iter().for_each(|&v| self.on_outline[v as usize] = self.epoch);
        self.joined[seed as usize] = self.epoch;
        self.facet_of[seed as usize] = 0;
        (self.triangles, self.facets) = (vec![(seed, false)], vec![seed]);
        self.normal = self.normals[seed as usize];
    }

    fn state(&self, worth: f64) -> Patch {
        Patch { triangles: self.triangles.clone(), outline: self.outline.clone(), worth }
    }

    /// Number of corners that an occluder would have.
    fn n_corners(&self) -> usize {
        let n = self.outline.len();
        if n <= self.options.max_corners {
            return n;
        }
        let at = |i: usize| self.at(self.outline[i % n]);
        (0..n).filter(|&i| !is_between(at(i + n - 1), at(i), at(i + 1))).count()
    }

    fn at(&self, v: u32) -> Point3 {
        self.mesh.vertices()[v as usize]
    }

    /// Area of the kernel, in the direction of the patch's normal.
    fn worth(&mut self) -> f64 {
        let [u, v] = basis(self.normal.map(|x| x / length(self.normal)));
        let vertices = self.mesh.vertices();
        let o = vertices[self.outline[0] as usize];
        self.flat.clear();
        self.flat.extend(self.outline.iter().map(|&i| {
            let p = sub(vertices[i as usize], o);
            Point2::new(dot(p, u), dot(p, v))
        }));
        let [a, b] = &mut self.scratch;
        kernel_area(&self.flat, a, b)
    }

    fn best_candidate(&mut self) -> Option<Candidate> {
        let mut best: Option<Candidate> = None;
        for at in 0..self.outline.len() {
            let edge = self.edges[at];
            for &triangle in self.mesh.triangles_at(edge) {
                if self.joined[triangle as usize] == self.epoch {
                    continue;
                }
                self.work += 1;
                let Some(candidate) = self.candidate(triangle, edge, at) else { continue };
                let better = |b: &Candidate| {
                    let order = candidate.rank.0.cmp(&b.rank.0).then(candidate.rank.1.total_cmp(&b.rank.1));
                    order.then(b.triangle.cmp(&candidate.triangle)).is_gt()
                };
                if best.as_ref().is_none_or(better) {
                    best = Some(candidate);
                }
            }
        }
        best
    }

    fn candidate(&self, triangle: u32, edge: u32, at: usize) -> Option<Candidate> {
        let there = self.mesh.outline_edges(triangle).iter().position(|&e| e == edge)?;
        let ring = self.mesh.outline(triangle);
        let n = self.outline.len();
        // Neighbours that turn alike run along their edge in opposite directions.
        let turned = ring[there] == self.outline[at];
        let is_front_only = self.mesh.is_front_only(triangle);
        if is_front_only != self.mesh.is_front_only(self.triangles[0].0) || is_front_only && turned {
            return None;
        }
        let own = self.normals[triangle as usize].map(|x| if turned { -x } else { x });
        let cosine = dot(own, self.normal);
        if cosine < self.options.least_cosine * (dot(own, own) * dot(self.normal, self.normal)).sqrt() {
            return None;
        }
        let [p, q] = [at, (at + 1) % n].map(|i| self.at(self.outline[i]));
        let [before, after] = [(at + n - 1) % n, (at + 2) % n].map(|i| self.at(self.outline[i]));
        let third = self.mesh.triangles()[triangle as usize].into_iter().map(|v| self.at(v));
        let third = third.max_by(|a, b| {
            let off = |c: Point3| cross(sub(c, p), sub(q, p));
            let [a, b] = [off(*a), off(*b)];
            dot(a, a).total_cmp(&dot(b, b))
        })?;
        // How far both ends turn to the right, as sines, now and with the triangle.
        let notch = |a: Point3, b: Point3, c: Point3| {
            let (d, e) = (sub(b, a), sub(c, b));
            let sine = -dot(cross(d, e), self.normal) / (dot(d, d) * dot(e, e) * dot(self.normal, self.normal)).sqrt();
            if sine > self.options.notch { sine } else { 0.0 }
        };
        let then = notch(before, p, third) + notch(third, q, after);
        let gain = notch(before, p, q) + notch(p, q, after) - then;
        let rank = match (gain > 0.0, then == 0.0) {
            (true, _) => (2, gain),
            (false, true) => (1, dot(own, own)),
            (false, false) => (0, gain),
        };
        Some(Candidate { triangle, at, there, turned, rank })
    }

    /// Adds a triangle to the patch, if it stays a disc and within its limits.
    fn join(&mut self, c: Candidate) -> bool {
        let (mut ring, mut ring_edges) =
            (self.mesh.outline(c.triangle).to_vec(), self.mesh.outline_edges(c.triangle).to_vec());
        let mut there = c.there;
        let m = ring.len();
        if c.turned {
            ring.reverse();
            ring_edges.reverse();
            // Vertex i is now at m - 1 - i, and the edge after it before it.
            ring_edges.rotate_left(1);
            there = (2 * m - 2 - there) % m;
        }
        let n = self.outline.len();
        debug_assert_eq!(ring_edges[there], self.edges[c.at], "loops are turned as they should");
        // The chain of shared edges, as far as it goes both ways.
        let shares = |i: usize, k: usize| self.edges[i % n] == ring_edges[k % m];
        let (mut back, mut forth) = (0, 0);
        while back + forth + 1 < n.min(m) && shares(c.at + n - back - 1, there + back + 1) {
            back += 1;
        }
        while back + forth + 1 < n.min(m) && shares(c.at + forth + 1, there + m - forth - 1) {
            forth += 1;
        }
        let n_shared = back + forth + 1;
        // The vertices of its loop that are no ends of shared edges, in order.
        let fresh: Vec<usize> = (1..m - n_shared).map(|k| (there + back + 1 + k) % m).collect();
        if n_shared >= n
            || fresh.iter().any(|&k| self.on_outline[ring[k] as usize] == self.epoch)
            || n + m - 2 * n_shared > MAX_LOOP
        {
            return false;
        }
        let start = (c.at + n - back) % n;
        if !self.add_facet(c, (0..n_shared).map(|k| self.edges[(start + k) % n]).collect()) {
            return false;
        }
        // Turned so that the shared chain is at the front.
        self.outline.rotate_left(start);
        self.edges.rotate_left(start);
        for &v in &self.outline[1..n_shared] {
            self.on_outline[v as usize] = 0;
        }
        for &k in &fresh {
            self.on_outline[ring[k] as usize] = self.epoch;
        }
        // From the start of the chain around the triangle's other vertices to its end.
        let first = (there + back + 1) % m;
        let new_vertices = std::iter::once(self.outline[0]).chain(fresh.iter().map(|&k| ring[k]));
        let new_edges = (0..m - n_shared).map(|k| ring_edges[(first + k) % m]);
        let (vertices, edges): (Vec<u32>, Vec<u32>) = (new_vertices.collect(), new_edges.collect());
        self.outline.splice(..n_shared, vertices);
        self.edges.splice(..n_shared, edges);
        self.joined[c.triangle as usize] = self.epoch;
        self.triangles.push((c.triangle, c.turned));
        let own = self.normals[c.triangle as usize].map(|x| if c.turned { -x } else { x });
        self.normal = add(self.normal, own);
        true
    }

    /// Records the plane of a triangle that joins across some edges; `false` if there are too many.
    fn add_facet(&mut self, c: Candidate, edges: Vec<u32>) -> bool {
        let is_neighbour = |t: &u32| *t != c.triangle && self.joined[*t as usize] == self.epoch;
        let own = self.mesh.corners(c.triangle);
        for t in edges.into_iter().flat_map(|e| self.mesh.triangles_at(e)).copied().filter(is_neighbour) {
            // Refused triangles are marked as well, but their planes are from an earlier patch.
            let facet = self.facet_of[t as usize];
            if self.facets.get(facet as usize).is_some_and(|&f| coplanar(self.mesh.corners(f), own)) {
                self.facet_of[c.triangle as usize] = facet;
                return true;
            }
        }
        if self.facets.len() >= self.options.max_facets {
            return false;
        }
        self.facet_of[c.triangle as usize] = self.facets.len() as u32;
        self.facets.push(c.triangle);
        true
    }

    /// The triangles of a patch that need no other patch: those whose middle is in the kernel.
    pub(super) fn covered(&self, patch: &Patch) -> Vec<u32> {
        let corner = |&i: &u32| self.mesh.vertices()[i as usize];
        let outline: Vec<Point3> = patch.outline.iter().map(corner).collect();
        let [u, v] = basis(unit(vector_area(&outline)));
        let flat = |p: Point3| Point2::new(dot(sub(p, outline[0]), u), dot(sub(p, outline[0]), v));
        let ring: Vec<Point2> = outline.iter().map(|&p| flat(p)).collect();
        let covers = |&(t, _): &(u32, bool)| {
            let [a, b, c] = self.mesh.corners(t).map(flat);
            is_inside(&ring, (a + b + c) / 3.0).then_some(t)
        };
        patch.triangles.iter().filter_map(covers).collect()
    }

    /// The occluder of a patch, without corners within straight lines.
    pub(super) fn occluder(&self, patch: &Patch) -> Option<Occluder> {
        let outline: Vec<Point3> = patch.outline.iter().map(|&v| self.at(v)).collect();
        let corners = |&(t, turned): &(u32, bool)| {
            let [a, b, c] = self.mesh.corners(t);
            if turned { [a, c, b] } else { [a, b, c] }
        };
        let triangles: Vec<[Point3; 3]> = patch.triangles.iter().map(corners).collect();
        Some(self.mesh.sided(patch.triangles[0].0, Occluder::patch(straightened(&outline), &triangles).ok()?))
    }
}

/// Whether two triangles lie in one plane. Exact.
fn coplanar([a, b, c]: [Point3; 3], other: [Point3; 3]) -> bool {
    other.iter().all(|&p| orient3d(a, b, c, p) == 0.0)
}

/// Without the corners that lie exactly between their neighbours.
fn straightened(outline: &[Point3]) -> Vec<Point3> {
    let n = outline.len();
    // What lies between its neighbours lies between those that are left, too.
    let kept = |&i: &usize| !is_between(outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]);
    (0..n).filter(kept).map(|i| outline[i]).collect()
}

/// Whether `p` lies on the segment from `a` to `b`. Exact.
fn is_between(a: Point3, p: Point3, b: Point3) -> bool {
    (0..3).all(|k| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k])) && collinear(a, p, b)
}
