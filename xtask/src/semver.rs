//! Public items against those of the last release.

use crate::deny::is_installed;
use crate::metadata;
use crate::step::{self, Failure, cargo, root};
use std::process::Command;

/// Lets cargo-semver-checks compare each published library with the one of the last tag. Says so where there is no tag or no such
/// program.
pub(crate) fn check() -> Result<(), Failure> {
    let tags = step::output(Command::new("git").current_dir(root()).args([
        "tag",
        "--list",
        "v*",
        "--merged",
        "HEAD",
        "--sort=-version:refname",
    ]))?;
    let Some(tag) = tags.lines().next() else {
        eprintln!("!! there is no tag of a release: public items WILL NOT be compared with one");
        return Ok(());
    };
    if !is_installed("cargo-semver-checks") {
        eprintln!("!! cargo-semver-checks is not installed: public items WILL NOT be compared with those of {tag}");
        return Ok(());
    }
    let packages = metadata::published()?;
    let names = packages.iter().flat_map(|p| ["--package", &p.name]);
    step::run(cargo().args(["semver-checks", "--baseline-rev", tag]).args(names))
}
