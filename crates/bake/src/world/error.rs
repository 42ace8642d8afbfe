//! Why a world is not baked.

use crate::error::BakeError;
use sightlines_formats::{ReadError, WriteError};
use sightlines_progress::{Cancelled, Halt};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Why a world is not baked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldBakeError {
    /// A scene or its view cells cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Something else is wrong with a file or a folder: it cannot be used, or does not fit the others.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A simplified scene whose triangles were moved: it may hide what can be seen.
    #[error("{}: the triangles of the scene were moved when it was simplified, so it may hide what can be seen", .0.display())]
    Occluder(PathBuf),
    /// A file is not what it was at first.
    #[error("{}: the file was changed while the world was baked; bake it again", .0.display())]
    Changed(PathBuf),
    /// A scene cannot be baked.
    #[error("{}: {source}", path.display())]
    Bake {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: Box<BakeError>,
    },
    /// The observer, or the store of units, ends the bake.
    #[error(transparent)]
    Halt(#[from] Halt),
}

impl From<Cancelled> for WorldBakeError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Halt(cancelled.into())
    }
}

impl WorldBakeError {
    pub(super) fn file(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::File { path: path.to_owned(), source: source.into() }
    }

    pub(super) fn scene(path: &Path, source: BakeError) -> Self {
        match source {
            BakeError::Cancelled(cancelled) => cancelled.into(),
            source => Self::Bake { path: path.to_owned(), source: Box::new(source) },
        }
    }
}
