//! Options that mean nothing for a file.

use crate::error::InputError;
use sightlines::bake::Meaningless;
use std::path::Path;

/// Refuses the first of the given options, which are meant for something else.
pub(crate) fn refuse(
    path: &Path,
    given: &[(&'static str, bool)],
    meant: &'static str,
    found: &'static str,
) -> Result<(), InputError> {
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            Err(InputError::Option { path: path.to_owned(), option: (*option).to_owned(), meant, found })
        }
        None => Ok(()),
    }
}

/// The same of an option of a request, by the name that the program has for it.
pub(crate) fn meaningless(path: &Path, Meaningless { option, meant, found }: Meaningless) -> InputError {
    let option = match option {
        "carry" => "--no-carry".to_owned(),
        option => format!("--{}", option.replace('_', "-")),
    };
    InputError::Option { path: path.to_owned(), option, meant, found }
}
