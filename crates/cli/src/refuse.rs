//! Options that mean nothing for a file.

use crate::error::{Result, anyhow};
use sightlines::bake::Meaningless;
use std::path::Path;

/// Refuses the first of the given options, which are meant for something else.
pub(crate) fn refuse(
    path: &Path,
    given: &[(&'static str, bool)],
    meant: &'static str,
    found: &'static str,
) -> Result<()> {
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(is_for(path, option, meant, found)),
        None => Ok(()),
    }
}

/// The same of an option of a request, by the name that the program has for it.
pub(crate) fn meaningless(path: &Path, Meaningless { option, meant, found }: Meaningless) -> anyhow::Error {
    let option = match option {
        "carry" => "--no-carry".to_owned(),
        option => format!("--{}", option.replace('_', "-")),
    };
    is_for(path, &option, meant, found)
}

/// An option that means nothing for what a file holds.
pub(crate) fn is_for(path: &Path, option: &str, meant: &str, found: &str) -> anyhow::Error {
    anyhow!("{}: {option} is for {meant}, and this is {found}", path.display())
}
