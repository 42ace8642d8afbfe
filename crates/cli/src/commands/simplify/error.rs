//! Why `simplify` fails.

use crate::file_error::{FileError, from_file_error};
use crate::simplification::SimplificationError;
use sightlines::multifocal::VolumeError;
use sightlines::simplify::ViewsError;
use std::path::PathBuf;

/// Why `simplify` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A scene that cannot be simplified.
    #[error(transparent)]
    Simplification(#[from] SimplificationError),
    /// A box that is not a volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// Invalid places of the eye.
    #[error("{}: {source}", path.display())]
    Views { path: PathBuf, source: ViewsError },
}

from_file_error!(Error);
