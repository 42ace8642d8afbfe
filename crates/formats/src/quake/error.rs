//! Errors of reading a file of this family: its path, and what is wrong inside.

use super::{BspError, PrtError};
use std::io;
use std::path::PathBuf;

/// A file that could not be read, shown as `e1m1.prt: line 12, column 3: ...`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct QuakeReadError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// What is wrong.
    #[source]
    pub kind: QuakeErrorKind,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QuakeErrorKind {
    /// The system could not read it.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is not a sound portal file.
    #[error(transparent)]
    Prt(#[from] PrtError),
    /// It is not a sound map.
    #[error(transparent)]
    Bsp(#[from] BspError),
}
