//! What can be wrong with an index of levels, and where.

use std::fmt;

/// A text that is not an index of levels, shown as `line 3 column 14: not JSON that can be read` or `level 2: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}{kind}")]
pub struct LevelsIndexError {
    /// Where.
    pub place: LevelsPlace,
    /// What is wrong.
    #[source]
    pub kind: LevelsIndexErrorKind,
}

/// A place in an index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LevelsPlace {
    /// The whole.
    Whole,
    /// Line and column of the text, from 1.
    Text(usize, usize),
    /// A level, by its number.
    Level(usize),
    /// A cell, by its number.
    Cell(usize),
}

impl fmt::Display for LevelsPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Text(line, column) => write!(f, "line {line} column {column}: "),
            Self::Level(level) => write!(f, "level {level}: "),
            Self::Cell(cell) => write!(f, "cell {cell}: "),
        }
    }
}

/// What is wrong with an index of levels.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LevelsIndexErrorKind {
    /// The text is not JSON, or a member is missing, twice there, or of another kind.
    #[error("{0}")]
    Syntax(String),
    /// Another version.
    #[error("version {found} of the index is not {}", super::VERSION)]
    Version {
        /// The version that it states.
        found: u32,
    },
    /// A number that is not a share.
    #[error("\"{member}\" is a share from 0 to 1, not {value}")]
    Share {
        /// The member.
        member: &'static str,
        /// Its value.
        value: f64,
    },
    /// A level that does not lie beside the index.
    #[error("{name:?} is no name of a file beside the index")]
    File {
        /// The name.
        name: String,
    },
    /// Two levels in one file.
    #[error("level {first} is in the same file, {name:?}")]
    SameFile {
        /// The first level in the file.
        first: usize,
        /// The file.
        name: String,
    },
    /// More triangles than the whole scene has.
    #[error("{n} triangles are more than the {all} of the scene")]
    Triangles {
        /// Triangles of the level.
        n: u64,
        /// Triangles of the whole scene.
        all: u64,
    },
    /// A cell has a level that does not exist.
    #[error("there is no level {level}, there are {n_levels}")]
    NoLevel {
        /// The level that it has.
        level: u32,
        /// Number of levels.
        n_levels: usize,
    },
}

impl From<LevelsIndexError> for crate::ReadErrorKind {
    fn from(error: LevelsIndexError) -> Self {
        Self::content(error)
    }
}
