//! Why `view` fails.

use crate::file_error::{FileError, from_file_error};
use crate::walk_path::PathError;
use sightlines::viewer::PageError;
use std::path::PathBuf;

/// Why `view` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A page cannot be made.
    #[error("{}: {source}", path.display())]
    Page { path: PathBuf, source: PageError },
    /// A scene that the table was not made of.
    #[error("{}: the table was made of another scene: {what}", .path.display())]
    OtherScene { path: PathBuf, what: String },
    /// A file that is no walk.
    #[error("{}: {source}", path.display())]
    Walk { path: PathBuf, source: PathError },
    /// No program to show the file with.
    #[error("{}: was written, but no browser could be started: {source}", path.display())]
    Browser { path: PathBuf, source: std::io::Error },
}

from_file_error!(Error);
