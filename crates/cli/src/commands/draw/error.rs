//! Why `draw` fails.

use crate::error::InputError;
use crate::error::OutputError;
use crate::picture::PictureError;
use crate::place::LookupError;
use std::path::PathBuf;

/// Why `draw` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// An input that is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A cell or a point that the table does not have.
    #[error(transparent)]
    Lookup(#[from] LookupError),
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A floor plan of which nobody said where it lies.
    #[error("{}: a floor plan of a scene in space needs --height (cells reach from {low} to {high}), --eye or --cell; \
             without, there is --isometric", path.display())]
    WhichHeight { path: PathBuf, low: f64, high: f64 },
}
