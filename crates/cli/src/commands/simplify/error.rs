//! Why `simplify` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::simplification::SimplificationError;
use sightlines::multifocal::VolumeError;
use sightlines::simplify::ViewsError;
use std::path::PathBuf;

/// Why `simplify` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A scene that cannot be simplified.
    #[error(transparent)]
    Simplification(#[from] SimplificationError),
    /// A box that is no volume of viewpoints.
    #[error("--volume: {0}")]
    Volume(#[from] VolumeError),
    /// Places of the eye that are none.
    #[error("{}: {source}", path.display())]
    Views { path: PathBuf, source: ViewsError },
}
