//! Why `walk` fails.

use super::levels::UnlikeLevels;
use super::nesting::Found;
use super::path::PathError;
use crate::error::InputError;
use crate::error::OutputError;
use sightlines::eye_to_cell::Method;
use sightlines::formats::ReadError;
use std::path::PathBuf;

/// Why `walk` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A WAD, a plan or a scene cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A path that cannot be walked.
    #[error("{}: {source}", path.display())]
    Path { path: PathBuf, source: PathError },
    /// A table in which nobody can walk.
    #[error("{}: no cell has a portal, so there is nowhere to go; name a path with --path", .0.display())]
    NoWay(PathBuf),
    /// A method found something that a coarser one did not find: our own fault.
    #[error("{}: frame {frame}: {finer} finds {what}, which {coarser} does not; this is a defect of the program", path.display())]
    Nesting { path: PathBuf, frame: usize, finer: Method, coarser: Method, what: Found },
    /// An index of levels for another table.
    #[error("{}: {source}", path.display())]
    LevelsOf { path: PathBuf, source: UnlikeLevels },
}
