#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: [`CellId`] and the other ids, the rows of bits ([`BitMatrix`]), sets of indices as runs
//!   ([`runs`]), point location ([`Locator`],
//!   [`PlaneTree`]), stored stab trees ([`StabTrees`]), the validated [`Table`] of all this, its byte format
//!   ([`format`](mod@format)).
//! - **Out of scope**: how the table was made, walls, files, threads. A game ships this crate alone.
//! - **Invariants**: ids are dense from 0; every cell sees itself; visibility is symmetric; every point of a cell is
//!   located in it; answers err towards visible. Damaged bytes never become a table, and never cause a panic.

#![forbid(unsafe_code)]

pub mod bits;
mod check;
pub mod digest;
mod door;
pub mod format;
pub mod frame;
mod id;
mod kind;
pub mod locator;
mod parts;
pub mod planes;
mod query;
mod records;
pub mod runs;
mod set;
mod side;
mod sources;
pub mod stab;
mod table;

pub use bits::BitMatrix;
pub use check::{Item, TableError};
pub use digest::GeometryDigest;
pub use door::{DoorBox, box_covers, doors_named};
pub use format::{DecodeError, DecodeErrorKind, SectionId};
pub use frame::{Frame, FrameError};
pub use id::{CellId, DoorId, MirrorId, ObjectId, PortalId};
pub use kind::{Axis, SceneMethods, TableKind};
pub use locator::{Locator, LocatorError, LocatorNode, LocatorNodeRef};
pub use parts::TableParts;
pub use planes::{PlaneChild, PlaneError, PlaneNode, PlaneTree};
pub use query::{DimensionError, Inside, Place, PlaceBuffer, Query};
pub use records::{
    CellRecord, DoorRecord, MirrorRecord, ObjectPart, ObjectParts, ObjectRecord, ObjectSource, PortalRecord,
    TriangleRange, triangle_ranges,
};
pub use set::CellSet;
pub use side::polygon_may_contain;
pub use sources::NodeIndex;
pub use stab::{StabError, StabParts, StabTrees};
pub use table::Table;
