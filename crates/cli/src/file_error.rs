//! What every command has in common in its errors.

use crate::error::{InputError, OutputError};
use crate::picture::PictureError;
use sightlines::formats::ReadError;

/// A file cannot be read, is not what a command takes, or cannot be written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FileError {
    /// A file that the command cannot use.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A result that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A picture that cannot be drawn or written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl From<ReadError> for FileError {
    fn from(error: ReadError) -> Self {
        Self::Input(error.into())
    }
}

/// Lets `?` make the error of a command, in its variant `File`, of whatever makes a [`FileError`].
macro_rules! from_file_error {
    ($error:ident) => {
        impl<E: Into<$crate::file_error::FileError>> From<E> for $error {
            fn from(error: E) -> Self {
                Self::File(error.into())
            }
        }
    };
}

pub(crate) use from_file_error;
