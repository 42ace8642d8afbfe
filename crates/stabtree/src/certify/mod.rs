//! Proofs of whole tables whose visibility is already known.
//!
//! What is found here is handed to the makers of `sightlines-certificates`, which check each piece with code of their own; so
//! a defect here can leave pairs without a proof, and prove nothing wrong.

mod plan;
mod space;

pub use plan::{certify_plan, plan_network};
pub use space::{certify_space, space_network};

/// How much effort goes into proofs. More proves more and changes nothing that is proven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CertifyOptions {
    /// Lines shot through each portal, before lines are searched for single pairs.
    pub chords: u32,
    /// Gates looked at from one cell, after which no more is proven of it; for boxes in space, linear programs for a pair
    /// of single cells. For convex cells a question about a sequence counts for a thousand, and a walk that is too long is tried
    /// again with half as many targets and half as many questions, four times at most.
    pub most_steps: u64,
    /// The same for all cells together.
    pub most_steps_in_all: u64,
    /// Number of threads; 0 for one for each core. Changes nothing but the time; plans and convex cells are
    /// proven on one.
    pub threads: usize,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self { chords: 12, most_steps: 20_000_000, most_steps_in_all: 2_000_000_000, threads: 0 }
    }
}
