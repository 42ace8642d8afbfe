#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: finding the three directions at right angles in which most of the surfaces of a scene lie ([`find_axes`]), or of
//!   boxes that stand in it ([`axes_near`]); taking a scene,
//!   and boxes with it, into a frame, where coordinates that differ by less than the stated gap become equal ([`Moved`]); what is gained by
//!   it ([`Areas`]); a frame in words ([`FrameFacts`]).
//! - **Out of scope**: the frame itself and what queries do with it (`pvs`), files, what is hidden.
//! - **Invariants**: every coordinate of a moved scene is within the gap of the frame of the true one, proven for each with the bound of its
//!   rounding; corners at one place stay at one place, as each coordinate is moved by itself; the same scene and frame give the same
//!   numbers on every machine.

#![forbid(unsafe_code)]

mod area;
mod facts;
mod fit;
mod moved;
mod snap;

pub use area::Areas;
pub use facts::{ALONG_THE_FILE, FrameFacts};
pub use fit::{FoundAxes, NEAR_SINE, are_near, axes_near, find_axes};
pub use moved::{MoveError, Moved};
pub use snap::Snaps;
