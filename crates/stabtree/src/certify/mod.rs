//! Proofs of whole tables whose visibility is already known.
//!
//! The results go to the makers of `sightlines-certificates`, which check each piece with their own code; so a defect
//! here can leave pairs without a proof, but cannot prove anything wrong.

mod plan;
mod space;

pub use plan::{certify_plan, plan_network};
pub use space::{ObjectRows, certify_space, space_network};

use sightlines_progress::{Cancelled, Halt, Observer, Phase, Units};
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
    /// Where proofs are kept once all are found: they are one unit of work, as each rests on what those before it leave open. A run
    /// that is stopped before begins anew, and of several processes one finds them.
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

/// The phase of units of work.
const PHASE: &str = "proofs";

/// Proofs that are kept, or found and then kept.
///
/// * `read`: proofs from bytes, if they are of these cells and portals
pub(crate) fn kept<P, N: Error + 'static>(
    units: Units<'_>,
    find: impl FnOnce() -> Result<P, CertifyError<N>>,
    write: impl Fn(&P) -> Vec<u8>,
    read: impl Fn(&[u8]) -> Option<P>,
) -> Result<P, CertifyError<N>> {
    let mut find = Some(find);
    let found = units.through(&Phase { name: PHASE, costs: &[1.0] }, || {
        let mut found = None;
        let result = units.get(PHASE, 0, || {
            let find = find.take().ok_or(Halt::Store("proofs were found, and are lost".to_owned()))?;
            let proofs = find()?;
            let bytes = if units.are_kept() { write(&proofs) } else { Vec::new() };
            found = Some(proofs);
            Ok::<_, CertifyError<N>>(bytes)
        })?;
        match (found, result) {
            (None, Some(bytes)) => {
                let unfit = || {
                    Halt::Store(format!("the kept result of unit 0 of the phase '{PHASE}' does not fit these cells"))
                };
                Ok::<_, CertifyError<N>>(Some(read(&bytes).ok_or_else(unfit)?))
            }
            (found, _) => Ok(found),
        }
    })?;
    // A phase that ends has all its results.
    Ok(found.ok_or(Halt::Shared)?)
}
