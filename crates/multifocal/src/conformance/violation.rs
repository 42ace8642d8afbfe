//! Faults that the suite finds in backends.

use crate::{BackendError, Measure};
use std::fmt;

/// The position of a fault: enough to draw the scene again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Kind of scene.
    pub family: &'static str,
    /// Seed of the effort.
    pub seed: u64,
    /// The index of the scene in its family.
    pub round: u32,
    /// The measure of the job.
    pub measure: Measure,
    /// Index of the plane.
    pub plane: usize,
    /// The texel of the plane.
    pub texel: [u32; 2],
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { family, seed, round, measure, plane, texel: [x, y] } = self;
        let measure = measure.name();
        write!(f, "scene {family} {round} of seed {seed}, {measure}, plane {plane}, texel ({x}, {y})")
    }
}

/// The clauses of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clause {
    /// 1.
    Sound,
    /// 2.
    Tight,
    /// 3.
    Complete,
    /// 4.
    Repeatable,
    /// A job is not done at all, or an unsupported one is done.
    Done,
    /// Not a clause of the backend: the suite itself examined nothing.
    Counted,
}

/// A broken promise.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// More than the exact value.
    #[error("unsound: {place}: stored {got}, exact {exact}")]
    Unsound {
        /// Where.
        place: Place,
        /// What it stored.
        got: u32,
        /// What the reference stored.
        exact: u32,
    },
    /// Less than required.
    #[error("not tight: {place}: stored {got}, at least {wanted} is known")]
    Loose {
        /// Where.
        place: Place,
        /// What it stored.
        got: u32,
        /// The least allowed.
        wanted: u32,
    },
    /// The total of values above the lowest corner is too small.
    #[error("not tight: {got:.3} of the heights above the lowest corners are kept, {wanted:.3} is stated")]
    LooseSections {
        /// Part that is kept.
        got: f64,
        /// Part that has to be.
        wanted: f64,
    },
    /// Old content of a buffer shows.
    #[error("not complete: {place}: stored {got} in a used buffer, {fresh} in a new one")]
    Incomplete {
        /// Where.
        place: Place,
        /// In a buffer full of other things.
        got: u32,
        /// In a new one.
        fresh: u32,
    },
    /// The same job gives two answers.
    #[error("not repeatable: {place}: stored {first}, then {second}")]
    NotRepeatable {
        /// Where.
        place: Place,
        /// The first time.
        first: u32,
        /// The second time.
        second: u32,
    },
    /// The buffers do not match the planes, one for each, with as many texels.
    #[error("not complete: {place}: {got} values in {n_buffers} buffers")]
    Shape {
        /// Where; the texel means nothing.
        place: Place,
        /// How many values of this plane.
        got: usize,
        /// How many buffers.
        n_buffers: usize,
    },
    /// An error.
    #[error("{place}: {error}")]
    Failed {
        /// Where; plane and texel mean nothing.
        place: Place,
        /// The error.
        error: BackendError,
    },
    /// It reports a measure as unsupported, but does not refuse it.
    #[error("{place}: the measure is not supported, and not refused")]
    NotRefused {
        /// Where; plane and texel mean nothing.
        place: Place,
    },
    /// There was nothing to compare.
    #[error("the suite proves nothing: no {what}")]
    NothingRan {
        /// The missing kind of case.
        what: &'static str,
    },
}

impl Violation {
    /// The broken clause.
    pub const fn clause(&self) -> Clause {
        match self {
            Self::Unsound { .. } => Clause::Sound,
            Self::Loose { .. } | Self::LooseSections { .. } => Clause::Tight,
            Self::Incomplete { .. } | Self::Shape { .. } => Clause::Complete,
            Self::NotRepeatable { .. } => Clause::Repeatable,
            Self::Failed { .. } | Self::NotRefused { .. } => Clause::Done,
            Self::NothingRan { .. } => Clause::Counted,
        }
    }
}
