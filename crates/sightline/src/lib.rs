#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the [`Stabber`] contract that a search drives, the planar [`Funnel`] (exact, incremental), the
//!   proofs of its answers ([`PlanarWitness`], [`PlanarCertificate`]) with checkers that share no code with it; the same
//!   for axis-aligned rectangles in space ([`AxialStabber`], [`AxialWitness`], [`AxialCertificate`]) and for convex
//!   polygons ([`ConvexStabber`], [`Line3`], [`ConvexCertificate`]).
//! - **Out of scope**: cells, graphs, tables, files.
//! - **Invariants**: every decision is exact for the coordinates given; a sequence that an open set of lines
//!   passes is never reported blocked, and one that only grazing lines pass is never reported open.
//!
//! Portals are open segments or rectangles and walls are closed, so a line that only touches an end or an
//! edge of a portal does not count.

pub mod axial;
pub mod convex;
pub mod planar;
mod simplex;
mod stabber;
mod verdict;
mod wide;

pub use axial::shaft::{
    BlockedProof, Blockers, BoxTarget, Branch, BranchRow, Bypass, Contradiction, FineLine, FreeLine, FreeSpan,
    ProofSize, Shaft, ShaftCounters, ShaftLine, ShaftVerdict,
};
pub use axial::{
    AxialCertificate, AxialCounters, AxialRow, AxialStabber, AxialUndo, AxialVerdict, AxialWitness, OctantProof,
    stabbing_line_axial,
};
pub use convex::{
    Block, BoxProof, ConvexCertificate, ConvexNode, ConvexSequence, ConvexStabber, ConvexStabberCounters, ConvexTerm,
    ConvexUndo, ConvexVerdict, FineLine3, HullProof, KnownPortal, Line3, PlaneProof, StabLimits,
};
pub use planar::{End, Funnel, FunnelUndo, PlanarCertificate, PlanarVerdict, PlanarWitness, stabbing_line};
pub use stabber::{Proof, Stabber, Witness};
pub use verdict::{LimitReached, Verdict};

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
