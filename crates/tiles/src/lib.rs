#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: what a world consists of ([`WorldPlan`]), which tiles are near each other ([`near_tiles`]), the folder of baked tiles and its index
//!   ([`WorldIndex`], [`TiledWorld`]), what an eye sees across tiles ([`TileTables`], [`Seen`]), and loading ahead of a viewer ([`TileWalk`]).
//! - **Out of scope**: how tiles are baked (`bake`), how tables are stored (`packed`), who bakes which (the program).
//! - **Invariants**: an eye outside of every cell sees everything, and so does one whose tile is not loaded yet; a tile that another does not know
//!   of is seen as a whole; tables of different bakes are never mixed; no content of a file causes a panic.

#![forbid(unsafe_code)]

mod error;
mod files;
mod index;
mod near;
mod plan;
mod tables;
mod walk;
mod world;

pub use error::WorldError;
pub use files::{TileFileError, far_bytes, near_bytes, table_bytes};
pub use index::{INDEX_NAME, TileEntry, TilePart, WorldIndex};
pub use near::{TileBounds, near_tiles};
pub use plan::{TilePlan, WorldPlan};
pub use tables::{Seen, TileScratch, TileTables};
pub use walk::{TileFrame, TileWalk, TileWalkOptions};
pub use world::{TileId, TiledWorld};
