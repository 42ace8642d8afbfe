//! Why `light` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::eye::EyeError;
use crate::picture::PictureError;
use sightlines::multifocal::BackendError;
use sightlines::multifocal::VolumeError;
use sightlines::visible_surface::FacesError;
use std::path::PathBuf;

/// Why `light` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// An eye that sees nothing.
    #[error(transparent)]
    Eye(#[from] EyeError),
    /// A scene that is too large.
    #[error("{}: {source}", path.display())]
    Faces { path: PathBuf, source: FacesError },
    /// A box that is no volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// Nobody could fill the buffer.
    #[error("{}: {source}", path.display())]
    Backend { path: PathBuf, source: BackendError },
}
