//! Why `query` fails.

use crate::file_error::{FileError, from_file_error};
use crate::place::LookupError;
use crate::sight::SightError;

/// Why `query` fails; exit code 2.
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
}

from_file_error!(Error);
