//! The Python package, a workspace of its own below `python`: wheel, types, tests.

use crate::debian::in_file;
use crate::package;
use crate::step::{self, Failure, cargo, root};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The oldest Python that the package runs on.
const OLDEST: [u32; 2] = [3, 10];

/// The folder of the package.
pub(crate) fn folder() -> PathBuf {
    root().join("python")
}

/// Where the virtual environment and the wheels are.
fn outputs() -> PathBuf {
    package::target().join("python")
}

/// The cargo that runs this program, in the folder of the package, without what the cargo of this workspace has set for it.
fn package_cargo() -> Command {
    let mut command = cargo();
    command.current_dir(folder()).env_remove("CARGO_TARGET_DIR");
    command
}

/// Formatting, lints, wheel, types and tests of the package, in a virtual environment that is made anew. What cannot run here is said and left
/// out: without a Python, or with one that gets no packages, nothing is built; with both, everything has to pass.
///
/// * `release`: tests the wheel that would be offered for download, optimized, and makes the source distribution too
pub(crate) fn check(release: bool) -> Result<(), Failure> {
    step::run(package_cargo().args(["fmt", "--check"]))?;
    let Some(python) = environment()? else {
        eprintln!("!! the Python package WILL NOT be built or tested");
        return Ok(());
    };
    step::run(package_cargo().args(["clippy", "--locked", "--all-targets", "--", "-D", "warnings"]))?;
    let wheels = outputs().join("wheels");
    if wheels.is_dir() {
        in_file(&wheels, fs::remove_dir_all(&wheels))?;
    }
    let profile: &[&str] = if release { &["--release", "--sdist"] } else { &["--profile", "dev"] };
    let build = ["-m", "maturin", "build", "--quiet", "--locked", "--out"];
    step::run(in_package(&python).args(build).arg(&wheels).arg("--interpreter").arg(&python).args(profile))?;
    let wheel = only_wheel(&wheels)?;
    let install = ["-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--force-reinstall"];
    step::run(in_package(&python).args(install).arg(&wheel))?;
    step::run(in_package(&python).args(["-m", "mypy"]))?;
    let stubs = ["-m", "mypy.stubtest", "--mypy-config-file", "pyproject.toml", "sightlines._native"];
    step::run(in_package(&python).args(stubs))?;
    step::run(in_package(&python).args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]))?;
    let size = in_file(&wheel, fs::metadata(&wheel))?.len();
    eprintln!("{}: {:.1} MB", wheel.display(), size as f64 / 1e6);
    Ok(())
}

/// A program of the environment, in the folder of the package; it writes nothing there.
fn in_package(python: &Path) -> Command {
    let mut command = Command::new(python);
    command.current_dir(folder()).env_remove("CARGO_TARGET_DIR").env("MPLBACKEND", "Agg");
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("PIP_DISABLE_PIP_VERSION_CHECK", "1");
    command.env("MYPY_CACHE_DIR", outputs().join("mypy"));
    command
}

/// The Python of a new virtual environment with all that builds and tests need; none, and why is said, if it cannot be had.
fn environment() -> Result<Option<PathBuf>, Failure> {
    let venv = outputs().join("venv");
    let is_new = format!("import sys, venv, ensurepip; sys.exit(sys.version_info < ({}, {}))", OLDEST[0], OLDEST[1]);
    if !succeeds(Command::new("python3").args(["-c", &is_new]).stderr(Stdio::null())) {
        eprintln!("!! there is no python3, it is older than {}.{}, or lacks venv", OLDEST[0], OLDEST[1]);
        return Ok(None);
    }
    in_file(&outputs(), fs::create_dir_all(outputs()))?;
    let python = venv.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if step::run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv)).is_err() {
        eprintln!("!! python3 makes no virtual environment");
        return Ok(None);
    }
    let install = ["-m", "pip", "install", "--quiet", "--only-binary", ":all:", "-r", "requirements-test.txt"];
    if step::run(in_package(&python).args(install)).is_err() {
        eprintln!("!! pip gets no packages: PyPI is out of reach, or has no wheels for this machine");
        return Ok(None);
    }
    Ok(Some(python))
}

fn succeeds(command: &mut Command) -> bool {
    command.status().is_ok_and(|status| status.success())
}

/// The wheel in a folder that was just filled.
fn only_wheel(folder: &Path) -> Result<PathBuf, Failure> {
    let mut found = Vec::new();
    for entry in in_file(folder, fs::read_dir(folder))? {
        let path = in_file(folder, entry)?.path();
        if path.extension().is_some_and(|ending| ending == "whl") {
            found.push(path);
        }
    }
    match found.len() {
        1 => Ok(found.remove(0)),
        n => Err(Failure::Found { what: "wheels where there should be one", n }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wheel_is_found_and_none_or_two_are_a_failure() {
        let folder = std::env::temp_dir().join(format!("sightlines-wheels-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder is made");
        only_wheel(&folder).expect_err("it is empty");
        fs::write(folder.join("a.tar.gz"), "").expect("a file is written");
        fs::write(folder.join("a.whl"), "").expect("a file is written");
        assert_eq!(only_wheel(&folder).expect("there is one"), folder.join("a.whl"));
        fs::write(folder.join("b.whl"), "").expect("a file is written");
        only_wheel(&folder).expect_err("there are two");
        fs::remove_dir_all(&folder).expect("it is removed");
    }

    #[test]
    fn the_oldest_python_is_that_of_the_package() {
        let text = fs::read_to_string(folder().join("pyproject.toml")).expect("it is readable");
        let [major, minor] = OLDEST;
        assert!(text.contains(&format!("requires-python = \">={major}.{minor}\"")), "{text}");
        assert!(text.contains(&format!("pyo3/abi3-py{major}{minor}")), "{text}");
    }
}
