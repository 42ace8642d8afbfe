//! Stabbing lines of portal sequences, against exact oracles.

mod axial;
mod conformance;
mod convex;
mod convex_fine;
mod stabbing;
