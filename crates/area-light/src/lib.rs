#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the states of surfaces under a light ([`Shadows::classify`], [`Lighting`], [`Piece`]), the proof that a
//!   piece is fully lit, pictures that cast rays only where nothing is proven ([`Shadows::picture`]).
//! - **Out of scope**: how umbrae are found, colours, files, threads.
//! - **Invariants**: umbra and lit are proven for pieces with their true corners, which cover the face
//!   ([`Piece::error`] bounds the rounding of the stored ones), for all points of the light that lie on no surface;
//!   rays only steer the work and estimate shares where nothing is proven; the same input gives the same answer.
//!
//! If the volume of viewpoints is a light, what is hidden from it is in umbra. So the from-region methods of
//! `sightlines-multifocal` find umbrae; the proof that nothing lies between a surface and the light is here.
//!
//! # Source
//! The parts of a soft shadow and their exact borders: Nishita and Nakamae, "Half-tone representation of 3-D objects illuminated by area sources or
//! polyhedron sources", COMPSAC 1983.

mod classify;
mod hull;
mod lighting;
mod options;
mod picture;
mod piece;
mod rays;
mod vector;

pub use classify::Shadows;
pub use lighting::{LightCounters, Lighting, LightingAreas};
pub use options::{LightOptions, Side, Sides};
pub use picture::{LightPicture, Shade, shown};
pub use piece::{Piece, State};
