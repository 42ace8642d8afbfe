//! The Freedoom WADs, real input for the tests: found, or fetched from Debian.

use crate::debian::{self, in_file};
use crate::step::{Failure, root};
use std::path::{Path, PathBuf};
use std::{env, fmt, fs};

/// The environment variable that names the folder with the WADs.
pub(crate) const VARIABLE: &str = "SIGHTLINES_FREEDOOM";
/// The version that the tests speak of.
const VERSION: &str = "0.12.1";
const WADS: [&str; 3] = ["freedoom1.wad", "freedoom2.wad", "freedm.wad"];
const PACKAGES: [&str; 2] = ["freedoom", "freedm"];

/// Why the WADs are not to be had.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Missing {
    /// The named folder lacks one of them.
    Wad { folder: PathBuf, wad: &'static str },
    /// This is no Debian, and they were not named.
    Elsewhere,
    /// The package to be had has another version.
    Version { package: &'static str },
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wad { folder, wad } => write!(f, "there is no {wad} in {}", folder.display()),
            Self::Elsewhere => write!(
                f,
                "fetching Freedoom needs Debian's apt-get and dpkg; elsewhere, put {} of Freedoom {VERSION} into a \
                 folder and name it in {VARIABLE}",
                WADS.join(", ")
            ),
            Self::Version { package } => write!(f, "Debian's package {package} here is not version {VERSION}"),
        }
    }
}

impl std::error::Error for Missing {}

impl From<Missing> for Failure {
    fn from(missing: Missing) -> Self {
        Self::Unavailable(missing.into())
    }
}

fn own_folder() -> PathBuf {
    root().join("target").join("freedoom")
}

/// The first WAD that `folder` lacks.
fn lacking(folder: &Path) -> Option<&'static str> {
    WADS.into_iter().find(|wad| !folder.join(wad).is_file())
}

/// The folder that an earlier fetch filled, unless the environment names one.
pub(crate) fn at_hand() -> Option<PathBuf> {
    let folder = own_folder();
    (env::var_os(VARIABLE).is_none() && lacking(&folder).is_none()).then_some(folder)
}

/// The folder with the three WADs: the one that the environment names, or one filled from Debian.
pub(crate) fn find_or_fetch() -> Result<PathBuf, Failure> {
    if let Some(folder) = env::var_os(VARIABLE).map(PathBuf::from) {
        return complete(folder);
    }
    let folder = own_folder();
    if lacking(&folder).is_some() {
        fetch(&folder).map_err(|failure| match failure {
            Failure::NoDebian => Missing::Elsewhere.into(),
            other => other,
        })?;
    }
    complete(folder)
}

fn complete(folder: PathBuf) -> Result<PathBuf, Failure> {
    match lacking(&folder) {
        None => Ok(folder),
        Some(wad) => Err(Missing::Wad { folder, wad }.into()),
    }
}

/// Downloads and unpacks the packages below `folder`; nothing is installed.
fn fetch(folder: &Path) -> Result<(), Failure> {
    let work = folder.join("packages");
    in_file(&work, fs::create_dir_all(&work))?;
    debian::download(&work, &PACKAGES)?;
    for package in PACKAGES {
        let deb = downloaded(&work, package)?;
        debian::unpack(&deb, &work)?;
    }
    for wad in WADS {
        let (from, to) = (work.join("usr/share/games/doom").join(wad), folder.join(wad));
        in_file(&from, fs::rename(&from, &to))?;
    }
    in_file(&work, fs::remove_dir_all(&work))
}

/// The downloaded file of a package, such as `freedm_0.12.1-2_all.deb`.
fn downloaded(work: &Path, package: &'static str) -> Result<PathBuf, Failure> {
    let found = debian::files(work)?
        .into_iter()
        .find(|path| path.file_name().is_some_and(|name| is_package(&name.to_string_lossy(), package)));
    found.ok_or_else(|| Missing::Version { package }.into())
}

fn is_package(file_name: &str, package: &str) -> bool {
    let version = file_name.strip_suffix(".deb").and_then(|n| n.strip_prefix(package)?.strip_prefix('_'));
    version.is_some_and(|v| v.strip_prefix(VERSION).is_some_and(|rest| rest.starts_with(['-', '_', '+'])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_right_version_counts() {
        assert!(is_package("freedm_0.12.1-2_all.deb", "freedm"));
        assert!(!is_package("freedoom_0.12.1-2_all.deb", "freedm"));
        assert!(!is_package("freedm_0.13.0-1_all.deb", "freedm"));
        assert!(!is_package("freedm_0.12.11-1_all.deb", "freedm"));
        assert!(!is_package("freedm_0.12.1-2_all.deb.part", "freedm"));
    }

    #[test]
    fn an_incomplete_folder_is_named() {
        let failure = complete(root().join("docs")).expect_err("no WADs lie there").to_string();
        assert!(failure.starts_with("there is no freedoom1.wad in "), "{failure}");
    }
}
