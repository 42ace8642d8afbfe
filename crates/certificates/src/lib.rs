#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the proofs as data, their bytes, and a checker that shares no code with the solvers that find them:
//!   [`planar`] for polygons of the plane, [`axial`] for boxes, [`convex`] for cells joined by polygons in space. A search
//!   that finds proofs passes them to a maker here, which checks each of them immediately.
//! - **Out of scope**: graphs of cells, searching, tables, files.
//! - **Invariants**: decisions are signs of exact numbers; no step of a proof rests on a later one. Reading bytes takes memory
//!   of a few times their size; checking takes a few bits for each pair of cells of the network.
//!
//! It has its own exact arithmetic on purpose and does not use `sightlines-exact`: a checker must not share the errors of
//! the code that it checks.

pub mod axial;
mod bits;
mod bytes;
pub mod convex;
mod exact;
mod graph;
mod pairs;
pub mod planar;
mod proven;
mod walk;

pub use bytes::{Kind, ReadError, ReadErrorKind, VERSION};
pub use pairs::{ObjectPairs, Pairs};
pub use proven::{NoWall, Proven, Refusal};
pub use walk::{ChainSolver, ChainStep, Decisions, Maker};

/// The kind of proofs that bytes hold, after a check of their frame and checksum.
///
/// # Errors
/// [`ReadError`] for bytes that are not proofs or are damaged.
pub fn kind_of(bytes: &[u8]) -> Result<Kind, ReadError> {
    bytes::unframed(bytes).map(|(kind, _)| kind)
}
