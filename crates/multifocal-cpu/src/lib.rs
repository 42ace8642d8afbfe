//! Multifocal buffers on the CPU.
//!
//! Owns: the [`Reference`], which is the definition of what every backend's buffers are bounded by;
//! fields of what is nearest to texels ([`fields`]).
//! Does not know: scenes, cells, files, devices.
//! Invariants: the reference decides and measures in exact arithmetic, without any rounding but the last, down to a
//! whole number of units; nobody tunes it.

pub mod fast;
pub mod fields;
pub mod reference;

pub use fast::Fast;
pub use reference::Reference;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
