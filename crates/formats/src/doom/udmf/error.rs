//! What can be wrong with a map as text.

use sightlines_geometry::CoordinateError;

/// What is wrong with a TEXTMAP lump, and where, shown as `line 12, column 5: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {kind}")]
pub struct TextError {
    /// Line of the text, from 1.
    pub line: u32,
    /// Byte of the line, from 1.
    pub column: u32,
    /// What is wrong there.
    #[source]
    pub kind: TextErrorKind,
}

/// What is wrong with a TEXTMAP lump.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextErrorKind {
    /// A string or a comment that begins here has no end.
    #[error("this {0} has no end")]
    Unterminated(&'static str),
    /// Something else stands where the grammar has one thing.
    #[error("{expected} is expected, not {found}")]
    Expected {
        /// What the grammar has here.
        expected: &'static str,
        /// What stands here.
        found: String,
    },
    /// A value of the wrong kind.
    #[error("{key} is {found}, but it takes {wanted}")]
    Value {
        /// What it is the value of.
        key: &'static str,
        /// What it takes.
        wanted: &'static str,
        /// What stands there.
        found: String,
    },
    /// A coordinate for which predicates are not exact.
    #[error("{key}: {source}")]
    Coordinate {
        /// Which coordinate.
        key: &'static str,
        /// What is wrong with it.
        source: CoordinateError,
    },
    /// A block without something that has no default.
    #[error("{block} {index} has no {key}")]
    Missing {
        /// What the block describes.
        block: &'static str,
        /// Its number among its kind.
        index: usize,
        /// What it lacks.
        key: &'static str,
    },
    /// A block names another that is not there.
    #[error("{block} {index}: {target} {number} is not among the {n} there are")]
    Reference {
        /// What the block describes.
        block: &'static str,
        /// Its number among its kind.
        index: usize,
        /// What it names.
        target: &'static str,
        /// The number it names.
        number: u32,
        /// How many there are.
        n: usize,
    },
}
