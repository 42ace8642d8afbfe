//! The contract of [`Stabber`].
//!
//! Sequences of portals are drawn as chains of convex cells give them, and walked depth first. The clauses are those of
//! [`Stabber`]; of the sequences that no line passes, `push` has to block the share of [`Stabbers::tight`], no proof holds
//! for a sequence that a line passes, and the same calls have the same answers.
//!
//! The truth is evidence: a sequence is open if a reference stabber has a line that passes it, and blocked if the
//! reference has a proof that holds. Both are evaluated by code that shares nothing with a solver. Sequences without
//! evidence are not compared.

mod cases;
mod check;
mod impostor;

use super::{Clause, Random, Report, Suite, Violation};
pub use cases::{Case, Cases};
use check::Walk;
pub use impostor::StabberFault;
use sightlines_geometry::{Adaptive, Portal3};
use sightlines_sightline::{AxialStabber, ConvexSequence, Funnel, StabLimits, Stabber};
use std::sync::Arc;

/// The suite of stabbers.
#[derive(Debug, Clone)]
pub struct Stabbers<R: Stabber> {
    /// The stabber with evidence of the truth.
    pub reference: R,
    /// The source of sequences.
    pub cases: Cases<R::Portal, R::Bounds>,
    /// The seed of the sequences.
    pub seed: u64,
    /// Sequences, of 2 to 9 portals each.
    pub rounds: u32,
    /// The share of blocked sequences that `push` has to block, 0 to 1. 1 for exact stabbers, which also have to have a
    /// line for every open sequence.
    pub tight: f64,
}

impl<R: Stabber> Stabbers<R> {
    /// For exact stabbers; takes less than a second.
    fn quick(reference: R, cases: Cases<R::Portal, R::Bounds>) -> Self {
        Self { reference, cases, seed: 1, rounds: 300, tight: 1.0 }
    }
}

impl Stabbers<Funnel<Adaptive>> {
    /// For doors in the plane.
    pub fn planar() -> Self {
        Self::quick(Funnel::new(Adaptive), cases::PLANAR)
    }
}

impl Stabbers<AxialStabber> {
    /// For axis-aligned doors in space.
    pub fn axial() -> Self {
        Self::quick(AxialStabber::new(), cases::AXIAL)
    }
}

impl Stabbers<ConvexSequence<Arc<Portal3>>> {
    /// For convex polygons in space.
    pub fn convex() -> Self {
        Self::quick(ConvexSequence::new(StabLimits::default()), cases::CONVEX)
    }
}

impl<R: Stabber, S: Stabber<Portal = R::Portal, Bounds = R::Bounds>> Suite<S> for Stabbers<R> {
    const CONTRACT: &'static str = "stabber";
    const NEEDED: &'static [&'static str] =
        &["sequences", "open sequences", "blocked sequences", "boxes that a line meets"];
    const COUNTED: &'static [&'static str] =
        &["blocked sequences found", "sequences without evidence", "answers after undoing", "lines", "proofs"];

    fn check(&self, stabber: &mut S, report: &mut Report) -> Result<(), Violation> {
        let mut random = Random::new(self.seed);
        let mut walk = Walk::new(stabber, self, report);
        for round in 0..self.rounds {
            // Every other sequence has a line by construction.
            walk.sequence(round, &(self.cases.draw)(&mut random, round.is_multiple_of(2)))?;
        }
        report.check_share(self.tight, ["blocked sequences", "blocked sequences found"])
    }
}
