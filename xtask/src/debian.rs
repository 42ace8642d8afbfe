//! Packages of Debian and its relatives, downloaded and unpacked without installing them.

use crate::step::{self, Failure, announce, start_failure};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fs, io};

pub(crate) fn in_file<T>(path: &Path, result: io::Result<T>) -> Result<T, Failure> {
    result.map_err(|error| Failure::File { path: path.to_path_buf(), error })
}

/// Lets apt-get download packages into `work`; where its lists know none, with fresh lists of our own.
pub(crate) fn download(work: &Path, packages: &[&str]) -> Result<(), Failure> {
    let words = [&["download"], packages].concat();
    match run_quietly(apt_get(work, &[]).args(&words)) {
        Err(Failure::Status { .. }) => run_quietly(apt_get(work, &own_lists(work)?).args(&words)),
        other => other,
    }
}

/// The names of `packages` and all that they need, without those that the system has.
pub(crate) fn missing(work: &Path, packages: &[&str]) -> Result<Vec<String>, Failure> {
    let words = [&["--print-uris", "-oDebug::NoLocking=1", "--no-install-recommends", "install"], packages].concat();
    let output = match step::output(apt_get(work, &[]).args(&words)) {
        Err(Failure::Status { .. }) => step::output(apt_get(work, &own_lists(work)?).args(&words)),
        other => other,
    };
    Ok(output.map_err(no_debian)?.lines().filter_map(named).map(str::to_owned).collect())
}

/// The package in a line such as `'http://…/libz_1.2_amd64.deb' libz_1.2_amd64.deb 80000 SHA256:…`.
fn named(line: &str) -> Option<&str> {
    let (_, file) = line.strip_prefix('\'')?.split_once("' ")?;
    file.split(' ').next()?.strip_suffix(".deb")?.split('_').next()
}

fn apt_get(work: &Path, options: &[String]) -> Command {
    let mut command = Command::new("apt-get");
    // As root it would want a user of its own to be able to write here.
    command.current_dir(work).args(["-q", "-y", "-oAPT::Sandbox::User=root"]).args(options);
    command
}

/// Options with which apt-get has its lists below `work`, fetched if they are not there.
fn own_lists(work: &Path) -> Result<[String; 2], Failure> {
    let (lists, cache) = (work.join("lists"), work.join("cache"));
    let options =
        [("State::Lists", &lists), ("Cache", &cache)].map(|(name, path)| format!("-oDir::{name}={}", path.display()));
    if !lists.is_dir() {
        for folder in [lists.join("partial"), cache.join("archives/partial")] {
            in_file(&folder, fs::create_dir_all(&folder))?;
        }
        run_quietly(apt_get(work, &options).arg("update"))?;
    }
    Ok(options)
}

/// Unpacks all of a package below `folder`.
pub(crate) fn unpack(package: &Path, folder: &Path) -> Result<(), Failure> {
    run_quietly(Command::new("dpkg").arg("-x").arg(package).arg(folder))
}

/// Unpacks some files of a package below `folder`; their names begin with `./`. The rest is not even written.
pub(crate) fn unpack_some(package: &Path, folder: &Path, names: &[String]) -> Result<(), Failure> {
    let mut reader = Command::new("dpkg");
    reader.arg("--fsys-tarfile").arg(package).stdout(Stdio::piped());
    announce(&reader);
    let mut child = reader.spawn().map_err(|error| no_debian(start_failure(&reader, error)))?;
    let archive = child.stdout.take().expect("standard output is piped");
    let unpacked = run_quietly(Command::new("tar").arg("-xC").arg(folder).args(names).stdin(archive));
    let status = child.wait().map_err(|error| start_failure(&reader, error))?;
    unpacked?;
    if status.success() { Ok(()) } else { Err(Failure::Status { command: step::typed(&reader), status }) }
}

/// What lies in a folder, sorted.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = in_file(folder, fs::read_dir(folder))?.map(|entry| in_file(folder, entry).map(|e| e.path()));
    let mut paths = entries.collect::<Result<Vec<_>, _>>()?;
    paths.sort();
    Ok(paths)
}

/// Runs a command with its output on standard error: ours is for those who use it.
fn run_quietly(command: &mut Command) -> Result<(), Failure> {
    step::run(command.stdout(io::stderr())).map_err(no_debian)
}

fn no_debian(failure: Failure) -> Failure {
    match failure {
        Failure::Start { error, .. } if error.kind() == io::ErrorKind::NotFound => Failure::NoDebian,
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_recognised_by_their_lines() {
        let line = "'http://deb.debian.org/pool/x/libx_1%3a2_amd64.deb' libx-11_1%3a2_amd64.deb 5 SHA256:00";
        assert_eq!(named(line), Some("libx-11"));
        for other in ["Reading package lists...", "'http://host/file' file 5", "", "'x' "] {
            assert_eq!(named(other), None, "{other}");
        }
    }

    #[test]
    fn a_program_that_is_not_there_means_another_system() {
        let failure = run_quietly(&mut Command::new("no-such-program-anywhere")).expect_err("there is none");
        assert!(matches!(failure, Failure::NoDebian), "{failure}");
    }
}
