#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: how far bodies are from the cells of a table ([`Ways`]); the [`Reaches`] of pairs of cells and their file; the
//!   answers for bodies ([`Relevance`]).
//! - **Out of scope**: making tables of visibility, the network, files.
//! - **Invariants**: answers err towards visible; a tick allocates nothing once it is warm; the same calls give the
//!   same answers on every machine, with any number of threads.

#![forbid(unsafe_code)]

mod ask;
mod body;
mod distance;
mod near;
mod pairs;
mod reaches;
mod relevance;

pub use ask::{Exposure, Span};
pub use body::{Body, Player, PlayerRole};
pub use distance::Ways;
pub use reaches::{ReachError, ReachFileError, ReachOptions, Reaches, WhoMoves};
pub use relevance::{Changes, Relevance, RelevanceOptions};
