//! What can be wrong with view cells, and where.

use sightlines_geometry::CoordinateError;
use std::fmt;

/// A text that has no view cells, shown as `line 3 column 14: cell 2 ("hall"): ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line} column {column}: {place}{kind}")]
pub struct ViewCellsError {
    /// Line of the text where reading stopped, from 1; for errors that concern a whole cell, its end.
    pub line: usize,
    /// Column in that line.
    pub column: usize,
    /// Which cell.
    pub place: ViewCellPlace,
    /// What is wrong.
    #[source]
    pub kind: ViewCellsErrorKind,
}

/// A cell of the list; what is not known or not meant is `None`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ViewCellPlace {
    /// Its index.
    pub cell: Option<usize>,
    /// Its id, once that was read.
    pub id: Option<String>,
}

impl fmt::Display for ViewCellPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.cell, &self.id) {
            (None, _) => Ok(()),
            (Some(cell), None) => write!(f, "cell {cell}: "),
            // As a Rust string: an id may hold anything, and a message should stay one line.
            (Some(cell), Some(id)) => write!(f, "cell {cell} ({id:?}): "),
        }
    }
}

/// What is wrong with a text of view cells.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewCellsErrorKind {
    /// The text is not JSON, or has a number that no f64 can hold.
    #[error("not JSON that can be read")]
    Syntax,
    /// The text ends before the value does.
    #[error("the text ends too early")]
    Truncated,
    /// A value that should be an object is not.
    #[error("not a JSON object")]
    NotAnObject,
    /// A value of another kind than belongs there.
    #[error("\"{member}\" is not {expected}")]
    Member {
        /// The member of the object.
        member: &'static str,
        /// What belongs there.
        expected: &'static str,
    },
    /// A member that the object needs is not there.
    #[error("there is no \"{0}\"")]
    Missing(&'static str),
    /// A member is there twice.
    #[error("there are two members \"{0}\"")]
    Repeated(&'static str),
    /// The list has no cells.
    #[error("there are no cells in the list")]
    NoCells,
    /// A cell whose id is an empty text.
    #[error("the id is empty")]
    EmptyId,
    /// Two cells with one id.
    #[error("cell {first} has the same id")]
    SameId {
        /// Index of the first cell with the id.
        first: usize,
    },
    /// A number that cannot be a coordinate.
    #[error("\"{member}\": {source}")]
    Coordinate {
        /// The corner: `min` or `max`.
        member: &'static str,
        /// What is wrong with it.
        source: CoordinateError,
    },
    /// A lower corner above the upper one.
    #[error("\"min\" is above \"max\" in {}: {min} and {max}", ["x", "y", "z"][axis % 3])]
    Inverted {
        /// 0 for x, 1 for y, 2 for z.
        axis: usize,
        /// The lower corner there.
        min: f64,
        /// The upper corner there.
        max: f64,
    },
}

impl From<ViewCellsError> for crate::ReadErrorKind {
    fn from(error: ViewCellsError) -> Self {
        Self::content(error)
    }
}
