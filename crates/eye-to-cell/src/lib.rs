#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the viewer's cone ([`View`]), what is gathered from a table for the viewers of one cell ([`Outlook`]), the
//!   four methods of Teller and Séquin and the zeroth ([`Method`], behind [`EyeToCell`]), portals that are closed
//!   for now ([`Doors`]), what is seen in mirrors ([`Reflection`]).
//! - **Out of scope**: how the table was made, files, threads, frames.
//! - **Invariants**: answers err towards visible, by rounding only, and each tolerance is derived ([`side`](self));
//!   each method's answer is within that of the one before; once warm, a query without mirrors allocates nothing; no
//!   number, however strange, causes a panic.

#![forbid(unsafe_code)]

mod doors;
mod front;
mod image;
mod marks;
mod method;
mod outlook;
mod scratch;
mod seen;
mod side;
mod source;
mod table;
mod trees;
mod view;

pub use doors::Doors;
pub use image::{Image, follow_reflections};
pub use method::{EyeToCell, Method, UnknownMethod};
pub use outlook::Outlook;
pub use scratch::Scratch;
pub use seen::{Reflection, Seen};
pub use source::{CellSource, MirrorWay, StabStep, Way};
pub use table::TableCells;
pub use view::{View, ViewError};
