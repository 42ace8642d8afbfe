//! What a stabber is found to do wrong.

/// Which clause of the contract is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Clause {
    /// 1.
    Conservative,
    /// 2.
    Tight,
    /// 3.
    Undone,
    /// 4.
    Reaching,
    /// 5.
    Lines,
    /// 6.
    Evidence,
    /// 7.
    Repeatable,
    /// No fault of the stabber: the suite compared nothing.
    Counted,
}

/// A broken clause. `round` draws the sequence again, with the same seed; `portals` is the number of its portals, from
/// the first, that were looked at.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// A line passes, and `push` returns `None`.
    #[error("not conservative: sequence {round}: a line passes the first {portals} portals, and the last is blocked")]
    Hides {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
    },
    /// Fewer blocked sequences are found than have to be.
    #[error("not tight: {found} of {blocked} blocked sequences are found")]
    Loose {
        /// Blocked by the stabber.
        found: u64,
        /// Blocked in truth.
        blocked: u64,
    },
    /// The answer depends on what was undone.
    #[error("not undone: sequence {round}: after undoing, the answer for portal {portals} is another")]
    NotUndone {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
    },
    /// A box that a line meets is left out.
    #[error("not reaching: sequence {round}: after {portals} portals, {method} leaves out a box that a line meets")]
    Misses {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
        /// The method that answers `false`.
        method: &'static str,
    },
    /// A line does not pass, or is not there.
    #[error("lines: sequence {round}: {what} for the first {portals} portals")]
    Line {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// `decide` is wrong, or its evidence does not hold.
    #[error("evidence: sequence {round}: {what}, of the first {portals} portals")]
    Evidence {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// The same calls, another answer.
    #[error("not repeatable: sequence {round}: two answers for portal {portals}")]
    NotRepeatable {
        /// The sequence.
        round: u32,
        /// How many portals.
        portals: usize,
    },
    /// There was nothing to compare.
    #[error("the suite proves nothing: no {what}")]
    NothingRan {
        /// What there was none of.
        what: &'static str,
    },
}

impl Violation {
    /// Which clause is broken.
    pub const fn clause(&self) -> Clause {
        match self {
            Self::Hides { .. } => Clause::Conservative,
            Self::Loose { .. } => Clause::Tight,
            Self::NotUndone { .. } => Clause::Undone,
            Self::Misses { .. } => Clause::Reaching,
            Self::Line { .. } => Clause::Lines,
            Self::Evidence { .. } => Clause::Evidence,
            Self::NotRepeatable { .. } => Clause::Repeatable,
            Self::NothingRan { .. } => Clause::Counted,
        }
    }
}
