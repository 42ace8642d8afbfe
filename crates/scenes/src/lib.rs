#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the generators, their options and their random numbers.
//! - **Out of scope**: sight lines and files; cells, except in generators that produce worlds of cells.
//! - **Invariants**: the same options give the same bytes on every machine (integers only until the last
//!   step, which divides by a power of two); a plan is closed by an outer wall unless its description
//!   says otherwise; meshes are closed and face outwards; bad options give an error, never a panic.

#[cfg(test)]
mod check;
pub mod city;
pub mod degenerate;
pub mod doom_like;
pub mod enclosed;
pub mod error;
pub mod hall;
mod layout;
pub mod maze;
pub mod occlusion;
pub mod office;
mod rng;
mod spanning;
mod stroke;
pub mod surfaces;
pub mod tower;
pub mod world;

pub use city::{CityOptions, CityTile, city, city_crossings, city_tiles};
pub use doom_like::{DoomLike, DoomLikeLine, doom_like};
pub use enclosed::{Enclosed, GearboxOptions, Pipe, cupboard, gearbox, nested_voids};
pub use error::GenerateError;
pub use hall::{pillared_hall, turned_pillared_hall};
pub use maze::maze;
pub use occlusion::{Occlusion, OcclusionOptions, occlusion};
pub use office::{OfficeOptions, office};
pub use surfaces::{
    DepthPairsOptions, SurfaceOptions, coplanar, cycles, depth_pairs, interleaved, lattice, slivers, soup, split_worst,
};
pub use tower::{TowerOptions, TowerRoom, tower, tower_rooms};
pub use world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, quake_like};
