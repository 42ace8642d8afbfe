//! The contract of [`Stabber`].
//!
//! Sequences of portals are drawn as chains of convex cells give them, and walked depth first:
//! 1. conservative: `push` never blocks a sequence that a line passes;
//! 2. tight: of the sequences that no line passes, `push` blocks the share of [`Stabbers::tight`];
//! 3. undone: after an `undo`, and after a `push` that blocks, the stabber answers as one that was only given the
//!    sequence;
//! 4. reaching: `may_meet`, `meets` and `in_front` are true of boxes that a line of the sequence meets;
//! 5. lines: `line` passes every portal, and is there if [`Stabbers::tight`] is 1;
//! 6. evidence: `decide` agrees with the truth, its lines pass and its proofs hold, and no proof holds for a sequence
//!    that a line passes;
//! 7. repeatable: the same calls have the same answers.
//!
//! The truth is evidence: a sequence is open if a reference stabber has a line that passes it, and blocked if the
//! reference has a proof that holds. Both are evaluated by code that shares nothing with a solver. Sequences without
//! evidence are not compared.

mod cases;
mod check;
mod impostor;

use super::{Clause, Random, Report, Suite, Violation};
pub use cases::{Axial, Case, Cases, Convex, Planar};
use check::Walk;
pub use impostor::StabberFault;
use sightlines_geometry::{Adaptive, Portal3};
use sightlines_sightline::{AxialStabber, ConvexSequence, Funnel, StabLimits, Stabber};
use std::sync::Arc;

/// The suite of stabbers.
#[derive(Debug, Clone)]
pub struct Stabbers<R, C> {
    /// The stabber with evidence of the truth.
    pub reference: R,
    /// The source of sequences.
    pub cases: C,
    /// The seed of the sequences.
    pub seed: u64,
    /// Sequences, of 2 to 9 portals each.
    pub rounds: u32,
    /// The share of blocked sequences that `push` has to block, 0 to 1. 1 for exact stabbers, which also have to have a
    /// line for every open sequence.
    pub tight: f64,
}

impl<R, C> Stabbers<R, C> {
    /// For exact stabbers; takes less than a second.
    fn quick(reference: R, cases: C) -> Self {
        Self { reference, cases, seed: 1, rounds: 300, tight: 1.0 }
    }
}

impl Stabbers<Funnel<Adaptive>, Planar> {
    /// For doors in the plane.
    pub fn planar() -> Self {
        Self::quick(Funnel::new(Adaptive), Planar)
    }
}

impl Stabbers<AxialStabber, Axial> {
    /// For axis-aligned doors in space.
    pub fn axial() -> Self {
        Self::quick(AxialStabber::new(), Axial)
    }
}

impl Stabbers<ConvexSequence<Arc<Portal3>>, Convex> {
    /// For convex polygons in space.
    pub fn convex() -> Self {
        Self::quick(ConvexSequence::new(StabLimits::default()), Convex)
    }
}

impl<S, R, C> Suite<S> for Stabbers<R, C>
where
    S: Stabber<Portal = C::Portal, Bounds = C::Bounds>,
    R: Stabber<Portal = C::Portal, Bounds = C::Bounds>,
    C: Cases,
{
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
            walk.sequence(round, &self.cases.draw(&mut random, round.is_multiple_of(2)))?;
        }
        let [blocked, found] = ["blocked sequences", "blocked sequences found"].map(|what| report[what]);
        let wanted = self.tight * blocked as f64;
        if (found as f64) < wanted {
            return Err(report.broken(Clause::Tight, "all sequences", format!("{wanted} blocked"), found));
        }
        Ok(())
    }
}
