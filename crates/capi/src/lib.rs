#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the border to C: handles, status codes, buffers of the caller, and the header `include/sightlines.h`, which is made from
//!   this crate and compared with it by a test; `include/sightlines.hpp` on top of it.
//! - **Out of scope**: everything behind the border. What a function answers is what the Rust crates answer.
//! - **Invariants**: no panic crosses the border; null pointers, numbers out of range and handles of another kind are statuses;
//!   a buffer is written only as far as its stated size; a table may be read by any number of threads, and every other handle
//!   answers one call at a time.
//!
//! This is the only crate of the project with `unsafe` code. Memory of callers is read and written in `border`, handles are made, told and freed in
//! `handle`; all other modules pass pointers on to these two.

#![expect(
    clippy::missing_safety_doc,
    reason = "the conditions are the same for every function, and stated once, at the top of the header and in the README"
)]

#[cfg(feature = "bake")]
mod bake;
mod border;
mod doors;
mod eye;
#[cfg(feature = "fuzz")]
pub mod fuzz;
mod handle;
mod image;
mod info;
mod query;
mod relevance;
#[cfg(feature = "bake")]
mod scene;
mod status;
mod table;
mod version;
mod view;
mod viewer;

#[cfg(feature = "bake")]
pub use bake::*;
pub use doors::*;
pub use eye::*;
pub use image::*;
pub use info::*;
pub use query::*;
pub use relevance::*;
#[cfg(feature = "bake")]
pub use scene::*;
pub use status::*;
pub use table::*;
pub use version::*;
pub use view::*;
pub use viewer::*;
