//! Errors, which are texts for people: exit code 2. Nobody branches on them, so they have no types of their own.

pub(crate) use anyhow::{Result, anyhow, bail};

use std::path::Path;
use std::{fmt, io};

/// What an error is about, in front of it: a file, an option, a cell.
#[derive(Debug, thiserror::Error)]
#[error("{what}: {source}")]
struct About {
    what: String,
    source: anyhow::Error,
}

/// Says what an error is about.
pub(crate) trait ErrorAbout<T> {
    /// `what: error`.
    fn about(self, what: impl fmt::Display) -> Result<T>;

    /// The same with the name of a file.
    fn in_file(self, path: impl AsRef<Path>) -> Result<T>;
}

impl<T, E: Into<anyhow::Error>> ErrorAbout<T> for Result<T, E> {
    fn about(self, what: impl fmt::Display) -> Result<T> {
        self.map_err(|source| About { what: what.to_string(), source: source.into() }.into())
    }

    fn in_file(self, path: impl AsRef<Path>) -> Result<T> {
        self.about(path.as_ref().display())
    }
}

/// Standard output cannot be written. The program looks for this in the sources of an error: a reader that closed the pipe has read enough.
#[derive(Debug, thiserror::Error)]
#[error("standard output: {0}")]
pub(crate) struct StdoutError(pub(crate) io::Error);
