//! The contract of stabbers: what a search needs from a method that decides about sequences of portals.

use crate::Verdict;
use std::convert::Infallible;

/// A line as evidence that sequences of portals are passable. It is evaluated, not trusted: an implementation shares
/// no code with the stabber that finds the line.
pub trait Witness<Portal> {
    /// Whether the line passes a portal strictly inside and in its direction. Exact.
    fn passes(&self, portal: &Portal) -> bool;
}

/// Evidence that no open set of lines passes a sequence of portals. It is evaluated, not trusted: an implementation
/// shares no code with the stabber that finds the proof.
pub trait Proof<Portal> {
    /// Whether it proves this of these portals, in this order. May err towards `false` only.
    fn holds(&self, portals: &[Portal]) -> bool;
}

/// Decides, portal by portal, whether lines pass through a growing sequence.
///
/// A search drives it depth first: `start`, then `push` and `undo` in stack order. It separates the search, which
/// handles cells, from the geometry, which handles lines. Implemented for doors in the plane
/// ([`Funnel`](crate::Funnel)), axis-aligned doors ([`AxialStabber`](crate::AxialStabber)) and convex polygons
/// ([`ConvexSequence`](crate::ConvexSequence)); `conformance::Stabbers` in `crates/testkit` of the repository tests others.
///
/// # Contract
/// For sequences as chains of convex cells give them:
/// 1. conservative: `push` answers `None` only if no open set of lines passes the sequence with the new portal;
/// 2. tight: if [`Stabber::Doubt`] is [`Infallible`], `push` answers `None` whenever none
///    does; otherwise it may miss some, within its limits;
/// 3. after a `None`, and after the `undo` of a push, the state is as it was before;
/// 4. `may_meet`, `meets` and `in_front` never answer `false` for something that a line of the sequence meets;
/// 5. a line of [`Stabber::line`] passes every portal of the sequence, and is there whenever
///    [`Stabber::Doubt`] is `Infallible`;
/// 6. [`Stabber::decide`] agrees with pushing the same portals, and its evidence holds.
pub trait Stabber: Clone + Send {
    /// An oriented portal.
    type Portal: Clone;
    /// A region that holds a target.
    type Bounds;
    /// The record that undoes a push.
    type Undo: Copy;
    /// Evidence of a passable sequence.
    type Line: Witness<Self::Portal>;
    /// Evidence of a blocked sequence.
    type Proof: Proof<Self::Portal>;
    /// Why a sequence was not decided; [`Infallible`] for exact methods.
    type Doubt;

    /// Resets to the lines through one portal.
    fn start(&mut self, portal: Self::Portal);

    /// Adds a portal; `None` and no change if no line passes.
    fn push(&mut self, portal: Self::Portal) -> Option<Self::Undo>;

    /// Undoes the latest push that is not undone yet.
    fn undo(&mut self, undo: Self::Undo);

    /// Whether a line through the sequence may meet something inside `bounds` beyond its last portal.
    fn may_meet(&self, bounds: &Self::Bounds) -> bool;

    /// Whether an open set of lines through the sequence meets the inside of `bounds`, which lies in the
    /// cell behind the last portal. May err towards `true`; costs more than `may_meet`.
    fn meets(&mut self, bounds: &Self::Bounds) -> bool {
        self.may_meet(bounds)
    }

    /// Whether something inside `bounds` may lie beyond `portal`, for lines that cross it. Does not depend on the
    /// sequence.
    fn in_front(&self, portal: &Self::Portal, bounds: &Self::Bounds) -> bool;

    /// A line through the sequence that was started and pushed; `None` if it is undecided whether there is one.
    fn line(&mut self) -> Option<Self::Line>;

    /// Decides about a whole sequence of at least one portal, with evidence. The sequence that was pushed stays.
    ///
    /// # Panics
    /// May panic if `portals` is empty.
    fn decide(&mut self, portals: &[Self::Portal]) -> Verdict<Self::Line, Self::Proof, Self::Doubt>;
}

/// No evidence: for stabbers that find none, such as references that are compared by their answers alone.
impl<Portal> Witness<Portal> for Infallible {
    fn passes(&self, _: &Portal) -> bool {
        match *self {}
    }
}

/// As for witnesses.
impl<Portal> Proof<Portal> for Infallible {
    fn holds(&self, _: &[Portal]) -> bool {
        match *self {}
    }
}
