//! Why `sightlines-vis` fails.

use crate::commands::vis;
use crate::error::OutputError;
use sightlines::formats::quake::VisibilityError;
use sightlines::formats::{Malformed, ReadError};
use std::io;
use std::path::PathBuf;

/// Why `sightlines-vis` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(super) enum Error {
    /// As `sightlines vis` fails.
    #[error(transparent)]
    Vis(#[from] vis::Error),
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The map cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The log cannot be written.
    #[error("{}: the log cannot be written: {source}", path.display())]
    Log { path: PathBuf, source: io::Error },
    /// A map in which nothing says what is heard.
    #[error("{}: this is a map of {format}: -phsonly is for Quake II", path.display())]
    NoHearing { path: PathBuf, format: &'static str },
    /// A map without visibility, where it is needed.
    #[error("{}: the map has no visibility yet, of which -phsonly makes what is heard: run it without that option first", .0.display())]
    NoVisibility(PathBuf),
    /// The visibility of a map cannot be read.
    #[error("{}: {source}", path.display())]
    Visibility { path: PathBuf, source: VisibilityError },
    /// A map cannot hold what is heard.
    #[error("{}: {source}", path.display())]
    Bsp { path: PathBuf, source: Malformed },
}
