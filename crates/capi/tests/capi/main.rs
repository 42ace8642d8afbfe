//! Tests of the border to C.

#[cfg(feature = "fuzz")]
mod calls;
mod header;
mod programs;
mod same;
