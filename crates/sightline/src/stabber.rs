//! What a search needs from a stabbing method.

/// Decides, portal by portal, whether lines pass through a growing sequence.
///
/// A search drives it depth first: `start`, then `push` and `undo` in stack order. It is the seam
/// between the search, which knows cells, and the geometry, which knows lines.
///
/// Contract:
/// 1. exact: `push` answers `None` if and only if no open set of lines passes the sequence so far and
///    the new portal, for sequences that come from chains of convex cells;
/// 2. after a `None`, and after the `undo` of a push, the state is as it was before;
/// 3. `may_meet`, `meets` and `in_front` never answer `false` for something that a line of the sequence meets.
pub trait Stabber: Clone + Send {
    /// An oriented portal.
    type Portal: Copy;
    /// A region that holds a target.
    type Bounds;
    /// What takes a push back.
    type Undo: Copy;

    /// Forgets everything and begins with the lines through one portal.
    fn start(&mut self, portal: Self::Portal);

    /// Adds a portal; `None` and no change if no line passes.
    fn push(&mut self, portal: Self::Portal) -> Option<Self::Undo>;

    /// Takes back the latest push that was not taken back yet.
    fn undo(&mut self, undo: Self::Undo);

    /// Whether a line through the sequence may meet something inside `bounds` beyond its last portal.
    fn may_meet(&self, bounds: &Self::Bounds) -> bool;

    /// Whether an open set of lines through the sequence meets the inside of `bounds`, which lies in the
    /// cell behind the last portal. May err towards `true`; costs more than `may_meet`.
    fn meets(&mut self, bounds: &Self::Bounds) -> bool {
        self.may_meet(bounds)
    }

    /// Whether something inside `bounds` may lie beyond `portal`, for who crosses it.
    fn in_front(&self, portal: Self::Portal, bounds: &Self::Bounds) -> bool;
}
