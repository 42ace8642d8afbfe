#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: cells of line space, their halves and sides of edges, the chains of triangles that block them ([`LineSpace`]), the same for lines that
//!   leave a box through a part of a side ([`FaceSearch`]), and the surface they are taken
//!   from ([`Surface`]).
//! - **Out of scope**: which targets are asked about, rays that spare questions, threads, files.
//! - **Invariants**: data flows `end` → `cell` → `touch`, `hull`, `side` → `roots`; `sense` → `chain` → `split` → `search` → `method`, `face`; where to cut and which chain to try are
//!   heuristics in doubles; that a chain blocks is decided by exact predicates on input coordinates, or with bounds for corners that
//!   were rounded.
//!
//! # Source
//! Lines between two boxes as four parameters: Bittner and Přikryl, "Exact Regional Visibility using Line Space Partitioning", TR 2001;
//! parity of chains: see the module `chain`. That signs at corners decide for a whole cell, or for the lines of it on one side of an edge, and how
//! chains grow, was worked out here.

mod cell;
mod chain;
mod conform;
mod end;
mod face;
mod hull;
mod marks;
mod method;
mod orient;
mod roots;
mod search;
mod sense;
mod side;
mod split;
mod surface;
mod touch;
#[cfg(test)]
mod truth;

pub use face::{FaceEffort, FaceExit, FaceSearch, FaceTarget, Unblocked};
pub use method::{Effort, LineSpace};
pub use search::Outcome;
pub use surface::Surface;
