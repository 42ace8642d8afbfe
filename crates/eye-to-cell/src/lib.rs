#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the viewer's cone ([`View`]), what is gathered from a table for the viewers of one cell ([`VisibleSubgraph`]), the
//!   four methods of Teller and Séquin and the zeroth ([`Method`]), portals that are closed
//!   for now ([`Doors`]), what is seen in mirrors ([`Reflection`]).
//! - **Out of scope**: how the table was made, files, threads, frames.
//! - **Invariants**: answers err towards visible, by rounding only, and each tolerance is derived ([`side`](self));
//!   each method's answer is within that of the one before; once warm, a query without mirrors allocates nothing; no
//!   number, however strange, causes a panic.

#![forbid(unsafe_code)]

mod doors;
mod epoch_set;
mod front;
mod image;
mod method;
mod named;
mod side;
mod source;
mod subgraph;
mod table;
mod trees;
mod view;
mod visible_set;

pub use doors::Doors;
pub use image::{MirrorImage, follow_reflections};
pub use method::{Method, Scratch, StepBudget, UnknownMethod};
pub use named::CloseError;
pub use source::{CellSource, MirrorPiece, PortalEdge, StabStep};
pub use subgraph::VisibleSubgraph;
pub use table::TableCells;
pub use view::{View, ViewError};
pub use visible_set::{Reflection, VisibleSet};
