#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: view shafts ([`ViewShafts`]: one convex occluder cuts all lines between two boxes), and voxels with blocker
//!   extension ([`Voxels`]: the insides of closed surfaces, grown into what is hidden already); and two ways to hide by what encloses, for whole
//!   scenes and many targets: closed surfaces ([`ClosedSurfaces`]), exactly, and what a rolling ball reaches ([`BallReach`]), by a stated gap.
//! - **Out of scope**: buffers, threads, devices, files, callers.
//! - **Invariants**: what is reported hidden is hidden, as far as [`FromRegion::guarantee`] states; rounded doubles may
//!   reject a blocker, but accepting one takes exact predicates or bounds that err towards visible; the same input
//!   gives the same answer.
//!
//! [`FromRegion::guarantee`]: sightlines_multifocal::FromRegion::guarantee

mod ball;
mod bits;
mod blocks;
mod closed;
mod grid;
mod interior;
mod overlap;
mod parity;
mod shadow;
pub mod shafts;
mod surface;
pub mod voxels;

pub use ball::{BallReach, GapError};
pub use closed::{ClosedSurfaces, EyeSides};
pub use overlap::may_meet;
pub use shafts::{ShaftUmbra, ViewShafts};
pub use voxels::{Interior, VoxelError, VoxelOptions, VoxelUmbra, Voxels};
