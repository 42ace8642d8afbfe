//! What can be wrong with a world.

use std::error::Error;
use std::path::{Path, PathBuf};

/// Why a world, or a tile of it, cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A text that is no JSON, or lacks something.
    #[error("line {line} column {column}: {what}")]
    Syntax {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What is wrong.
        what: String,
    },
    /// Of another version.
    #[error("version {0} of the world is not known")]
    Version(u32),
    /// Something that is not right with a tile.
    #[error("tile {tile}: {what}")]
    Tile {
        /// Its place, from 0 on.
        tile: usize,
        /// What is wrong.
        what: String,
    },
    /// Something that is not right with the whole.
    #[error("{0}")]
    World(&'static str),
    /// A file that cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system, or what is wrong in the file.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A file of another bake than the others, or of another number of cells.
    #[error("{}: this is not of the bake that the index of the world names", path.display())]
    Mixed {
        /// The file.
        path: PathBuf,
    },
}

impl WorldError {
    pub(crate) fn file(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::File { path: path.to_owned(), source: source.into() }
    }

    pub(crate) fn syntax(error: &serde_json::Error) -> Self {
        // The message of the library ends with the position.
        let said = error.to_string();
        let what = said.split(" at line ").next().unwrap_or_default().to_owned();
        Self::Syntax { line: error.line(), column: error.column(), what }
    }
}
