#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the page ([`Page`]), what is drawn beside the table ([`Figure`]), lines and reasons as it carries them ([`Reasons`]), and the scripts of the page in `web/`, which have the rules of
//!   `sightlines-pvs` once more, in JavaScript.
//! - **Out of scope**: files, how a table was made, how lines are found.
//! - **Invariants**: the page asks for nothing from outside, and says so to the browser; texts of a scene are never markup; the
//!   same input gives the same bytes; what is left out is said on the page.

mod figure;
mod page;
mod payload;
mod reasons;

pub use figure::Figure;
pub use page::{Page, PageError, WalkerPose, Written};
pub use reasons::{Line, Obstacle, Reasons};
