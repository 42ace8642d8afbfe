//! Tests of the border to C.

mod bakes;
#[cfg(feature = "fuzz")]
mod calls;
mod common;
mod header;
mod programs;
mod same;
