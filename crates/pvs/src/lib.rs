//! Run-time table: which cells can be seen from which.
//!
//! Owns: [`CellId`], the rows of bits ([`BitMatrix`]), point location ([`Locator`], [`PlaneTree`]), stab
//! trees as they are kept ([`StabTrees`]), the checked [`Table`] of all this, its byte format
//! ([`format`](mod@format)).
//! Does not know: how the table was made, walls, files, threads. A game ships this crate alone.
//! Invariants: ids are dense from 0; every cell sees itself; who is seen sees; every point of a cell is
//! located in it; answers err towards "visible". Bytes that are not exactly what was written never
//! become a table, and never a panic.

#![forbid(unsafe_code)]

pub mod bits;
mod check;
pub mod format;
mod id;
pub mod locator;
mod parts;
pub mod planes;
mod set;
mod side;
pub mod stab;
mod table;

pub use bits::BitMatrix;
pub use check::{Item, TableError};
pub use format::{DecodeError, DecodeErrorKind, SectionId};
pub use id::CellId;
pub use locator::{Locator, LocatorError, LocatorNode};
pub use parts::{CellRecord, MirrorRecord, ObjectRecord, PortalRecord, TableParts};
pub use planes::{PlaneChild, PlaneError, PlaneNode, PlaneTree};
pub use set::CellSet;
pub use side::polygon_may_contain;
pub use stab::{StabError, StabParts, StabTrees};
pub use table::Table;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
