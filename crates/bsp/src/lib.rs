#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: trees of planes ([`Tree`]), the polygons in which the regions below them meet ([`openings`]), the
//!   rounding of their corners outwards.
//! - **Out of scope**: files, what is solid, which faces cover an opening, visibility.
//! - **Invariants**: which regions meet is decided exactly, from the planes' coefficients as they are: a corner is the
//!   point of three planes, and on which side of a fourth it lies is the sign of a determinant. Corners are rounded
//!   once, at the end, so that no point of an opening is lost.

mod corner;
mod opening;
mod outwards;
mod plane;
mod polygon;
mod tree;

pub use opening::{Opening, openings};
pub use plane::Plane;
pub use tree::{Child, Node, Region, Tree, TreeError};
