//! Pictures, exports and numbers of visibility tables.
//!
//! Owns: the drawing of a plan and of what is seen in it ([`plan_svg`], [`svg_to_png`]), the JSON
//! export ([`export_json`]), the numbers that sum a table up ([`Summary`]).
//! Does not know: how a table was made, files, how the numbers are worded.
//! Invariants: a table is only looked at, and what is shown is what it says; the same table and options
//! give the same bytes on every machine; pictures have no text, so they need no fonts.

mod draw;
mod export;
mod frame;
mod outline;
mod png;
mod summary;
mod theme;

pub use draw::{DrawError, DrawOptions, MAX_SIZE, MIN_SIZE, View, plan_svg};
pub use export::{export_json, write_json};
pub use png::{PngError, svg_to_png};
pub use summary::Summary;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
