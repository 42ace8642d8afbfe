//! The exact method from front to back: what is seen of each portal, in as few convex pieces as possible.
//!
//! Sequence by sequence, what is seen of a portal falls into as many pieces as there are ways for the eye to look
//! at it, and open space that is cut into many cells has many. But pieces that came by different ways often lie
//! side by side, and together are convex again: then they are one piece from there on. For that, all pieces of a portal
//! have to be known before anything behind it is looked at. VisibleSet from a point, the cells of a k-d or BSP tree have an order
//! from front to back; where cells have none, this way gives up.
//!
//! Putting together errs towards visible: the cone of the whole is that of the outer sides. Each of them is a side of both
//! pieces, or every corner of the other piece is inside, or outside by less than a quarter of the tolerance; a quarter more is
//! what a corner may be off, and both are set aside for this ([`crate::side`]). Sides are taken over as they are, so nothing adds
//! up however often it is done.

use super::Scratch;
use super::budget::{CLIP, JOIN, Work};
use super::clip::MOST_CORNERS;
use super::missing::meets;
use super::query::{Query, keep_mirrors};
use crate::epoch_set::EpochSet;
use crate::front::Facing;
use crate::side::{MOST_SIDES, Side, Vector, cross, dot, norm};
use crate::subgraph::{LocalEdge, VisibleSubgraph};
use std::ops::Range;

/// The most pieces that are made for one view before the method gives up.
const MOST_PIECES: usize = 1 << 15;
/// No piece.
const NONE: u32 = u32::MAX;
/// Corners of two pieces this near to each other, as a share of the radius, are the same but for rounding: 2^-40.
/// Decides how many pieces there are, and not what is seen.
const SAME: f64 = 1.0 / (1u64 << 40) as f64;

/// A convex part of a portal that is seen, or of the view at the root.
#[derive(Debug, Clone, Copy)]
struct Piece {
    /// The piece before this one that leads into the same cell.
    next: u32,
    /// The piece before this one that is a part of the same way.
    next_of_way: u32,
    /// Whether it is a part of a later piece now.
    joined: bool,
    /// Corners and sides have the same places in their lists.
    first: u32,
    n_corners: u32,
    n_sides: u32,
}

/// The pieces of a view, and room to make them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pieces {
    planar: bool,
    pieces: Vec<Piece>,
    corners: Vec<Vector>,
    sides: Vec<Side>,
    /// For each cell the last piece that leads into it.
    last: Vec<u32>,
    /// For each way its last piece.
    last_of_way: Vec<u32>,
    /// For each cell the number of ways into it that are to come.
    to_come: Vec<u32>,
    cone: Vec<Side>,
    whole: Part,
    spare: Part,
    /// The ways out of the cell that is looked at.
    ways: Vec<u32>,
    /// Cells that are looked at to the end.
    finished: EpochSet,
}

/// A part of a portal: its corners, and the side along the edge from each.
type Part = (Vec<Vector>, Vec<Side>);

impl Pieces {
    fn clear(&mut self, subgraph: &VisibleSubgraph) {
        let (n_cells, n_ways) = (subgraph.cells.len(), subgraph.ways.len());
        self.planar = subgraph.planar;
        // As much as two parts put together may have; they change places, so both.
        for part in [&mut self.whole, &mut self.spare] {
            part.0.reserve(MOST_CORNERS.saturating_sub(part.0.len()));
            part.1.reserve(MOST_CORNERS.saturating_sub(part.1.len()));
        }
        self.pieces.clear();
        self.corners.clear();
        self.sides.clear();
        self.last.clear();
        self.last.resize(n_cells, NONE);
        self.last_of_way.clear();
        self.last_of_way.resize(n_ways, NONE);
        self.finished.clear(n_cells);
        self.to_come.clear();
        self.to_come.resize(n_cells, 0);
    }

    fn range(&self, piece: &Piece, n: u32) -> Range<usize> {
        piece.first as usize..(piece.first + n) as usize
    }

    /// Adds a piece that leads into `cell`.
    fn push(&mut self, cell: u32, way: u32, corners: &[Vector], sides: &[Side]) {
        let first = self.sides.len().max(self.corners.len()) as u32;
        self.corners.resize(first as usize, [0.0; 3]);
        self.corners.extend_from_slice(corners);
        self.sides.truncate(first as usize);
        if let Some(&filler) = sides.first() {
            self.sides.resize(first as usize, filler);
        }
        self.sides.extend_from_slice(sides);
        let this = self.pieces.len() as u32;
        let next = std::mem::replace(&mut self.last[cell as usize], this);
        let next_of_way = match way {
            NONE => NONE,
            _ => std::mem::replace(&mut self.last_of_way[way as usize], this),
        };
        let (n_corners, n_sides) = (corners.len() as u32, sides.len() as u32);
        self.pieces.push(Piece { next, next_of_way, joined: false, first, n_corners, n_sides });
    }

    /// Adds a piece of a way into `cell`, put together with others of the way as long as that is convex.
    fn add(&mut self, (cell, way): (u32, u32), corners: &[Vector], sides: &[Side], same: f64, work: &mut Work) {
        let (mut whole, mut spare) = (std::mem::take(&mut self.whole), std::mem::take(&mut self.spare));
        whole.0.clear();
        if self.planar {
            whole.0.extend_from_slice(corners);
        } else if corners.len() == sides.len() {
            let before = |i: usize| &sides[if i == 0 { sides.len() - 1 } else { i - 1 }];
            whole.0.extend((0..corners.len()).map(|i| sharpened(corners[i], before(i), &sides[i])));
        }
        whole.1.clear();
        whole.1.extend_from_slice(sides);
        let mut at = self.last_of_way[way as usize];
        while at != NONE {
            let piece = self.pieces[at as usize];
            work.take(JOIN);
            if !piece.joined && self.join(&piece, &whole, &mut spare, same) {
                self.pieces[at as usize].joined = true;
                std::mem::swap(&mut whole, &mut spare);
                // What did not fit before may fit now.
                at = self.last_of_way[way as usize];
            } else {
                at = piece.next_of_way;
            }
        }
        self.push(cell, way, &whole.0, &whole.1);
        (self.whole, self.spare) = (whole, spare);
    }

    /// Puts `piece` and `whole` together into `joined`, if they share an edge and are convex together.
    fn join(&self, piece: &Piece, whole: &Part, joined: &mut Part, same: f64) -> bool {
        let (p, ps) =
            (&self.corners[self.range(piece, piece.n_corners)], &self.sides[self.range(piece, piece.n_sides)]);
        let (q, qs) = (&whole.0[..], &whole.1[..]);
        let (n, m) = (p.len(), q.len());
        if ps.len() != n || qs.len() != m || n + m > MOST_SIDES {
            return false;
        }
        if self.planar {
            return join_segments(p, ps, whole, joined, same);
        }
        let Some((i, j)) = shared_edge(p, q, same) else { return false };
        let within = |sides: &[Side], but: usize, corners: &[Vector], own: &[Side]| {
            sides.iter().enumerate().all(|(k, side)| {
                k == but || own.contains(side) || corners.iter().all(|&c| side.nearly_keeps(side.value(c)))
            })
        };
        if !within(ps, i, q, qs) || !within(qs, j, p, ps) {
            return false;
        }
        // The first corner of the other's first outer edge is the end of the shared edge.
        let edges = (1..n).map(|k| (i + k) % n).map(|k| (p[k], ps[k]));
        let edges = edges.chain((1..m).map(|k| (j + k) % m).map(|k| (q[k], qs[k])));
        joined.0.clear();
        joined.1.clear();
        for (corner, side) in edges {
            // Between two edges along the same side there is no corner.
            if joined.1.last() != Some(&side) {
                joined.0.push(corner);
                joined.1.push(side);
            }
        }
        if joined.1.len() > 1 && joined.1.first() == joined.1.last() {
            joined.0.remove(0);
            joined.1.remove(0);
        }
        true
    }
}

/// Puts two parts of a segment together, if one begins where the other ends: the outer ends with their sides.
fn join_segments(p: &[Vector], ps: &[Side], whole: &Part, joined: &mut Part, same: f64) -> bool {
    let (&[p_left, p_right], &[q_left, q_right]) = (p, &whole.0[..]) else { return false };
    let (&[ps_left, ps_right], &[qs_left, qs_right]) = (ps, &whole.1[..]) else { return false };
    joined.0.clear();
    joined.1.clear();
    if close(&p_right, &q_left, same) {
        joined.0.extend([p_left, q_right]);
        joined.1.extend([ps_left, qs_right]);
    } else if close(&q_right, &p_left, same) {
        joined.0.extend([q_left, p_right]);
        joined.1.extend([qs_left, ps_right]);
    }
    !joined.0.is_empty()
}

/// Whether two corners are the same but for rounding.
#[inline]
fn close(a: &Vector, b: &Vector, same: f64) -> bool {
    (a[0] - b[0]).abs() <= same && (a[1] - b[1]).abs() <= same && (a[2] - b[2]).abs() <= same
}

/// The corner where two sides meet, from a corner that was clipped where their borders are drawn, which is a tolerance
/// outside.
///
/// It is on the ray along both sides, their cross product. Each normal is off by 5 u of its size (|v|₁ |E|₁, which may be much
/// more than its length, if the eye is nearly in line with the edge), so the product is off by 13 u of both sizes
/// multiplied. If it is at least an eighth of that itself, then its direction is off by no more than 13 × 8 × √3 u, below 181 u,
/// and with it the value of any side at the corner, as a share of the side's measure. Otherwise the corner stays as it is, which
/// contains what is seen.
fn sharpened(corner: Vector, before: &Side, after: &Side) -> Vector {
    let ray = cross(before.normal(), after.normal());
    if norm(ray) * 8.0 < before.size() * after.size() {
        return corner;
    }
    let scale = dot(ray, corner) / dot(ray, ray);
    let sharp = ray.map(|x| x * scale);
    if sharp.iter().all(|x| x.is_finite()) { sharp } else { corner }
}

/// An edge of `p` and one of `q` that are the same the other way round, within `same`: the places where they begin.
#[inline]
fn shared_edge(p: &[Vector], q: &[Vector], same: f64) -> Option<(usize, usize)> {
    for (i, a) in p.iter().enumerate() {
        for (j, b) in q.iter().enumerate() {
            // The edge of q before its corner j ends there.
            let before = if j == 0 { q.len() - 1 } else { j - 1 };
            let after = if i + 1 == p.len() { 0 } else { i + 1 };
            if close(a, b, same) && close(&p[after], &q[before], same) {
                return Some((i, before));
            }
        }
    }
    None
}

/// Keeps what a line from the eye leads to among the wanted cells; `false` if there is no order from front to back,
/// or too many pieces, or too much work. What was kept until then is right.
pub(super) fn sweep(query: &mut Query<'_>) -> bool {
    sweep_within(query, MOST_PIECES)
}

/// The same with another limit on the number of pieces: more than that are never passed on from a cell.
pub(super) fn sweep_within(query: &mut Query<'_>, most: usize) -> bool {
    let subgraph = query.subgraph;
    let mut pieces = std::mem::take(&mut query.scratch.pieces);
    pieces.clear(subgraph);
    let done = Sweep { query, pieces: &mut pieces, most }.run();
    query.scratch.pieces = pieces;
    done
}

/// After a sweep that came to no end: keeps the cells that it has not finished and that its pieces lead to by ways in view, with all that
/// the view may meet of them.
///
/// Errs towards visible. A cell is finished after all cells that lead into it, so a line from the eye that has left the finished
/// cells does not come back to them. It leaves them through a portal with a piece, as no cone is dropped that meets anything not found yet.
pub(super) fn keep_unfinished(query: &mut Query<'_>) {
    let mut pieces = std::mem::take(&mut query.scratch.pieces);
    let most = pieces.pieces.len();
    Sweep { query, pieces: &mut pieces, most }.keep_unfinished();
    query.scratch.pieces = pieces;
}

struct Sweep<'q, 'a> {
    query: &'q mut Query<'a>,
    pieces: &'q mut Pieces,
    /// The most pieces.
    most: usize,
}

impl Sweep<'_, '_> {
    fn run(&mut self) -> bool {
        let subgraph = self.query.subgraph;
        let n_wanted = self.query.scratch.wanted.list().len();
        for k in 0..n_wanted {
            let cell = self.query.scratch.wanted.list()[k];
            for way in subgraph.ways_of(cell) {
                if self.leads_on(way) {
                    self.pieces.to_come[subgraph.ways[way as usize].to as usize] += 1;
                }
            }
        }
        let view = std::mem::take(&mut self.query.scratch.view);
        self.pieces.push(subgraph.root, NONE, &[], &view);
        self.query.scratch.view = view;
        // Cells that nothing leads into any more; the root may be led into only where cells have no order.
        let mut ready = std::mem::take(&mut self.query.scratch.pending);
        ready.clear();
        let all = self.query.scratch.wanted.list();
        ready.extend(all.iter().copied().filter(|&cell| self.pieces.to_come[cell as usize] == 0));
        while let Some(cell) = ready.pop() {
            if self.pieces.pieces.len() > self.most || self.query.scratch.work.is_spent() {
                break;
            }
            let n_reflections = self.query.seen.reflections.len();
            if !self.visit(cell) {
                // The cell is looked at anew, as a whole.
                self.query.seen.reflections.truncate(n_reflections);
                break;
            }
            self.pieces.finished.add(cell);
            for way in subgraph.ways_of(cell) {
                if self.leads_on(way) {
                    let to = subgraph.ways[way as usize].to;
                    self.pieces.to_come[to as usize] -= 1;
                    if self.pieces.to_come[to as usize] == 0 {
                        ready.push(to);
                    }
                }
            }
        }
        self.query.scratch.pending = ready;
        self.pieces.finished.list().len() == n_wanted
    }

    /// See [`keep_unfinished`].
    fn keep_unfinished(&mut self) {
        let subgraph = self.query.subgraph;
        let mut pending = std::mem::take(&mut self.query.scratch.pending);
        pending.clear();
        self.query.scratch.reached.clear(subgraph.cells.len());
        for k in 0..self.query.scratch.wanted.list().len() {
            let cell = self.query.scratch.wanted.list()[k];
            if self.pieces.last[cell as usize] != NONE && !self.pieces.finished.has(cell) {
                self.query.scratch.reached.add(cell);
                pending.push(cell);
            }
        }
        while let Some(cell) = pending.pop() {
            self.query.keep(cell);
            for way in subgraph.ways_of(cell) {
                let to = subgraph.ways[way as usize].to;
                if !self.pieces.finished.has(to) && self.leads_on(way) && self.query.scratch.reached.add(to) {
                    pending.push(to);
                }
            }
        }
        self.query.scratch.pending = pending;
    }

    /// Whether lines from the eye may go by this way, into a cell that is wanted.
    fn leads_on(&mut self, way: u32) -> bool {
        let to = self.query.subgraph.ways[way as usize].to;
        to != self.query.subgraph.root && self.query.scratch.wanted.has(to) && self.query.way_in_view(way)
    }

    /// Keeps a cell with what its pieces meet there, and sends them on; `false` if the work was spent before the end.
    fn visit(&mut self, cell: u32) -> bool {
        let mut at = self.pieces.last[cell as usize];
        if at == NONE {
            return true;
        }
        let subgraph = self.query.subgraph;
        self.query.seen.add_cell(subgraph.cells[cell as usize]);
        let (mut ways, mut cone) = (std::mem::take(&mut self.pieces.ways), std::mem::take(&mut self.pieces.cone));
        ways.clear();
        ways.extend(subgraph.ways_of(cell).filter(|&way| self.leads_on(way)));
        while at != NONE {
            let piece = self.pieces.pieces[at as usize];
            if !piece.joined {
                cone.clear();
                cone.extend_from_slice(&self.pieces.sides[self.pieces.range(&piece, piece.n_sides)]);
                self.query.keep_objects_in(cell, &cone);
                keep_mirrors(self.query, cell, &cone);
                for &way in &ways {
                    self.send(way, &cone);
                }
                if self.query.scratch.work.is_spent() {
                    break;
                }
            }
            at = piece.next;
        }
        (self.pieces.ways, self.pieces.cone) = (ways, cone);
        at == NONE
    }

    fn send(&mut self, index: u32, cone: &[Side]) {
        let eye = self.query.eye();
        let Query { subgraph, view, scratch, seen, .. } = &mut *self.query;
        let LocalEdge { to, first_corner, n_corners, front, .. } = subgraph.ways[index as usize];
        scratch.n_steps += 1;
        scratch.work.take(CLIP);
        let corners = subgraph.corners(first_corner, n_corners);
        match front.facing(corners, view.eye, view.slack) {
            Facing::Behind => {}
            Facing::Before if n_corners as usize <= MOST_SIDES => {
                scratch.cone.clear();
                let Scratch { clipper, cone: narrowed, missing, work, .. } = &mut **scratch;
                if let Some(part) = clipper.narrow_part(eye, corners, cone, narrowed)
                    && meets(missing, work, narrowed, subgraph, view, seen)
                {
                    self.pieces.add((to, index), part, narrowed, eye.reach.radius * SAME, work);
                }
            }
            // The portal does not narrow the cone; without corners it is never put together with others.
            _ => self.pieces.push(to, index, &[], cone),
        }
    }
}
