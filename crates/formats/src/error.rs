//! Errors of reading a file: its path, and what is wrong inside.

use sightlines_pvs::DecodeError;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read, shown as `e1m1.wad: map MAP01: LINEDEFS 12: ...`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct ReadError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// What is wrong.
    #[source]
    pub kind: ReadErrorKind,
}

impl ReadError {
    /// Puts the file's name before what is wrong inside.
    pub fn new(path: impl AsRef<Path>, kind: impl Into<ReadErrorKind>) -> Self {
        Self { path: path.as_ref().to_owned(), kind: kind.into() }
    }
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// The system could not read it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Its content is not of the format that it is read as. The error is that of the format, such as
    /// [`WadError`](crate::WadError).
    #[error(transparent)]
    Content(Box<dyn Error + Send + Sync>),
}

impl ReadErrorKind {
    /// The error of a format.
    pub fn content(error: impl Error + Send + Sync + 'static) -> Self {
        Self::Content(Box::new(error))
    }
}

impl From<DecodeError> for ReadErrorKind {
    fn from(error: DecodeError) -> Self {
        Self::content(error)
    }
}
