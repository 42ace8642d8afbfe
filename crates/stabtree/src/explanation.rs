//! The vocabulary of explanations, one for all kinds of graphs: a [`Verdict`] on two cells, with its evidence.

use sightlines_sightline::Verdict;

/// Why one cell sees another, or why it does not.
///
/// * Visible: a `Path`, a sequence of portals with a line through all of them.
/// * Hidden: a `Proof` that no open set of lines leads from one cell to the other.
/// * Undecided: a `Doubt`, mostly a limit of the caller. A table counts such cells as visible.
///
/// | graph | search | path | proof | doubt |
/// | --- | --- | --- | --- | --- |
/// | plan | [`explain`](fn@crate::explain) | [`PlanarPath`](crate::PlanarPath) | [`PlanarProof`](crate::PlanarProof) | [`SearchLimit`] |
/// | boxes in space | [`explain_axial`](crate::explain_axial) | [`AxialPath`](crate::AxialPath) | [`AxialProof`](crate::AxialProof) | [`SearchLimit`] |
/// | convex cells | [`explain_convex`](crate::explain_convex) | [`ConvexPath`](crate::ConvexPath) | [`ConvexProof`](crate::ConvexProof) | [`ConvexDoubt`](crate::ConvexDoubt) |
pub type Explanation<Path, Proof, Doubt = SearchLimit> = Verdict<Sight<Path>, Barrier<Proof>, Doubt>;

/// Why two cells see each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sight<Path> {
    /// They are one cell, and a cell sees itself.
    SameCell,
    /// A line joins them.
    Along(Path),
}

/// Why two cells do not see each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Barrier<Proof> {
    /// No chain of portals leads from one to the other.
    NotConnected,
    /// Portals lead from one to the other, but no open set of lines does.
    Blocked(Proof),
}

/// The effort that was allowed and not enough: cells entered in a plan, linear programs in space, queries about
/// sequences of gates for convex cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SearchLimit(pub u64);
