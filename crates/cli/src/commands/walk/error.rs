//! Why `walk` fails.

use super::nesting::Found;
use crate::file_error::{FileError, from_file_error};
use crate::walk_path::PathError;
use sightlines::eye_to_cell::Method;
use sightlines::walkthrough::LevelError;
use std::path::PathBuf;

/// Why `walk` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A path that cannot be walked.
    #[error("{}: {source}", path.display())]
    Path { path: PathBuf, source: PathError },
    /// A table in which there is nowhere to walk.
    #[error("{}: no cell has a portal, so there is nowhere to go; name a path with --path", .0.display())]
    NoWay(PathBuf),
    /// A method found something that a coarser one did not find: a defect of the program.
    #[error("{}: frame {frame}: {finer} finds {what}, which {coarser} does not; this is a defect of the program", path.display())]
    Nesting { path: PathBuf, frame: usize, finer: Method, coarser: Method, what: Found },
    /// An index of levels for another table.
    #[error("{}: {source}", path.display())]
    LevelsOf { path: PathBuf, source: UnlikeLevels },
}

from_file_error!(Error);

/// Why levels do not go with a table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum UnlikeLevels {
    #[error("the levels are for another table: the index has {levels} cells, {} has {table}", path.display())]
    Count { levels: usize, path: PathBuf, table: usize },
    #[error(transparent)]
    Index(#[from] LevelError),
}
