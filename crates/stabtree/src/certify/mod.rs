//! Proofs of whole tables whose visibility is already known.
//!
//! The results go to the makers of `sightlines-certificates`, which check each piece with their own code; so a defect
//! here can leave pairs without a proof, but cannot prove anything wrong.

mod axial;
mod chain;
mod planar;

pub use axial::{ObjectRows, axial_network, certify_axial};
pub(crate) use chain::{Steps, through};
pub use planar::{certify_planar, planar_network};

use sightlines_progress::{Cancelled, Halt, Observer, Units};
use std::error::Error;

/// How much effort goes into proofs. More effort proves more pairs and never changes what is proven.
#[derive(Clone, Copy)]
pub struct CertifyOptions<'a> {
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
    /// Receives a report for each finished unit (cell, gate or pair of groups), and may cancel.
    pub progress: Option<&'a dyn Observer>,
    /// Where the findings of each unit of work are kept, so that a stopped run goes on, and processes share one. A unit is a few cells or
    /// gates, or a pair of groups, or an object. Lines and walks build on each other, so one process finds all of them, one unit after the
    /// other; in space, processes share what is hidden. Whatever was kept is checked again before it is used.
    pub units: Units<'a>,
}

impl Default for CertifyOptions<'_> {
    fn default() -> Self {
        Self {
            chords: 12,
            most_steps: 20_000_000,
            most_steps_in_all: 2_000_000_000,
            threads: 0,
            progress: None,
            units: Units::default(),
        }
    }
}

impl std::fmt::Debug for CertifyOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CertifyOptions")
            .field("chords", &self.chords)
            .field("most_steps", &self.most_steps)
            .field("most_steps_in_all", &self.most_steps_in_all)
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// Why there are no proofs; `N` is the error of a graph that is not well formed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError<N: Error + 'static> {
    /// Nothing can be proven about the cells and portals.
    #[error(transparent)]
    Network(N),
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the work.
    #[error(transparent)]
    Halted(Halt),
}

impl<N: Error + 'static> From<Halt> for CertifyError<N> {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Cancelled(cancelled) => cancelled.into(),
            halt => Self::Halted(halt),
        }
    }
}

/// The phase of lines and walks, and in space of pairs of groups of cells.
pub(crate) const PHASE: &str = "proofs";

/// What results are of.
const OF: &str = "these cells";
