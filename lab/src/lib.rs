//! Speed against accuracy, and where methods fail: what `cargo xtask chart` and `cargo xtask stability` run.
//!
//! Owns: the measurements of the charts and their pictures ([`charts`]), the sweeps of the stability lab
//! ([`stability`]). Measuring and drawing are separate: a measurement writes CSV, a picture is made of CSV alone.
//! Nothing that is published uses it.

pub mod charts;
pub mod stability;
