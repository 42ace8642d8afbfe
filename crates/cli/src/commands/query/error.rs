//! Why `query` fails.

use crate::doors::ClosedError;
use crate::file_error::{FileError, from_file_error};
use crate::place::LookupError;
use sightlines::eye_to_cell::ViewError;

/// Why `query` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// An invalid direction, angle or aspect ratio of the view.
    #[error("{option}: {source}")]
    View { option: &'static str, source: ViewError },
    /// An angle of view without a direction.
    #[error("--fov, --aspect and --up need --dir: without it the viewer looks all round")]
    LensWithoutDirection,
    /// A portal or a door that the table does not have.
    #[error(transparent)]
    Closed(#[from] ClosedError),
}

from_file_error!(Error);
