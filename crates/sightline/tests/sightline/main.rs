//! Stabbing lines of portal sequences, against exact oracles.

mod axial;
mod convex;
mod stabbing;
