//! An area light as the view volume: which surfaces are wholly in umbra, wholly lit, or in doubt, and pictures of soft shadows.
//!
//! What is hidden from a volume of viewpoints is in umbra if the volume is a light. So the from-region methods of
//! `sightlines-multifocal` find umbrae; that nothing at all stands between a surface and the light is shown here.
//!
//! Owns: the states of surfaces under a light ([`Shadows::classify`], [`Lighting`], [`Piece`]), the proof that a piece is wholly lit, pictures in
//! which rays are cast only where nothing is proven ([`Shadows::picture`]).
//! Does not know: how umbrae are found, colours, files, threads.
//! Invariants: umbra and lit are proven of pieces with their true corners, which cover the face (a given corner may be off by a rounding, as
//! [`Piece::error`] says), for all points of the light that lie on no surface; rays decide nothing but what is worth asking, and shares where nothing is proven; the same input gives the same answer.
//!
//! Source: the parts of a soft shadow and their exact borders: Nishita and Nakamae, "Half-tone representation of 3-D objects illuminated by area sources or
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
pub use lighting::{Areas, LightCounters, Lighting};
pub use options::{Options, Side, Sides};
pub use picture::{LightPicture, Shade, shown};
pub use piece::{Piece, State};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
