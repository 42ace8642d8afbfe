//! Lines through convex polygons in space: found by linear programs, decided exactly, proven.
//!
//! # Question
//! A directed line passes a [`Portal3`] if it has every edge strictly on its
//! inner side. It passes a sequence in order if it passes every portal, and of any two meets the hull of
//! the earlier one's corners before the hull of the later one's, at another point. Through a chain of
//! convex cells every line goes in order, but for those through a common point of two portals, without
//! which an open set of lines is still open and not empty. So the question is whether any line passes in
//! order: with strict conditions, if one line does, an open set does.
//!
//! # Parameters
//! Choose two portals of the sequence, the earlier and the later (those between which lines are most
//! alike, not always the first and the last) and a thin box around each, its *block*. A line from a point
//! `q = c + u A + v B + w C` of one block to `r = c' + s A' + t B' + x C'` of the other has an edge from `e`
//! to `f` on its inner side if
//!
//! ```text
//! side(q, r) = (f - e) · ((q - e) × (r - e)) > 0
//! ```
//!
//! which is affine in `q` and in `r`, and so affine in each one of the six coordinates. A weighted sum of
//! such sides, too, has its largest value over a box of coordinates at one of its 64 corners.
//!
//! # Why the blocks hold all lines
//! Corners of files are not quite in one plane, so a line that passes a polygon need not meet any chosen
//! plane near it. But it does meet the hull of the corners: seen along the line, which is then a point o,
//! every edge has o strictly on its left. So from corner to corner the direction seen from o turns left
//! by more than 0 and less than a half turn, and once round by at least a full turn. Hence every open
//! half-plane at o contains a corner (a step over it would be a half turn at least), and o is inside the
//! hull of what is seen; so the line meets the hull of the corners. A block that holds the corners holds
//! their hull, and therefore a point of every line that passes. This needs no bound on how uneven a
//! polygon is. The thickness of a block is what is left of the noise.
//!
//! A line that passes in order is thus the line from some `q` of the one block to some `r` of the other, in
//! this direction.
//!
//! # Certificate
//! A [tree of boxes](ConvexCertificate) of (u, v, s, t). In each leaf positive multiples of sides add up to
//! something negative at all corners of the box, and so for all of its lines; for a line that passes it
//! would be positive. As the sum is zero wherever `q = r`, such a box holds no two equal points.
//!
//! Or a plane with an earlier portal on one side, a later one on the other and a still later one on the first side,
//! corners on the plane allowed. A line that passes in order has points of their hulls one after the other. The plane's
//! linear form is affine along the line, so it is zero on all of it: the line lies on the plane. Seen along the line
//! the plane is then a line through o, and the first portal's corners are all on one side of it, although every open
//! half-plane at o contains one.
//!
//! Or a weighted sum of sides that is not positive at any pair of corners of two portals' hulls ([`HullProof`]): it is affine in both
//! points, so it is positive for no line between the hulls. It needs no blocks, and none of the margin that their thickness takes.
//!
//! # Method
//! * A hint is tried, exactly.
//! * By turns: with `q` fixed, the best `r` is a linear program of two coordinates and a margin; then `q`
//!   for that `r`; until the margin is positive and the line passes exactly.
//! * Relaxed: the products us, ut, vs, vt as unknowns of their own, within the hull of the sixteen corners.
//!   Its dual is the best weighted sum of a leaf; if its bound is negative, the weights are checked in
//!   doubles with a bound on their error, and make the leaf.
//! * Otherwise the relaxed line is a new start for turns. Then a plane is sought, exactly: maps are on grids, and most
//!   of what no margin separates is stopped by a plane.
//! * Otherwise the box is cut across the product that is relaxed most, near the relaxed line, and the part with the
//!   largest bound is next; the error of the relaxation shrinks like the square of the box.
//!
//! What is left open is mostly a matter of rounding: lines that graze, or pass slits as wide as the rounding of corners.
//! [`ConvexStabber::stab_finely`] looks at it in numbers of two doubles.
//!
//! Doubles only propose. What is visible has passed exact predicates, what is hidden a rigorous check; everything else
//! is [`Verdict::Undecided`], which a caller has to treat as visible.
//!
//! # Source
//! Plücker's coordinates for lines past lines: Teller, "Computing the antipenumbra of an area light source",
//! SIGGRAPH 1992. Relaxed products: McCormick, Math. Programming 10, 1976. Blocks, certificates and the
//! choice of portals are our own.

mod certificate;
mod chart;
mod counters;
mod fine;
mod game;
mod hull;
mod line;
mod planes;
mod rows;
mod sequence;
mod simplex;
mod solver;
mod vector;
mod verify;
mod witness;

pub use certificate::{Block, BoxProof, ConvexCertificate, ConvexNode, ConvexTerm, HullProof, PlaneProof};
pub use counters::ConvexStabberCounters;
pub use fine::FineLine3;
pub use line::Line3;
pub use sequence::{ConvexSequence, ConvexUndo};
pub use solver::{ConvexStabber, KnownPortal, StabLimits};

use crate::{LimitReached, Verdict};
use sightlines_geometry::Portal3;

/// The answer for one sequence of convex polygons. [`Verdict::Hidden`] means that no line passes in order.
/// [`Verdict::Undecided`] means that the limits were reached; it has to count as visible.
pub type ConvexVerdict = Verdict<Line3, ConvexCertificate, LimitReached>;

/// Decides one sequence with the default limits: see [`ConvexStabber::stab`].
pub fn stab(portals: &[&Portal3]) -> ConvexVerdict {
    ConvexStabber::new(StabLimits::default()).stab(portals, None)
}
