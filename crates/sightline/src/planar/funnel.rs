//! The planar funnel: which lines pass a sequence of doors, kept up to date door by door.
//!
//! # Method
//! The lines that pass all doors so far form a convex polygon in line space. Its vertices are lines
//! through end points of doors: the most clockwise one, from the first left point to the last right
//! point; the most counter-clockwise one, from the first right point to the last left point; and the
//! edges of two convex chains between, one of left ends and one of right ends, both ordered from near
//! to far. Doors come from a chain of convex cells, so a new end point lies beyond all others. Over all
//! passing lines its distance to the line is then smallest at one of the two extreme lines and largest
//! at the other: one orientation test decides whether any line passes, the other whether the point matters. It removes
//! a run at the end of one chain and at the front of the other.
//!
//! # Ties
//! Doors are open. A new left end that lies exactly on the most clockwise line closes the funnel only
//! if it lies at the last right end or beyond: before that, the line can still turn about the points
//! that hold it. Treating every tie as closed loses open sets of lines.
//!
//! # Cost
//! A push costs four orientation tests and what it removes from the chains, which is at most what
//! earlier pushes added; an undo restores two lengths, two fronts and two slots.
//!
//! # Source
//! The funnel of Lee and Preparata, Networks 14, 1984, generalised from a point to a door (the
//! hourglass of Guibas and Hershberger, J. Comput. Syst. Sci. 39, 1989); proof of the two tests in
//! the project's notes on planar stabbing, restated above.

use super::{PlanarCertificate, PlanarVerdict, PlanarWitness, decide};
use crate::stabber::Stabber;
use sightlines_geometry::{Aabb, Orient2d, Point2, Portal2, along};
use std::convert::Infallible;

/// End points, near to far; the live part is `points[front..back]`.
#[derive(Debug, Clone)]
struct Chain {
    points: Vec<Point2>,
    front: usize,
    back: usize,
}

impl Chain {
    fn new() -> Self {
        Self { points: vec![Point2::ZERO; 64], front: 0, back: 0 }
    }

    fn start(&mut self, p: Point2) {
        (self.front, self.back) = (0, 1);
        self.points[0] = p;
    }

    #[inline(always)]
    fn first(&self) -> Point2 {
        self.points[self.front]
    }

    #[inline(always)]
    fn last(&self) -> Point2 {
        self.points[self.back - 1]
    }

    fn live(&self) -> &[Point2] {
        &self.points[self.front..self.back]
    }
}

/// How to undo one end point.
#[derive(Debug, Clone, Copy)]
struct EndUndo {
    back: u32,
    front: u32,
    slot: Point2,
}

/// How to undo one push: what changed on the left and on the right, if anything.
#[derive(Debug, Clone, Copy)]
pub struct FunnelUndo {
    left: Option<EndUndo>,
    right: Option<EndUndo>,
}

/// The lines that pass a sequence of doors in the plane. See the [module](self).
#[derive(Debug, Clone)]
pub struct Funnel<O> {
    orient: O,
    left: Chain,
    right: Chain,
}

/// Adds `q` to the chain `own`; `sign` is 1 for left ends and -1 for right ends, whose picture is the
/// mirror image. `None` if no line remains, `Some(None)` if `q` changes nothing.
#[inline(always)]
fn push_end<O: Orient2d>(
    orient: O,
    sign: f64,
    own: &mut Chain,
    other: &mut Chain,
    q: Point2,
) -> Option<Option<EndUndo>> {
    let side = |a: Point2, b: Point2, c: Point2| sign * orient.orient(a, b, c);
    if side(other.first(), own.last(), q) >= 0.0 {
        return Some(None);
    }
    let (first, last) = (own.first(), other.last());
    let beyond_limit = side(first, last, q);
    if beyond_limit < 0.0 || (beyond_limit == 0.0 && along(first, last, q)) {
        return None;
    }
    let mut back = own.back;
    while back - own.front >= 2 && side(own.points[back - 2], own.points[back - 1], q) <= 0.0 {
        back -= 1;
    }
    let mut front = other.front;
    while other.back - front >= 2 && side(other.points[front], other.points[front + 1], q) <= 0.0 {
        front += 1;
    }
    if back == own.points.len() {
        own.points.resize(2 * back, Point2::ZERO);
    }
    let undo = EndUndo { back: own.back as u32, front: other.front as u32, slot: own.points[back] };
    own.points[back] = q;
    own.back = back + 1;
    other.front = front;
    Some(Some(undo))
}

#[inline(always)]
fn undo_end(own: &mut Chain, other: &mut Chain, undo: EndUndo) {
    own.points[own.back - 1] = undo.slot;
    own.back = undo.back as usize;
    other.front = undo.front as usize;
}

impl<O: Orient2d> Funnel<O> {
    /// An empty funnel that decides with `orient`.
    pub fn new(orient: O) -> Self {
        Self { orient, left: Chain::new(), right: Chain::new() }
    }

    /// Resets to the lines through one door, which has two different ends.
    #[inline]
    pub fn start(&mut self, portal: Portal2) {
        self.left.start(portal.left);
        self.right.start(portal.right);
    }

    /// Adds a door beyond all others; `None` and no change if no open set of lines passes it as well.
    ///
    /// # Panics
    /// May panic if nothing was started.
    #[inline]
    pub fn push(&mut self, portal: Portal2) -> Option<FunnelUndo> {
        let left = push_end(self.orient, 1.0, &mut self.left, &mut self.right, portal.left)?;
        match push_end(self.orient, -1.0, &mut self.right, &mut self.left, portal.right) {
            Some(right) => Some(FunnelUndo { left, right }),
            None => {
                if let Some(undo) = left {
                    undo_end(&mut self.left, &mut self.right, undo);
                }
                None
            }
        }
    }

    /// Undoes the latest push that is not undone yet. O(1).
    #[inline]
    pub fn undo(&mut self, undo: FunnelUndo) {
        if let Some(right) = undo.right {
            undo_end(&mut self.right, &mut self.left, right);
        }
        if let Some(left) = undo.left {
            undo_end(&mut self.left, &mut self.right, left);
        }
    }

    /// The most clockwise line: through the first left and the last right end. A limit, not a member.
    pub fn clockwise_limit(&self) -> (Point2, Point2) {
        (self.left.first(), self.right.last())
    }

    /// The most counter-clockwise line: through the first right and the last left end. A limit, not a
    /// member.
    pub fn counter_clockwise_limit(&self) -> (Point2, Point2) {
        (self.right.first(), self.left.last())
    }

    /// Number of end points that hold the lines in place: the cost of a witness.
    pub fn n_live(&self) -> usize {
        self.left.live().len() + self.right.live().len()
    }

    /// A line that passes every door of the sequence, strictly. Exact; O(length of the chains).
    ///
    /// # Panics
    /// If nothing was started.
    pub fn witness(&self) -> PlanarWitness {
        let (left, right) = (self.left.live(), self.right.live());
        let limits = [self.clockwise_limit(), self.counter_clockwise_limit()];
        let edges = [left, right].into_iter().flat_map(|c| c.windows(2).map(|w| (w[0], w[1])));
        if left.len() == 1 && right.len() == 1 {
            return PlanarWitness::across(Portal2 { left: left[0], right: right[0] });
        }
        PlanarWitness::inside(limits.into_iter().chain(edges))
    }
}

impl<O: Orient2d> Stabber for Funnel<O> {
    type Portal = Portal2;
    type Bounds = Aabb<2>;
    type Undo = FunnelUndo;
    type Line = PlanarWitness;
    type Proof = PlanarCertificate;
    type Doubt = Infallible;

    #[inline]
    fn start(&mut self, portal: Portal2) {
        Self::start(self, portal);
    }

    #[inline]
    fn push(&mut self, portal: Portal2) -> Option<FunnelUndo> {
        Self::push(self, portal)
    }

    #[inline]
    fn undo(&mut self, undo: FunnelUndo) {
        Self::undo(self, undo);
    }

    /// Beyond the last door, passing lines cover what is left of the clockwise limit and right of the
    /// counter-clockwise one; a box can be met only if it has a corner on the right side of each.
    #[inline]
    fn may_meet(&self, bounds: &Aabb<2>) -> bool {
        let (a, b) = self.clockwise_limit();
        let (c, d) = self.counter_clockwise_limit();
        reaches_left(self.orient, a, b, bounds) && reaches_left(self.orient, d, c, bounds)
    }

    #[inline]
    fn in_front(&self, portal: &Portal2, bounds: &Aabb<2>) -> bool {
        reaches_left(self.orient, portal.left, portal.right, bounds)
    }

    fn line(&mut self) -> Option<PlanarWitness> {
        Some(self.witness())
    }

    /// Exact for any coordinates that predicates accept, whatever `O` is. O(n) for a line, O(n²) for a certificate.
    fn decide(&mut self, portals: &[Portal2]) -> PlanarVerdict {
        decide(portals).expect("there is a portal")
    }
}

/// Whether the box has a corner strictly left of the line from `a` to `b`: the corner farthest that way.
#[inline(always)]
fn reaches_left<O: Orient2d>(orient: O, a: Point2, b: Point2, bounds: &Aabb<2>) -> bool {
    let x = if b.y < a.y { bounds.max[0] } else { bounds.min[0] };
    let y = if b.x > a.x { bounds.max[1] } else { bounds.min[1] };
    orient.orient(a, b, Point2::new(x, y)) > 0.0
}
