//! The contract of [`Stabber`], as code that anyone can run against their own implementation.
//!
//! [`run`] draws sequences of portals as chains of convex cells give them, walks them depth first, and compares:
//! 1. conservative: `push` never blocks a sequence that a line passes;
//! 2. tight: of the sequences that no line passes, `push` blocks the share of [`Effort::tight`];
//! 3. undone: after an `undo`, and after a `push` that blocks, the stabber answers as one that was only given the
//!    sequence;
//! 4. reaching: `may_meet`, `meets` and `in_front` are true of boxes that a line of the sequence meets;
//! 5. lines: `line` passes every portal, and is there if [`Effort::tight`] is 1;
//! 6. evidence: `decide` agrees with the truth, its lines pass and its proofs hold, and no proof holds for a sequence
//!    that a line passes;
//! 7. repeatable: the same calls have the same answers.
//!
//! The truth is evidence: a sequence is open if a reference stabber has a line that passes it, and blocked if the
//! reference has a proof that holds. Both are evaluated by code that shares nothing with a solver. Sequences without
//! evidence are not compared. [`impostors`] are stabbers with one fault each, which the suite has to refuse.
//!
//! ```
//! use sightlines_sightline::conformance::{Effort, planar};
//! use sightlines_sightline::Funnel;
//! use sightlines_geometry::Adaptive;
//!
//! let report = planar(&Funnel::new(Adaptive), &Effort::quick())?;
//! assert!(report.open > 0 && report.blocked > 0);
//! # Ok::<(), sightlines_sightline::conformance::Violation>(())
//! ```

mod cases;
mod check;
pub mod impostors;
mod violation;

use crate::{AxialStabber, ConvexSequence, Funnel, StabLimits, Stabber};
pub use cases::{Axial, Case, Cases, Convex, Planar};
use check::Check;
use sightlines_geometry::{Aabb, Adaptive, AxialDoor, Portal2, Portal3, Random};
use std::sync::Arc;
pub use violation::{Clause, Violation};

/// How much is looked at, and how much has to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Of the sequences.
    pub seed: u64,
    /// Sequences, of 2 to 9 portals each.
    pub rounds: u32,
    /// The share of blocked sequences that `push` has to block, 0 to 1. 1 for exact stabbers, which also have to have a
    /// line for every open sequence.
    pub tight: f64,
}

impl Effort {
    /// For exact stabbers; less than a second for those of this crate.
    pub const fn quick() -> Self {
        Self { seed: 1, rounds: 300, tight: 1.0 }
    }
}

/// What was compared, without a violation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Report {
    /// Sequences drawn.
    pub sequences: u64,
    /// Pushes compared with the truth that the sequence is open.
    pub open: u64,
    /// Pushes compared with the truth that the sequence is blocked.
    pub blocked: u64,
    /// Of these, how many the stabber blocks.
    pub found: u64,
    /// Sequences of which the reference has no evidence.
    pub unknown: u64,
    /// Answers compared with those of a stabber that was not undone.
    pub undone: u64,
    /// Boxes that a line meets.
    pub boxes: u64,
    /// Lines of the stabber that were evaluated.
    pub lines: u64,
    /// Proofs of the stabber that were evaluated.
    pub proofs: u64,
}

/// Checks a stabber for doors in the plane.
///
/// # Errors
/// The first [`Violation`].
pub fn planar<S>(stabber: &S, effort: &Effort) -> Result<Report, Violation>
where
    S: Stabber<Portal = Portal2, Bounds = Aabb<2>>,
{
    run(stabber, &Funnel::new(Adaptive), &Planar, effort)
}

/// Checks a stabber for axis-aligned doors in space.
///
/// # Errors
/// The first [`Violation`].
pub fn axial<S>(stabber: &S, effort: &Effort) -> Result<Report, Violation>
where
    S: Stabber<Portal = AxialDoor, Bounds = Aabb<3>>,
{
    run(stabber, &AxialStabber::new(), &Axial, effort)
}

/// Checks a stabber for convex polygons in space.
///
/// # Errors
/// The first [`Violation`].
pub fn convex<S>(stabber: &S, effort: &Effort) -> Result<Report, Violation>
where
    S: Stabber<Portal = Arc<Portal3>, Bounds = Aabb<3>>,
{
    run(stabber, &ConvexSequence::new(StabLimits::default()), &Convex, effort)
}

/// Checks that clones of `stabber` keep the contract, on sequences of `cases` that `reference` decides. The same effort
/// draws the same sequences on every machine.
///
/// # Errors
/// The first [`Violation`] that was found; one of them is that there was nothing to compare.
pub fn run<S, R, C>(stabber: &S, reference: &R, cases: &C, effort: &Effort) -> Result<Report, Violation>
where
    S: Stabber<Portal = C::Portal, Bounds = C::Bounds>,
    R: Stabber<Portal = C::Portal, Bounds = C::Bounds>,
    C: Cases,
{
    let mut random = Random::new(effort.seed);
    let mut check = Check::new(stabber, reference.clone(), cases, effort);
    for round in 0..effort.rounds {
        // Every other sequence has a line by construction.
        let case = cases.draw(&mut random, round.is_multiple_of(2));
        check.sequence(round, &case)?;
    }
    check.finish()
}
