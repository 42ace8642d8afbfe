//! Why `draw` fails.

use crate::file_error::{FileError, from_file_error};
use crate::place::LookupError;
use crate::sight::SightError;
use std::path::PathBuf;

/// Why `draw` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// There is no such view.
    #[error(transparent)]
    Sight(#[from] SightError),
    /// A view without an eye.
    #[error("{0} is of a viewer: give --eye")]
    SightWithoutEye(&'static str),
    /// A floor plan without a height.
    #[error("{}: a floor plan of a scene in space needs --height (cells reach from {low} to {high}), --eye or --cell; \
             without, there is --isometric", path.display())]
    WhichHeight { path: PathBuf, low: f64, high: f64 },
    /// A scene that the table was not made of.
    #[error("{}: the table was made of another scene: {what}", .path.display())]
    OtherScene { path: PathBuf, what: String },
}

from_file_error!(Error);
