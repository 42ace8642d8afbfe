//! Why `light` fails.

use crate::buffers::MethodFailed;
use crate::eye::EyeError;
use crate::file_error::{FileError, from_file_error};
use sightlines::multifocal::BackendError;
use sightlines::multifocal::VolumeError;
use sightlines::visible_surface::FacesError;
use std::path::PathBuf;

/// Why `light` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A camera that shows nothing.
    #[error(transparent)]
    Eye(#[from] EyeError),
    /// A scene that is too large.
    #[error("{}: {source}", path.display())]
    Faces { path: PathBuf, source: FacesError },
    /// A box that is not a volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// A method cannot be prepared.
    #[error(transparent)]
    Method(#[from] MethodFailed),
    /// No backend could fill the buffer.
    #[error("{}: {source}", path.display())]
    Backend { path: PathBuf, source: BackendError },
}

from_file_error!(Error);
