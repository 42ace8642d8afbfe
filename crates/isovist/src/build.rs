//! Making the mesh: a triangulation of the ends of walls, into which the walls are put one by one.
//!
//! The Delaunay triangulation of the ends comes from `spade`. Walls are put in here, because where two walls cross, the mesh
//! needs a corner that doubles may not represent. A wall that meets an earlier one splits its edge at the exact crossing,
//! which keeps all triangles proper whatever the crossing's coordinates; edges across a wall are flipped away as by Sloan, "A
//! fast algorithm for generating constrained Delaunay triangulations", Computers & Structures 47, 1993. All decisions are
//! exact.

use crate::MeshError;
use crate::corner::{Corner, exact_of, orient_exact, orient_filter};
use crate::delaunay::delaunay;
use crate::edge::{Edge, NONE, around, next, previous};
use sightlines_geometry::{Aabb, Point2, Segment2, orient2d};
use std::collections::VecDeque;

/// The mesh while it is made.
#[derive(Debug)]
pub(crate) struct Builder {
    corners: Vec<Corner>,
    crossings: Vec<[Segment2; 2]>,
    /// The walls of each crossing, by their place in the list of walls.
    crossed: Vec<[u32; 2]>,
    edges: Vec<Edge>,
    /// Place in the list of walls of the wall along each edge; [`NONE`] if there is none.
    wall_of: Vec<u32>,
    /// An edge that leaves each corner.
    leaving: Vec<u32>,
}

/// What a wall reaches next from a corner.
enum Reached {
    /// A corner that lies on it, past these edges.
    Corner(u32),
    /// An edge along another wall, inside of both.
    Wall(u32),
}

impl Builder {
    /// Triangulates the frame with all walls; each comes with its line of the plan.
    pub(crate) fn new(walls: &[(Segment2, u32)], frame: &Aabb<2>) -> Result<Self, MeshError> {
        let [x, y] = [0, 1].map(|k| [frame.min[k], frame.max[k]]);
        let around = x.into_iter().flat_map(|x| y.map(|y| Point2::new(x, y)));
        let mut points: Vec<Point2> = walls.iter().flat_map(|(s, _)| [s.a, s.b]).chain(around).collect();
        let order = |p: &Point2, q: &Point2| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y));
        points.sort_by(order);
        points.dedup();
        let (edges, leaving) = delaunay(&points)?;
        let corners = points.iter().copied().map(Corner::exact).collect();
        let wall_of = vec![NONE; edges.len()];
        let mut builder = Self { corners, crossings: Vec::new(), crossed: Vec::new(), edges, wall_of, leaving };
        let index =
            |p: &Point2| points.binary_search_by(|q| order(q, p)).expect("every end is among the points") as u32;
        for (wall, (s, _)) in walls.iter().enumerate() {
            builder.insert(walls, wall as u32, index(&s.a), index(&s.b));
        }
        builder.improve();
        for (edge, &wall) in builder.edges.iter_mut().zip(&builder.wall_of) {
            edge.wall = if wall == NONE { NONE } else { walls[wall as usize].1 };
        }
        Ok(builder)
    }

    /// Puts a wall between two corners into the mesh.
    fn insert(&mut self, walls: &[(Segment2, u32)], wall: u32, from: u32, to: u32) {
        let segment = walls[wall as usize].0;
        let mut at = from;
        let mut across = Vec::new();
        while at != to {
            across.clear();
            let reached = match self.reach(&segment, wall, at, &mut across) {
                Reached::Corner(corner) => corner,
                Reached::Wall(edge) => {
                    let other = self.wall_of[edge as usize];
                    self.split(edge, [walls[other as usize].0, segment], [other, wall])
                }
            };
            self.clear_between(&segment, wall, at, reached, &across);
            let edge = self.edge_between(at, reached).expect("the way between the corners has been cleared");
            for edge in [edge, self.edges[edge as usize].twin] {
                if edge != NONE && self.wall_of[edge as usize] == NONE {
                    self.wall_of[edge as usize] = wall;
                }
            }
            at = reached;
        }
    }

    /// The side of a corner of a wall's line, 0 for one of its own.
    fn side(&self, segment: &Segment2, wall: u32, corner: u32) -> f64 {
        let c = self.corners[corner as usize];
        if let Some(side) = orient_filter(Corner::exact(segment.a), Corner::exact(segment.b), c) {
            return side;
        }
        if c.reach == 0.0 {
            return orient2d(segment.a, segment.b, c.at);
        }
        if self.crossed[corner as usize - (self.corners.len() - self.crossings.len())].contains(&wall) {
            return 0.0;
        }
        let ends = [segment.a, segment.b].map(crate::corner::Exact::Point);
        orient_exact(ends[0], ends[1], exact_of(&self.corners, &self.crossings, corner))
    }

    /// Follows a wall from one of its corners to what it reaches next, and lists the edges on the way, as pairs of corners to
    /// the right and to the left.
    fn reach(&self, segment: &Segment2, wall: u32, at: u32, across: &mut Vec<[u32; 2]>) -> Reached {
        let (mut edge, mut sides) = match self.first_across(segment, wall, at) {
            Ok(found) => found,
            Err(corner) => return Reached::Corner(corner),
        };
        loop {
            if self.wall_of[edge as usize] != NONE {
                return Reached::Wall(edge);
            }
            across.push(sides);
            let twin = self.edges[edge as usize].twin;
            debug_assert_ne!(twin, NONE, "walls stay inside the frame");
            // In the next triangle the edge runs from the left to the right.
            let (rest, apex) = (next(twin), previous(twin));
            let corner = self.edges[apex as usize].from;
            let side = self.side(segment, wall, corner);
            if side == 0.0 {
                return Reached::Corner(corner);
            }
            (edge, sides) = if side > 0.0 { (rest, [sides[0], corner]) } else { (apex, [corner, sides[1]]) };
        }
    }

    /// The edge opposite a corner that a wall crosses when it leaves the corner, and its ends to the right and to the left; or the
    /// corner that the wall runs to along an edge.
    fn first_across(&self, segment: &Segment2, wall: u32, at: u32) -> Result<(u32, [u32; 2]), u32> {
        let direction = segment.b - segment.a;
        let ahead = |corner: u32| {
            let (from, to) = (self.corners[at as usize].at, self.corners[corner as usize].at);
            let reach = self.corners[at as usize].reach + self.corners[corner as usize].reach;
            let far = (to - from).dot(direction);
            // Both are on the wall's line; only its order is asked for.
            if far.abs() > 4.0 * reach * (direction.x.abs() + direction.y.abs()) {
                far > 0.0
            } else {
                self.is_ahead(segment, at, corner)
            }
        };
        for out in self.leaving(at) {
            let (right, left) = (self.edges[next(out) as usize].from, self.edges[previous(out) as usize].from);
            let (side_right, side_left) = (self.side(segment, wall, right), self.side(segment, wall, left));
            for (side, corner) in [(side_right, right), (side_left, left)] {
                if side == 0.0 && ahead(corner) {
                    return Err(corner);
                }
            }
            if side_right < 0.0 && side_left > 0.0 {
                return Ok((next(out), [right, left]));
            }
        }
        unreachable!("a wall leaves each of its corners into a triangle of the mesh")
    }

    /// Whether `corner` lies ahead of `at` along a wall on whose line both are. Exact.
    fn is_ahead(&self, segment: &Segment2, at: u32, corner: u32) -> bool {
        let all = [at, corner].map(|c| exact_of(&self.corners, &self.crossings, c));
        let [(px, py), (qx, qy)] = all.map(crate::corner::fractions);
        let order = |p, q, from: f64, to: f64| if from < to { p < q } else { q < p };
        if segment.a.x != segment.b.x {
            order(px, qx, segment.a.x, segment.b.x)
        } else {
            order(py, qy, segment.a.y, segment.b.y)
        }
    }

    /// The edges that leave a corner, one for each triangle around it.
    fn leaving(&self, corner: u32) -> impl Iterator<Item = u32> + '_ {
        around(&self.edges, self.leaving[corner as usize])
    }

    fn edge_between(&self, from: u32, to: u32) -> Option<u32> {
        self.leaving(from).find_map(|out| {
            if self.edges[next(out) as usize].from == to {
                return Some(out);
            }
            let into = previous(out);
            (self.edges[into as usize].from == to).then_some(into)
        })
    }

    /// Flips edges until one joins two corners on a wall between which no wall and no corner lies.
    fn clear_between(&mut self, segment: &Segment2, wall: u32, from: u32, to: u32, across: &[[u32; 2]]) {
        let mut across: VecDeque<[u32; 2]> = across.iter().copied().collect();
        while let Some([u, v]) = across.pop_front() {
            let edge = self.edge_between(u, v).expect("edges in the way stay until they are flipped");
            // The same edge from the side of its start.
            let twin = self.edges[edge as usize].twin;
            let (r, s) = (self.edges[previous(edge) as usize].from, self.edges[previous(twin) as usize].from);
            if !self.is_convex(edge) {
                across.push_back([u, v]);
                continue;
            }
            self.flip(edge);
            let ends = [r, s];
            if ends.contains(&from) || ends.contains(&to) {
                continue;
            }
            let sides = ends.map(|corner| self.side(segment, wall, corner) > 0.0);
            if sides[0] != sides[1] {
                across.push_back(ends);
            }
        }
    }

    fn orient(&self, a: u32, b: u32, c: u32) -> f64 {
        let corner = |i: u32| self.corners[i as usize];
        if let Some(side) = orient_filter(corner(a), corner(b), corner(c)) {
            return side;
        }
        let [a, b, c] = [a, b, c].map(|i| exact_of(&self.corners, &self.crossings, i));
        orient_exact(a, b, c)
    }

    /// Whether the two triangles at an edge form a strictly convex quadrilateral.
    fn is_convex(&self, edge: u32) -> bool {
        let twin = self.edges[edge as usize].twin;
        let (p, q) = (self.edges[edge as usize].from, self.edges[twin as usize].from);
        let (r, s) = (self.edges[previous(edge) as usize].from, self.edges[previous(twin) as usize].from);
        self.orient(s, r, p) > 0.0 && self.orient(s, r, q) < 0.0
    }

    fn set(&mut self, edge: u32, from: u32, (twin, wall): (u32, u32)) {
        self.edges[edge as usize].from = from;
        self.leaving[from as usize] = edge;
        self.wall_of[edge as usize] = wall;
        self.link(edge, twin);
    }

    fn link(&mut self, edge: u32, twin: u32) {
        self.edges[edge as usize].twin = twin;
        if twin != NONE {
            self.edges[twin as usize].twin = edge;
        }
    }

    /// The other side of an edge, and the wall along it.
    fn outer(&self, edge: u32) -> (u32, u32) {
        (self.edges[edge as usize].twin, self.wall_of[edge as usize])
    }

    /// Replaces an edge between two triangles by the other diagonal of their quadrilateral.
    fn flip(&mut self, edge: u32) {
        let twin = self.edges[edge as usize].twin;
        let [e1, e2, f1, f2] = [next(edge), previous(edge), next(twin), previous(twin)];
        let (p, q) = (self.edges[edge as usize].from, self.edges[twin as usize].from);
        let (r, s) = (self.edges[e2 as usize].from, self.edges[f2 as usize].from);
        let [qr, rp, ps, sq] = [e1, e2, f1, f2].map(|e| self.outer(e));
        let (t, u) = (edge / 3 * 3, twin / 3 * 3);
        self.set(t, p, ps);
        self.set(t + 1, s, (u + 2, NONE));
        self.set(t + 2, r, rp);
        self.set(u, s, sq);
        self.set(u + 1, q, qr);
        self.set(u + 2, r, (t + 1, NONE));
    }

    /// Makes a corner where a wall crosses an edge along another one.
    fn split(&mut self, edge: u32, walls: [Segment2; 2], crossed: [u32; 2]) -> u32 {
        let x = self.corners.len() as u32;
        self.corners.push(Corner::crossing(walls[0], walls[1]));
        self.crossings.push(walls);
        self.crossed.push(crossed);
        self.leaving.push(NONE);
        let twin = self.edges[edge as usize].twin;
        let [e1, e2, f1, f2] = [next(edge), previous(edge), next(twin), previous(twin)];
        let (p, q) = (self.edges[edge as usize].from, self.edges[twin as usize].from);
        let (r, s) = (self.edges[e2 as usize].from, self.edges[f2 as usize].from);
        let [qr, rp, ps, sq] = [e1, e2, f1, f2].map(|e| self.outer(e));
        let along = self.wall_of[edge as usize];
        let (t, u) = (edge / 3 * 3, twin / 3 * 3);
        let n = self.edges.len() as u32;
        self.edges.extend([Edge { from: x, twin: NONE, wall: NONE }; 6]);
        self.wall_of.extend([NONE; 6]);
        // p x r, x q r on the left of the edge; q x s, x p s on its right.
        let (pxr, xqr, qxs, xps) = (t, n, u, n + 3);
        self.set(pxr, p, (NONE, along));
        self.set(pxr + 1, x, (NONE, NONE));
        self.set(pxr + 2, r, rp);
        self.set(xqr, x, (NONE, along));
        self.set(xqr + 1, q, qr);
        self.set(xqr + 2, r, (NONE, NONE));
        self.set(qxs, q, (NONE, along));
        self.set(qxs + 1, x, (NONE, NONE));
        self.set(qxs + 2, s, sq);
        self.set(xps, x, (NONE, along));
        self.set(xps + 1, p, ps);
        self.set(xps + 2, s, (NONE, NONE));
        self.link(pxr, xps);
        self.link(xqr, qxs);
        self.link(pxr + 1, xqr + 2);
        self.link(qxs + 1, xps + 2);
        x
    }

    /// Flips edges that are not along walls towards a Delaunay triangulation. What is gained is speed, so plain doubles choose
    /// them; that a flip is possible is decided exactly.
    fn improve(&mut self) {
        let mut left = 8 * self.edges.len();
        let mut stack: Vec<u32> = (0..self.edges.len() as u32).collect();
        while let (Some(edge), true) = (stack.pop(), left > 0) {
            let twin = self.edges[edge as usize].twin;
            if twin == NONE || self.wall_of[edge as usize] != NONE {
                continue;
            }
            let at = |e: u32| self.corners[self.edges[e as usize].from as usize].at;
            let (p, q, r, s) = (at(edge), at(twin), at(previous(edge)), at(previous(twin)));
            if !in_circle(p, q, r, s) || !self.is_convex(edge) {
                continue;
            }
            self.flip(edge);
            left -= 1;
            let (t, u) = (edge / 3 * 3, twin / 3 * 3);
            stack.extend([t, t + 2, u, u + 1]);
        }
    }

    /// Corners, crossings and edges; triangles that are near each other have numbers near each other.
    pub(crate) fn finish(self) -> (Vec<Corner>, Vec<[Segment2; 2]>, Vec<Edge>) {
        let bounds = Aabb::around(self.corners.iter().map(|c| [c.at.x, c.at.y]));
        let key = |triangle: &u32| {
            let middle =
                (0..3).map(|k| self.corners[self.edges[(3 * triangle + k) as usize].from as usize].at).sum::<Point2>();
            let cell = |k: usize| {
                let (min, max) = (bounds.min[k], bounds.max[k]);
                ((middle[k] / 3.0 - min) / (max - min) * 65535.0) as u16
            };
            interleaved(cell(0)) | interleaved(cell(1)) << 1
        };
        let mut order: Vec<u32> = (0..self.edges.len() as u32 / 3).collect();
        order.sort_by_key(|triangle| (key(triangle), *triangle));
        let mut place = vec![0u32; order.len()];
        for (new, &old) in (0u32..).zip(&order) {
            place[old as usize] = new;
        }
        let renamed = |twin: u32| if twin == NONE { NONE } else { 3 * place[twin as usize / 3] + twin % 3 };
        let moved = |&old: &u32| (0..3).map(move |k| (3 * old + k) as usize);
        let edges = order.iter().flat_map(moved).map(|e| Edge { twin: renamed(self.edges[e].twin), ..self.edges[e] });
        let edges = edges.collect();
        (self.corners, self.crossings, edges)
    }
}

/// Whether `s` is clearly inside the circle through p, q and r, which run counter-clockwise.
fn in_circle(p: Point2, q: Point2, r: Point2, s: Point2) -> bool {
    let (a, b, c) = (p - s, q - s, r - s);
    let minors =
        [a.length_squared() * b.perp_dot(c), b.length_squared() * c.perp_dot(a), c.length_squared() * a.perp_dot(b)];
    let sum: f64 = minors.iter().sum();
    let size: f64 = minors.iter().map(|x| x.abs()).sum();
    sum > 1e-10 * size
}

/// The bits of a number with a zero between each two.
fn interleaved(x: u16) -> u32 {
    let mut x = u32::from(x);
    for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
        x = (x | x << shift) & mask;
    }
    x
}
