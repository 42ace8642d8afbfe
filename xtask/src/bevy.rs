//! The plugin for Bevy, a workspace of its own below `integrations/bevy`, and the one for Quake maps in Bevy beside it.

use crate::debian::in_file;
use crate::gpu::{self, Wish};
use crate::step::{self, Failure, cargo, root};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What its tests read: name, and how the scene is generated.
const FOR_TESTS: [(&str, &[&str]); 2] =
    [("small", &["--floors", "1", "--rooms-x", "2", "--rooms-y", "2"]), ("tower", &["--floors", "2"])];

/// What only its examples read.
const FOR_EXAMPLES: [(&str, &[&str]); 1] = [("tower16", &["--floors", "16"])];

fn folder() -> PathBuf {
    root().join("integrations").join("bevy")
}

fn quake_folder() -> PathBuf {
    root().join("integrations").join("bevy-trenchbroom")
}

/// Generates the levels of the tests and examples, with their tables, by the program.
pub(crate) fn assets() -> Result<(), Failure> {
    let all: Vec<_> = FOR_TESTS.into_iter().chain(FOR_EXAMPLES).collect();
    make(&all)
}

fn make(levels: &[(&str, &[&str])]) -> Result<(), Failure> {
    let folder = folder().join("assets");
    in_file(&folder, fs::create_dir_all(&folder))?;
    for (name, options) in levels {
        let file = |ending: &str| folder.join(name).with_extension(ending);
        let (scene, table, packed) = (file("glb"), file("pvs"), file("pvz"));
        let words = ["generate", "tower", "-q", "-o", text(&scene)];
        program(&[&words, *options].concat())?;
        program(&["build", "-q", text(&scene), "-o", text(&table)])?;
        program(&["pack", "-q", text(&table), "-o", text(&packed)])?;
    }
    Ok(())
}

/// The table of the real building that pictures are compared in, if the folder of real data is there.
fn make_real() -> Result<(), Failure> {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("!! SIGHTLINES_DATA has no folder: pictures of a real building WILL NOT be compared");
        return Ok(());
    };
    let (scene, table) =
        (Path::new(&data).join("scenes/office_a/office_a.glb"), folder().join("assets").join("office.pvs"));
    program(&["build", "-q", text(&scene), "-o", text(&table)])
}

fn text(path: &Path) -> &str {
    path.to_str().expect("the folder of the project has a name in Unicode")
}

fn program(words: &[&str]) -> Result<(), Failure> {
    step::run(cargo().args(["run", "--quiet", "--release", "-p", "sightlines-cli", "--"]).args(words))
}

/// The cargo that runs this program, in the folder of the plugin, without what the cargo of this workspace has set for it.
fn plugin() -> Command {
    plugin_in(folder())
}

fn plugin_in(folder: PathBuf) -> Command {
    let mut command = cargo();
    command.current_dir(folder).env_remove("CARGO_TARGET_DIR");
    command
}

/// The device that pictures are compared on: Lavapipe unless another one was named. SwiftShader, which is tried first elsewhere, loses triangles that
/// are a millimetre from the eye.
fn device(gpu: Wish) -> Result<Vec<(&'static str, OsString)>, Failure> {
    match gpu {
        Wish::Auto | Wish::Require => gpu::environment(Wish::Lavapipe).or_else(|failure| {
            eprintln!("!! Lavapipe: {failure}: on SwiftShader pictures of a real building WILL NOT be compared");
            gpu::environment(gpu)
        }),
        named => gpu::environment(named),
    }
}

/// Formatting, lints and tests of the plugin, with the versions of its own lock file.
///
/// * `gpu`: which device the tests that compare pictures run on
pub(crate) fn check(gpu: Wish) -> Result<(), Failure> {
    make(&FOR_TESTS)?;
    make_real()?;
    step::run(plugin().args(["fmt", "--check"]))?;
    let lints = ["--", "-D", "warnings"];
    step::run(plugin().args(["clippy", "--locked", "--all-targets", "--all-features"]).args(lints))?;
    step::run(plugin().args(["clippy", "--locked", "--lib"]).args(lints))?;
    let device = device(gpu)?;
    step::run(plugin().args(["test", "--locked", "--all-features"]).envs(device))
}

/// Formatting, lints and tests of the plugin for Quake maps: no part of the gate, as it compiles Bevy once more.
///
/// * `gpu`: which device the test that compares pictures runs on
pub(crate) fn check_quake(gpu: Wish) -> Result<(), Failure> {
    match std::env::var_os("SIGHTLINES_DATA") {
        None => eprintln!("!! SIGHTLINES_DATA has no folder: pictures of a real map WILL NOT be compared"),
        Some(data) => {
            let (map, assets) = (Path::new(&data).join("quake/e1m1.bsp"), quake_folder().join("assets"));
            in_file(&assets, fs::create_dir_all(&assets))?;
            program(&["build", "-q", text(&map), "-o", text(&assets.join("e1m1.pvs"))])?;
        }
    }
    let cargo = || plugin_in(quake_folder());
    step::run(cargo().args(["fmt", "--check"]))?;
    step::run(cargo().args(["clippy", "--locked", "--all-targets", "--", "-D", "warnings"]))?;
    let device = device(gpu)?;
    step::run(cargo().args(["test", "--locked"]).envs(device))
}
