//! Options that mean nothing for a file.

use crate::error::InputError;
use std::path::Path;

/// Refuses the first of the given options, which are meant for something else.
pub(crate) fn refuse(
    path: &Path,
    given: &[(&'static str, bool)],
    meant: &'static str,
    found: &'static str,
) -> Result<(), InputError> {
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(InputError::Option { path: path.to_owned(), option, meant, found }),
        None => Ok(()),
    }
}
