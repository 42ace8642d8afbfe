//! Why `multifocal` fails.

use crate::buffers::MethodFailed;
use crate::file_error::{FileError, from_file_error};
use sightlines::multifocal::BackendError;
use sightlines::multifocal::JobError;
use sightlines::multifocal::PlaneError;
use sightlines::multifocal::VolumeError;
use std::path::PathBuf;

/// Why `multifocal` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A box that is not a volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// A plane on which no buffer can be.
    #[error("--plane {plane}: {source}")]
    Plane { plane: String, source: PlaneError },
    /// A plane with eyes on both sides, or on it.
    #[error(
        "--plane {plane}: the plane goes through the view volume, which reaches from {axis}={low} to {axis}={high}"
    )]
    PlaneInVolume { plane: String, axis: &'static str, low: f64, high: f64 },
    /// A plane and a volume that do not go together.
    #[error("--plane {plane}: {source}")]
    Job { plane: String, source: JobError },
    /// A backend that is not part of this build.
    #[error(transparent)]
    Method(#[from] MethodFailed),
    /// No backend could fill the buffer.
    #[error("{}: {source}", path.display())]
    Backend { path: PathBuf, source: BackendError },
}

from_file_error!(Error);
