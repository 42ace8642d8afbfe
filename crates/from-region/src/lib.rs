//! The older ways to say what is hidden from a volume of viewpoints, behind the interface of `sightlines-multifocal`.
//!
//! Owns: view shafts ([`ViewShafts`]: one convex occluder cuts all lines between two boxes), and voxels with blocker
//! extension ([`Voxels`]: the insides of closed surfaces, grown into what is hidden already).
//! Does not know: buffers, threads, devices, files, who asks.
//! Invariants: what is called hidden is hidden, as far as [`FromRegion::guarantee`] says; doubles that are rounded
//! may reject a blocker, accepting takes exact predicates or bounds that err towards visible; the same input gives
//! the same answer.
//!
//! [`FromRegion::guarantee`]: sightlines_multifocal::FromRegion::guarantee

mod bits;
mod blocks;
mod grid;
mod interior;
mod overlap;
mod parity;
mod shadow;
pub mod shafts;
mod surface;
pub mod voxels;

pub use shafts::{ShaftUmbra, ViewShafts};
pub use voxels::{Interior, VoxelError, VoxelOptions, VoxelUmbra, Voxels};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
