//! A GPU for the tests: that of the machine, or one in software, unpacked from the distribution's packages.

use crate::debian::{self, in_file};
use crate::step::{self, Failure, cargo, root, typed};
use clap::ValueEnum;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{fmt, fs};

/// Which GPU is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum Wish {
    /// The machine's; else one in software, if it is to be had; else none.
    #[default]
    Auto,
    /// None: tests that need one say that they did not run.
    Off,
    /// As auto, but it is an error if there is none.
    Require,
    /// SwiftShader, from Debian's package of Chromium.
    Swiftshader,
    /// Lavapipe, from the distribution's packages of Mesa.
    Lavapipe,
}

/// Why there is no GPU.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Missing {
    /// Neither one of the machine nor one in software.
    All,
    /// Packages were unpacked, and what was wanted is not in them.
    Driver { name: &'static str },
    /// What was unpacked does not work here.
    Broken { name: &'static str },
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str(
                "there is no GPU, and software in its place is fetched on Debian and Ubuntu only; elsewhere, install a \
                 Vulkan driver, or use --gpu off",
            ),
            Self::Driver { name } => write!(f, "the packages that should have {name} do not have it"),
            Self::Broken { name } => write!(f, "{name} was unpacked, and finds no adapter"),
        }
    }
}

impl std::error::Error for Missing {}

impl From<Missing> for Failure {
    fn from(missing: Missing) -> Self {
        Self::Unavailable(missing.into())
    }
}

/// The variable that says to tests whether they need a GPU.
const VARIABLE: &str = "SIGHTLINES_GPU";

type Environment = Vec<(&'static str, OsString)>;

/// Variables for programs that are to find the GPU.
pub(crate) fn environment(wish: Wish) -> Result<Environment, Failure> {
    let required = |mut found: Environment| {
        found.push((VARIABLE, "require".into()));
        found
    };
    match wish {
        Wish::Off => Ok(vec![(VARIABLE, "off".into())]),
        Wish::Swiftshader => software(SWIFTSHADER, &probe()?).map(required),
        Wish::Lavapipe => software(LAVAPIPE, &probe()?).map(required),
        Wish::Auto | Wish::Require => match find() {
            Ok(found) => Ok(required(found)),
            Err(failure) if wish == Wish::Auto => {
                eprintln!("!! {failure}: the tests on a GPU WILL NOT RUN");
                Ok(vec![(VARIABLE, "off".into())])
            }
            Err(failure) => Err(failure),
        },
    }
}

/// The machine's, or the first one in software that works.
fn find() -> Result<Environment, Failure> {
    let probe = probe()?;
    if finds_adapter(&probe, &[]) {
        return Ok(Vec::new());
    }
    for driver in [SWIFTSHADER, LAVAPIPE] {
        match software(driver, &probe) {
            Ok(found) => return Ok(found),
            Err(Failure::NoDebian) => break,
            Err(failure) => eprintln!("{}: {failure}", driver.name),
        }
    }
    Err(Missing::All.into())
}

/// A driver in software.
#[derive(Clone, Copy)]
struct Driver {
    name: &'static str,
    /// Fills the folder.
    fetch: fn(&Path) -> Result<(), Failure>,
}

const SWIFTSHADER: Driver = Driver { name: "SwiftShader", fetch: fetch_swiftshader };
const LAVAPIPE: Driver = Driver { name: "Lavapipe", fetch: fetch_lavapipe };

/// The description that Vulkan's loader finds a driver by, in the driver's folder, and the folder with the libraries.
const DESCRIPTION: &str = "driver.json";
const LIBRARIES: &str = "lib";

/// Variables for a driver below `target/gpu`, which is fetched if it is not there.
fn software(driver: Driver, probe: &Path) -> Result<Environment, Failure> {
    let folder = root().join("target").join("gpu").join(driver.name.to_lowercase());
    if !folder.join(DESCRIPTION).is_file() {
        // Unpacked beside, so that what is there is complete.
        let work = folder.with_extension("part");
        if work.exists() {
            in_file(&work, fs::remove_dir_all(&work))?;
        }
        in_file(&work, fs::create_dir_all(work.join(LIBRARIES)))?;
        (driver.fetch)(&work)?;
        if folder.exists() {
            in_file(&folder, fs::remove_dir_all(&folder))?;
        }
        in_file(&folder, fs::rename(&work, &folder))?;
    }
    let found = variables(&folder);
    let works = finds_adapter(probe, &found);
    if works { Ok(found) } else { Err(Missing::Broken { name: driver.name }.into()) }
}

fn variables(folder: &Path) -> Environment {
    let description = folder.join(DESCRIPTION).into_os_string();
    let mut libraries = folder.join(LIBRARIES).into_os_string();
    if let Some(others) = std::env::var_os("LD_LIBRARY_PATH").filter(|v| !v.is_empty()) {
        libraries.push(":");
        libraries.push(others);
    }
    vec![
        ("LD_LIBRARY_PATH", libraries),
        ("VK_DRIVER_FILES", description.clone()),
        // For loaders that do not know the new name.
        ("VK_ICD_FILENAMES", description),
    ]
}

/// One package, and three files of it.
fn fetch_swiftshader(work: &Path) -> Result<(), Failure> {
    const FOLDER: &str = "./usr/lib/chromium/";
    const FILES: [&str; 2] = ["libvk_swiftshader.so", "libvulkan.so.1"];
    debian::download(work, &["chromium-common"])?;
    let package = packages(work)?.pop().ok_or(Missing::Driver { name: SWIFTSHADER.name })?;
    debian::unpack_some(&package, work, &FILES.map(|file| format!("{FOLDER}{file}")))?;
    for file in FILES {
        let (from, to) = (work.join(FOLDER).join(file), work.join(LIBRARIES).join(file));
        in_file(&from, fs::rename(&from, &to))?;
    }
    describe(work, &format!("{LIBRARIES}/{}", FILES[0]), "1.0.5")?;
    clean(work)
}

/// The driver, the loader, and all libraries that the system lacks.
fn fetch_lavapipe(work: &Path) -> Result<(), Failure> {
    const LIBRARY: &str = "libvulkan_lvp.so";
    // All that is missing, and the two that are needed in any case, to have them here.
    let missing = debian::missing(work, &["mesa-vulkan-drivers", "libvulkan1"])?;
    let wanted = missing.iter().map(String::as_str).chain(["mesa-vulkan-drivers", "libvulkan1"]);
    let wanted: std::collections::BTreeSet<&str> = wanted.collect();
    debian::download(work, &wanted.into_iter().collect::<Vec<_>>())?;
    let unpacked = work.join("unpacked");
    for package in packages(work)? {
        debian::unpack(&package, &unpacked)?;
    }
    // Everything from the folder that Debian keeps a processor's libraries in.
    let libraries = debian::files(&unpacked.join("usr/lib"))?.into_iter().find(|f| f.join(LIBRARY).is_file());
    let libraries = libraries.ok_or(Missing::Driver { name: LAVAPIPE.name })?;
    for from in debian::files(&libraries)? {
        let to = work.join(LIBRARIES).join(from.file_name().expect("an entry has a name"));
        in_file(&from, fs::rename(&from, &to))?;
    }
    in_file(&unpacked, fs::remove_dir_all(&unpacked))?;
    describe(work, &format!("{LIBRARIES}/{LIBRARY}"), "1.1.0")?;
    clean(work)
}

/// Writes the description; paths in it that have a slash are relative to it.
fn describe(work: &Path, library: &str, version: &str) -> Result<(), Failure> {
    let text = format!(
        "{{\"file_format_version\": \"1.0.0\", \"ICD\": {{\"library_path\": \"./{library}\", \"api_version\": \"{version}\"}}}}\n"
    );
    let path = work.join(DESCRIPTION);
    in_file(&path, fs::write(&path, text))
}

fn packages(work: &Path) -> Result<Vec<PathBuf>, Failure> {
    Ok(debian::files(work)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "deb")).collect())
}

/// Leaves the description and the libraries.
fn clean(work: &Path) -> Result<(), Failure> {
    for path in debian::files(work)? {
        if !path.ends_with(DESCRIPTION) && !path.ends_with(LIBRARIES) {
            in_file(&path, if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) })?;
        }
    }
    Ok(())
}

/// Builds the program that looks for an adapter, as part of what the tests build.
fn probe() -> Result<PathBuf, Failure> {
    let mut command = cargo();
    command.args(["build", "--workspace", "--example", "probe", "--message-format", "json-render-diagnostics"]);
    let output = step::output(&mut command)?;
    let found = output.lines().rev().find_map(executable);
    found.map(PathBuf::from).ok_or(Failure::Found { what: "programs that look for a GPU", n: 0 })
}

/// The path in a line of cargo's, such as `{"reason":"compiler-artifact",…,"executable":"/…/probe",…}`.
fn executable(line: &str) -> Option<String> {
    let (_, rest) = line.split_once("\"executable\":\"")?;
    let (path, _) = rest.split_once('"')?;
    Some(path.replace("\\\\", "\\"))
}

/// Whether the program finds an adapter with these variables. Says which.
fn finds_adapter(probe: &Path, variables: &[(&'static str, OsString)]) -> bool {
    let mut command = Command::new(probe);
    command.envs(variables.iter().cloned()).stderr(Stdio::null());
    let Ok(output) = command.output() else { return false };
    if output.status.success() {
        eprintln!("{}: {}", typed(&command), String::from_utf8_lossy(&output.stdout).trim());
    }
    output.status.success()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_wish_nothing_is_looked_for() {
        assert_eq!(environment(Wish::Off).expect("it needs nothing"), [("SIGHTLINES_GPU", OsString::from("off"))]);
    }

    #[test]
    fn the_program_is_found_in_what_cargo_says() {
        let line = r#"{"reason":"compiler-artifact","filenames":["/x/probe"],"executable":"/x/probe","fresh":true}"#;
        assert_eq!(executable(line).as_deref(), Some("/x/probe"));
        assert_eq!(executable(r#"{"executable":"C:\\x\\probe.exe"}"#).as_deref(), Some("C:\\x\\probe.exe"));
        assert_eq!(executable(r#"{"reason":"compiler-artifact","executable":null}"#), None);
    }

    #[test]
    fn a_driver_is_named_by_both_variables() {
        let found = variables(Path::new("/d"));
        let of = |name| found.iter().find(|(n, _)| *n == name).map(|(_, value)| value.to_string_lossy().into_owned());
        assert_eq!(of("VK_DRIVER_FILES").as_deref(), Some("/d/driver.json"));
        assert_eq!(of("VK_DRIVER_FILES"), of("VK_ICD_FILENAMES"));
        assert!(of("LD_LIBRARY_PATH").is_some_and(|v| v.starts_with("/d/lib")));
    }
}
