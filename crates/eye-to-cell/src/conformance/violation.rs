//! What a source is found to do wrong.

use sightlines_pvs::CellId;

/// Which clause of the contract is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Clause {
    /// 1.
    Ranges,
    /// 2.
    Ordered,
    /// 3.
    TwoSided,
    /// 4.
    Shapes,
    /// 5.
    Trees,
    /// 6.
    Repeatable,
    /// 7.
    Conservative,
    /// The source gave an error.
    Readable,
    /// No fault: there was nothing to check.
    Counted,
}

/// A broken clause.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// A method of a cell breaks a clause.
    #[error("cell {cell}: {what}")]
    Cell {
        /// Which clause.
        clause: Clause,
        /// The cell.
        cell: CellId,
        /// What is wrong.
        what: &'static str,
    },
    /// A method of an object, or of the whole, breaks a clause.
    #[error("{what}")]
    Whole {
        /// Which clause.
        clause: Clause,
        /// What is wrong.
        what: &'static str,
    },
    /// There are no cells.
    #[error("the suite proves nothing: the source has no cells")]
    NothingRan,
}

impl Violation {
    /// Which clause is broken.
    pub const fn clause(&self) -> Clause {
        match self {
            Self::Cell { clause, .. } | Self::Whole { clause, .. } => *clause,
            Self::NothingRan => Clause::Counted,
        }
    }
}
