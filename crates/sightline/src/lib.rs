//! Stabbing lines: is there a line through a sequence of oriented portals, and which?
//!
//! Owns: the [`Stabber`] contract that a search drives, the planar [`Funnel`] (exact, incremental), the
//! proofs of its answers ([`Witness`], [`Certificate`]) with checkers that share no code with it; the same
//! for axis-aligned rectangles in space ([`AxialStabber`], [`AxialWitness`], [`AxialCertificate`]) and for convex
//! polygons ([`ConvexStabber`], [`Line3`], [`ConvexCertificate`]); and the first two questions as linear
//! programs ([`lp`]), for reference.
//! Does not know: cells, graphs, tables, files.
//! Invariants: every decision is exact for the coordinates given; a sequence that an open set of lines
//! passes is never called blocked, and one that only grazing lines pass is never called open.
//!
//! Portals are open segments or rectangles and walls are closed, so a line that only touches an end or an
//! edge of a portal does not count.

pub mod axial;
pub mod certificate;
pub mod convex;
pub mod funnel;
pub mod lp;
mod stabber;
pub mod witness;

pub use axial::shaft::{
    BlockedProof, Blockers, Branch, BranchRow, Contradiction, FreeLine, FreeSpan, ProofSize, Shaft, ShaftCounters,
    Sight, Target, WayPast,
};
pub use axial::{
    AxialCertificate, AxialCounters, AxialRow, AxialStabber, AxialUndo, AxialWitness, OctantProof, StabbingAxial,
    stabbing_line_axial,
};
pub use certificate::{Certificate, End};
pub use convex::{
    Block, BoxProof, ConvexCertificate, ConvexCounters, ConvexNode, ConvexStabber, ConvexTerm, Line3, PlaneProof,
    StabLimits, Stabbing3,
};
pub use funnel::{Funnel, FunnelUndo};
pub use stabber::Stabber;
pub use witness::Witness;

use sightlines_geometry::{Adaptive, Portal2, check_coordinate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;

/// What is wrong with a sequence of portals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SightlineError {
    /// A coordinate is NaN, infinite, or of a magnitude for which predicates are not exact.
    #[error("portal {0} has a coordinate that cannot be used")]
    NotFinite(usize),
    /// Both ends of a portal are one point: no open set of lines passes it.
    #[error("portal {0} has length zero")]
    ZeroLength(usize),
    /// A door that should be perpendicular to an axis is not: its rectangle has an extent along that
    /// axis, or there is no such axis.
    #[error("portal {0} is not perpendicular to its axis")]
    NotFlat(usize),
}

/// The answer for one sequence.
#[derive(Debug, Clone, PartialEq)]
pub enum Stabbing2 {
    /// An open set of lines passes; here is one of them.
    Visible(Witness),
    /// None does; here is why.
    Blocked(Certificate),
}

/// Finds a directed line that passes through every portal of `portals`, in order.
///
/// The line keeps each portal's left end strictly on its left and its right end strictly on its right.
///
/// * `portals`: doors in one common frame, scene units, in the order in which a line meets them when
///   it goes through a chain of convex cells.
/// * Returns a witness line, or a certificate that no such line exists; `None` for no portals at all,
///   which every line passes.
///
/// Exact; O(n) for the decision, O(n²) for a certificate.
///
/// # Errors
/// [`SightlineError`] with the portal's index.
///
/// # Source
/// Teller and Séquin, SIGGRAPH 1991, for the question; for the method see [`funnel`].
pub fn stabbing_line(portals: &[Portal2]) -> Result<Option<Stabbing2>, SightlineError> {
    for (i, p) in portals.iter().enumerate() {
        if [p.left.x, p.left.y, p.right.x, p.right.y].into_iter().any(|x| check_coordinate(x).is_err()) {
            return Err(SightlineError::NotFinite(i));
        }
        if p.left == p.right {
            return Err(SightlineError::ZeroLength(i));
        }
    }
    let Some((first, rest)) = portals.split_first() else { return Ok(None) };
    let mut funnel = Funnel::new(Adaptive);
    funnel.start(*first);
    if rest.iter().all(|p| funnel.push(*p).is_some()) {
        let witness = funnel.witness();
        if portals.iter().all(|&p| witness.passes(p)) {
            return Ok(Some(Stabbing2::Visible(witness)));
        }
    }
    // The funnel trusts the order of portals. Sequences that no chain of cells made may break it, so
    // "blocked" is said only with a certificate.
    let separating = || Witness::separating(portals).expect("hulls that do not meet are separated by a line");
    let proof = Certificate::find(portals).map_or_else(|| Stabbing2::Visible(separating()), Stabbing2::Blocked);
    Ok(Some(proof))
}
