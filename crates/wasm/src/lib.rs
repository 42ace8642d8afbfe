#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: what a page asks of the module ([`Session`]), and the memory through which it asks.
//! - **Out of scope**: reading tables and answering for eyes, which the package does in JavaScript; threads; files.
//! - **Invariants**: tables have the bytes that the program makes of the same file and request.

#[cfg(target_family = "wasm")]
mod memory;
mod samples;
mod session;

pub use samples::{SAMPLES, Sample};
pub use session::{PageAnswer, Session};
