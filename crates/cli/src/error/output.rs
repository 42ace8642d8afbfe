//! What can go wrong while results are written.

use sightlines::formats::WriteError;
use std::io;
use std::path::PathBuf;

/// Why a result was not written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OutputError {
    /// An output file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A folder cannot be made.
    #[error("{}: cannot be made: {source}", path.display())]
    Folder { path: PathBuf, source: io::Error },
    /// A folder with other files than levels, which are not to be replaced.
    #[error("{}: the folder has {name:?} in it, which is no level: name a new folder, or one that only holds levels", path.display())]
    NotLevels { path: PathBuf, name: String },
    /// An output that would replace the input it is made from.
    #[error("{}: the output would replace the input", .0.display())]
    SameFile(PathBuf),
    /// Two outputs for one file.
    #[error("{}: two outputs would be written to this file", .0.display())]
    TwoOutputs(PathBuf),
    /// Standard output cannot be written.
    #[error("{0}")]
    Print(#[source] StdoutError),
}

/// Standard output cannot be written. `main` looks for this in the sources of an error: a reader that closed the pipe has read enough.
#[derive(Debug, thiserror::Error)]
#[error("standard output: {0}")]
pub(crate) struct StdoutError(pub(crate) io::Error);
