//! Proofs of whole tables whose visibility is already known.
//!
//! The results go to the makers of `sightlines-certificates`, which check each piece with their own code; so a defect
//! here can leave pairs without a proof, but cannot prove anything wrong.

mod plan;
mod space;

pub use plan::{certify_plan, plan_network};
pub use space::{certify_space, space_network};

/// How much effort goes into proofs. More effort proves more pairs and never changes what is proven.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CertifyOptions {
    /// Lines shot through each portal, before lines are searched for single pairs.
    pub chords: u32,
    /// Gates tried from one cell before the cell is left as it is; for boxes in space, linear programs for a pair of
    /// single cells. For convex cells a stabbing query counts as a thousand steps, and a walk that is too long is
    /// repeated with half as many targets and half as many queries, at most four times.
    pub most_steps: u64,
    /// The same for all cells together.
    pub most_steps_in_all: u64,
    /// Number of threads; 0 for one per core. Affects only the time; plans and convex cells are proven on one thread.
    pub threads: usize,
}

impl Default for CertifyOptions {
    fn default() -> Self {
        Self { chords: 12, most_steps: 20_000_000, most_steps_in_all: 2_000_000_000, threads: 0 }
    }
}
