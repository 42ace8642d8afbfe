#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the [`Reference`], which defines the bound for every backend's buffers; nearest-feature fields of texels
//!   ([`fields`]).
//! - **Out of scope**: scenes, cells, files, devices.
//! - **Invariants**: the reference decides and measures in exact arithmetic; only the result is rounded, down to a
//!   whole number of units; it is not tuned.

pub mod fast;
pub mod fields;
pub mod reference;

pub use fast::Fast;
pub use reference::Reference;
