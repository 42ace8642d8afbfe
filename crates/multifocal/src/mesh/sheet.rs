//! Surfaces that separate two boxes, by parity.
//!
//! Let `F` be any set of triangles, and its *rim* the edges at which an odd number of them end. For a box `V` of eyes, a
//! box `E` and the convex hull `K` of both, let
//! 1. no triangle of `F` meet the relative interior of `V`, nor any point of `E`,
//! 2. no edge of the rim meet the relative interior of `K`,
//! 3. one segment from the relative interior of `V` to that of `E` cross `F` an odd number of times, nowhere at an edge.
//!
//! Then every segment from a point of `V` to a point of `E` meets `F` before its end.
//!
//! # Why
//! Segments between the relative interiors can be moved into each other, as these are convex; on the way all stay in
//! the relative interior of `K`, as a point between relative interior points of two convex sets is in the relative
//! interior of their hull. So they never pass the rim (2), their ends never pass `F` (1), and the number of times that
//! they cross `F` stays odd or even: it is the intersection number modulo 2 of a path and a chain, each of which avoids
//! the other's boundary. So all of them meet `F` (3). A segment from or to a border is a limit of such segments, and
//! meets `F` as `F` is closed; not at its end in `E` (1), so before. It may meet `F` at its other end: an eye that
//! touches a wall sees nothing through it.
//!
//! Triangles that hide from their fronts only are in `F` if no point of `V` is behind them, and some are before: whoever meets one comes
//! from its front. For this volume the others are not there.
//!
//! `F` is arbitrary. Here it is found by walking over the surface that the eyes see, from each triangle that a segment
//! hits first, around open or shared edges, to the next triangle on the same side; triangles visited on both sides are
//! left out. Soundness does not depend on the walk: the three conditions are checked afterwards.
//!
//! Source: parity as for the ShieldTester of Navazo, Rossignac, Jou and Shariff, Computer Graphics Forum 22(3), 2003; the walk
//! on sides and the treatment of borders were chosen here.
//!
//! Parts of a query are functions of their own for the compiler, too: as one, they take twice as long.

mod starts;

use super::probe::{N_SEGMENTS, crosses, segment};
use super::shaft::{Shaft, avoids};
use super::vector::{basis, dot, sub, unit};
use super::weld::Mesh;
use sightlines_geometry::{Aabb, BoxTree, Point3, check_coordinate, orient3d};
use starts::pieces;

/// A mesh, prepared for separation tests. Can be shared by threads.
#[derive(Debug)]
pub struct Sheets {
    mesh: Mesh,
    boxes: Vec<Aabb<3>>,
    tree: BoxTree<3>,
    /// The triangles of each edge in their order around it, as the mesh lists them.
    around: Vec<u32>,
    around_starts: Vec<u32>,
    /// For each triangle the piece of the mesh that it belongs to: triangles that hang together by edges.
    piece: Vec<u32>,
}

impl Sheets {
    /// Welds the triangles. O(n log² n).
    pub fn new(triangles: &[[Point3; 3]]) -> Self {
        Self::of(Mesh::weld(triangles))
    }

    /// Of a mesh, with the sides that its triangles hide from. O(n log² n).
    pub fn of(mesh: Mesh) -> Self {
        let n = mesh.triangles().len() as u32;
        let boxes: Vec<Aabb<3>> = (0..n).map(|t| Aabb::around(mesh.corners(t))).collect();
        let tree = BoxTree::build(&boxes, 4);
        let (mut around, mut around_starts) = (Vec::with_capacity(mesh.edges().len() * 2), vec![0]);
        for edge in 0..mesh.edges().len() as u32 {
            let start = around.len();
            around.extend_from_slice(mesh.triangles_at(edge));
            if around.len() > start + 2 {
                sort_around(&mesh, edge, &mut around[start..]);
            }
            around_starts.push(around.len() as u32);
        }
        Self { piece: pieces(&mesh), mesh, boxes, tree, around, around_starts }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// A reusable workspace for many tests.
    pub fn tester(&self) -> SheetTester<'_> {
        let n = self.mesh.triangles().len();
        SheetTester {
            sheets: self,
            epoch: 0,
            walked: vec![0; 2 * n],
            codes: vec![(0, 0); self.mesh.vertices().len()],
            odd: vec![0; self.mesh.edges().len()],
            queue: Vec::new(),
            n_walked: 0,
            starts: Vec::new(),
            pieces: Vec::new(),
            met: Vec::new(),
            segment_order: std::array::from_fn(|k| k as u32 + 1),
            from_volume: vec![0; n],
            volume: (Aabb::EMPTY, 0),
            forked: false,
            chain: Vec::new(),
        }
    }

    /// A single query; see [`SheetTester::hides`]. O(n) in addition, so use one [`SheetTester`] for many queries.
    pub fn hides(&self, v: &Aabb<3>, e: &Aabb<3>, limit: usize) -> bool {
        self.tester().hides(v, e, limit)
    }

    fn around(&self, edge: u32) -> &[u32] {
        let [start, end] = [edge, edge + 1].map(|e| self.around_starts[e as usize] as usize);
        &self.around[start..end]
    }

    /// Whether the triangle's loop traverses the edge from its lower end to its upper one.
    fn is_forward(&self, triangle: u32, at: usize) -> bool {
        let ring = self.mesh.outline(triangle);
        ring[at] < ring[(at + 1) % ring.len()]
    }

    /// The next side on the same side of the surface, around an edge: in a turn around the edge, the upper side of a
    /// triangle is followed by the lower side of the next one. Also whether any were passed over that are not `there`.
    fn next_side(&self, side: Side, at: usize, mut there: impl FnMut(u32) -> bool) -> (Side, bool) {
        let edge = self.mesh.outline_edges(side.triangle)[at];
        let up = side.front == self.is_forward(side.triangle, at);
        let around = self.around(edge);
        let n = around.len();
        let mut i = around.iter().position(|&t| t == side.triangle).expect("an edge of a triangle lists it");
        let mut next = || {
            i = if up { (i + 1) % n } else { (i + n - 1) % n };
            around[i]
        };
        let (mut triangle, mut passed_any) = (next(), false);
        while !there(triangle) {
            (triangle, passed_any) = (next(), true);
        }
        let at = self.mesh.outline_edges(triangle).iter().position(|&e| e == edge);
        let at = at.expect("a triangle of an edge has it");
        (Side { triangle, front: self.is_forward(triangle, at) != up }, passed_any)
    }
}

/// One of the two sides of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Side {
    triangle: u32,
    /// The side that the right-hand normal points to.
    front: bool,
}

impl Side {
    fn index(self) -> usize {
        2 * self.triangle as usize + usize::from(self.front)
    }

    fn other(self) -> Self {
        Self { front: !self.front, ..self }
    }
}

/// Sorts triangles by their angle around an edge, upwards as seen against the direction of the edge. Any order is
/// valid; this one makes walks follow the visible surface.
fn sort_around(mesh: &Mesh, edge: u32, triangles: &mut [u32]) {
    let [a, b] = mesh.edges()[edge as usize].map(|v| mesh.vertices()[v as usize]);
    let [u, v] = basis(unit(sub(b, a)));
    let angle = |t: u32| {
        // The corner farthest from the edge represents the triangle.
        let off = |p: Point3| [dot(sub(p, a), u), dot(sub(p, a), v)];
        let far = mesh.corners(t).map(off).into_iter();
        let [x, y] = far.max_by(|p, q| (p[0] * p[0] + p[1] * p[1]).total_cmp(&(q[0] * q[0] + q[1] * q[1])))?;
        // Grows with the angle, from 0 to 4.
        let s = x.abs() + y.abs();
        Some(match (x >= 0.0, y >= 0.0) {
            (true, true) => y / s,
            (false, true) => 1.0 - x / s,
            (false, false) => 2.0 - y / s,
            (true, false) => 3.0 + x / s,
        })
    };
    triangles.sort_by(|&s, &t| {
        let [x, y] = [s, t].map(|t| angle(t).unwrap_or(0.0));
        x.total_cmp(&y).then(s.cmp(&t))
    });
}

/// Tests pairs of boxes against a mesh, one after the other.
#[derive(Debug)]
pub struct SheetTester<'a> {
    sheets: &'a Sheets,
    /// Marks of earlier queries and walks have lower numbers.
    epoch: u32,
    /// When each side was walked over.
    walked: Vec<u32>,
    /// For each vertex, the query for which its code was computed, and the code.
    codes: Vec<(u32, u32)>,
    /// Parity of the triangles of the chain that end at each edge.
    odd: Vec<u32>,
    queue: Vec<Side>,
    /// Number of sides that walks visited so far.
    n_walked: u64,
    /// Triangles that the first segment meets, with the parameters of the hits.
    starts: Vec<(f64, u32)>,
    /// Pieces of the mesh that all segments met so far, ascending, and whether the current one does.
    pieces: Vec<(u32, bool)>,
    /// Triangles of these that some segment met.
    met: Vec<u32>,
    /// In which order segments are looked at after the first one. Changes no answer.
    segment_order: [u32; N_SEGMENTS as usize - 1],
    /// For each triangle whether it may hide from the volume of the current queries, if that was asked: the mark of the volume, and the
    /// answer in the lowest bit.
    from_volume: Vec<u32>,
    /// The volume of the current queries, and its mark.
    volume: (Aabb<3>, u32),
    /// Whether the walk met an edge without exactly two triangles that are there.
    forked: bool,
    chain: Vec<u32>,
}

/// A query.
struct Pair<'a> {
    v: &'a Aabb<3>,
    e: &'a Aabb<3>,
    shaft: Shaft,
    /// The first mark of this query.
    since: u32,
}

impl SheetTester<'_> {
    /// Whether every segment from a point of `v` to a point of `e` certainly meets the mesh before its end. Errs
    /// towards `false`.
    ///
    /// * `v`: the eyes; triangles that touch its border may hide
    /// * `e`: the target; triangles that touch it hide nothing
    /// * `limit`: number of triangle sides to visit, in all
    ///
    /// Cost: a few lines through the tree if they pass freely, otherwise the walk.
    pub fn hides(&mut self, v: &Aabb<3>, e: &Aabb<3>, limit: usize) -> bool {
        let usable = |b: &Aabb<3>| !b.is_empty() && b.min.iter().chain(&b.max).all(|&x| check_coordinate(x).is_ok());
        if !usable(v) || !usable(e) || (0..3).all(|k| v.min[k] <= e.max[k] && e.min[k] <= v.max[k]) {
            return false;
        }
        if !self.find_starts(v, e) {
            return false;
        }
        let starts = std::mem::take(&mut self.starts);
        let hides = self.any_hides(v, e, &starts, limit);
        self.starts = starts;
        hides
    }

    /// Number of triangle sides that walks visited so far, in all queries: what targets cost that are not hidden.
    pub fn n_walked(&self) -> u64 {
        self.n_walked
    }

    /// Whether a walk from one of the starts finds a chain that hides.
    #[inline(never)]
    fn any_hides(&mut self, v: &Aabb<3>, e: &Aabb<3>, starts: &[(f64, u32)], limit: usize) -> bool {
        let mut segments = [[[0.0; 3]; 2]; 4];
        for (i, s) in (0..).zip(&mut segments) {
            let Some(inner) = segment(v, e, i) else { return false };
            *s = inner;
        }
        self.next_epoch(2 * starts.len() as u32 + 2);
        let pair = Pair { v, e, shaft: Shaft::new(v, e), since: self.epoch };
        let mut left = limit;
        for &(_, triangle) in starts {
            let [a, b, c] = self.sheets.mesh.corners(triangle);
            let front = orient3d(a, b, c, segments[0][0]) > 0.0;
            for front in [front, !front] {
                let start = Side { triangle, front };
                if self.walked[start.index()] >= pair.since {
                    continue;
                }
                self.epoch += 1;
                self.forked = false;
                if self.walk(&pair, start, &mut left) && self.certifies(&pair, &segments) {
                    return true;
                }
                if left == 0 {
                    return false;
                }
                // If every edge has two triangles, the walks on both sides are the same.
                if !self.forked {
                    break;
                }
            }
        }
        false
    }

    /// Makes room for `n` marks that no query has used.
    fn next_epoch(&mut self, n: u32) {
        if self.epoch > u32::MAX - n - 2 {
            self.walked.fill(0);
            self.codes.fill((0, 0));
            self.epoch = 0;
        }
        self.epoch += 1;
    }

    /// Walks over the surface from a side, within the hull; returns whether the walk ended. The chain then has the
    /// triangles visited on one side only.
    #[inline(never)]
    fn walk(&mut self, pair: &Pair<'_>, start: Side, left: &mut usize) -> bool {
        let sheets = self.sheets;
        self.queue.clear();
        self.queue.push(start);
        self.walked[start.index()] = self.epoch;
        let mut n = 0;
        while let Some(&side) = self.queue.get(n) {
            n += 1;
            if *left == 0 || !self.may_hide(pair, side.triangle) {
                return false;
            }
            *left -= 1;
            self.n_walked += 1;
            for at in 0..sheets.mesh.outline_edges(side.triangle).len() {
                if self.misses(pair, sheets.mesh.outline_edges(side.triangle)[at]) {
                    continue;
                }
                let (mark, from_volume) = (self.volume.1, &mut self.from_volume);
                let is_there = |t: u32| sheets.is_there(pair.v, t, mark, &mut from_volume[t as usize]);
                let (next, passed_any) = sheets.next_side(side, at, is_there);
                self.forked |= passed_any || sheets.around(sheets.mesh.outline_edges(side.triangle)[at]).len() != 2;
                if next == start.other() {
                    self.walked[next.index()] = self.epoch;
                    return false;
                }
                if self.walked[next.index()] != self.epoch {
                    self.walked[next.index()] = self.epoch;
                    self.queue.push(next);
                }
            }
        }
        self.chain.clear();
        let once = |s: &&Side| self.walked[s.other().index()] != self.epoch;
        self.chain.extend(self.queue.iter().filter(once).map(|s| s.triangle));
        true
    }

    /// Condition 1.
    fn may_hide(&mut self, pair: &Pair<'_>, triangle: u32) -> bool {
        self.sheets.may_hide(pair.v, pair.e, triangle, self.volume.1, &mut self.from_volume[triangle as usize])
    }

    /// Whether an edge certainly misses the relative interior of the hull.
    #[inline(never)]
    fn misses(&mut self, pair: &Pair<'_>, edge: u32) -> bool {
        let ends = self.sheets.mesh.edges()[edge as usize];
        let [a, b] = ends.map(|v| self.sheets.mesh.vertices()[v as usize]);
        let [s, t] = ends.map(|v| {
            let (since, code) = self.codes[v as usize];
            if since == pair.since {
                return code;
            }
            let code = pair.shaft.code(self.sheets.mesh.vertices()[v as usize]);
            self.codes[v as usize] = (pair.since, code);
            code
        });
        // An end without a bit is inside.
        s & t != 0 || s != 0 && t != 0 && pair.shaft.certainly_misses(a, b)
    }

    /// Whether the chain satisfies the three conditions, the third with the first of the segments that touches no edge: with the others
    /// it is the same, if the first two are satisfied.
    fn certifies(&mut self, pair: &Pair<'_>, segments: &[[Point3; 2]]) -> bool {
        let mesh = &self.sheets.mesh;
        let chain = std::mem::take(&mut self.chain);
        let n_crossings = |segment: &[Point3; 2]| {
            let mut n = 0u32;
            for &t in &chain {
                n += u32::from(crosses(&self.sheets.boxes[t as usize], mesh.corners(t), segment)?);
            }
            Some(n)
        };
        let is_odd = segments.iter().find_map(n_crossings).is_some_and(|n| n % 2 == 1);
        let certifies = is_odd && chain.iter().all(|&t| self.may_hide(pair, t)) && {
            let edges = || chain.iter().flat_map(|&t| mesh.outline_edges(t).iter().copied());
            edges().for_each(|e| self.odd[e as usize] += 1);
            let closed = edges().all(|e| self.odd[e as usize].is_multiple_of(2) || self.misses(pair, e));
            edges().for_each(|e| self.odd[e as usize] = 0);
            closed
        };
        self.chain = chain;
        certifies
    }
}

impl Sheets {
    /// Whether a triangle may hide something from `v`: it does not touch the inside of `v`, which is before it if it hides from its front only.
    ///
    /// * `mark`: that of the volume
    /// * `known`: the mark of the last volume that was asked about, and the answer in the lowest bit
    fn may_hide_from(&self, v: &Aabb<3>, triangle: u32, mark: u32, known: &mut u32) -> bool {
        if *known >> 1 != mark {
            let faces = || !self.mesh.is_front_only(triangle) || self.mesh.is_in_front(triangle, v);
            *known = mark << 1 | u32::from(avoids(&self.mesh.corners(triangle), v, true) && faces());
        }
        *known & 1 == 1
    }

    /// Whether walks from `v` meet a triangle: those that hide from their front only have to hide something.
    fn is_there(&self, v: &Aabb<3>, triangle: u32, mark: u32, known: &mut u32) -> bool {
        !self.mesh.is_front_only(triangle) || self.may_hide_from(v, triangle, mark, known)
    }

    /// Whether a triangle may hide `e` from `v`: it may hide something, and does not touch `e`.
    fn may_hide(&self, v: &Aabb<3>, e: &Aabb<3>, triangle: u32, mark: u32, known: &mut u32) -> bool {
        let b = &self.boxes[triangle as usize];
        let is_apart = || (0..3).any(|k| b.min[k] > e.max[k] || b.max[k] < e.min[k]);
        if !self.may_hide_from(v, triangle, mark, known) {
            return false;
        }
        let corners = || self.mesh.corners(triangle);
        // Most that touch the target have a corner in common with it.
        is_apart() || !corners().iter().any(|&p| e.contains(p)) && avoids(&corners(), e, false)
    }
}
