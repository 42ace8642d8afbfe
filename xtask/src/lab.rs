//! The programs of the lab: charts of speed against accuracy, and sweeps that push methods to where they fail.

use crate::step::{self, Failure, cargo, root};
use std::path::Path;

/// Runs one of them with options of its own.
pub(crate) fn run(program: &str, options: &[String]) -> Result<(), Failure> {
    let mut command = cargo();
    command.args(["run", "--release", "-p", "sightlines-lab", "--bin", program, "--"]).args(options);
    step::run(&mut command)
}

/// The short form of a program, with its results in a folder that is thrown away.
fn quick(program: &str) -> Result<(), Failure> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), Into::into);
    let out = Path::new(&target).join("lab").join(program);
    run(program, &["--quick".to_owned(), "--out".to_owned(), out.display().to_string()])
}

/// Charts, in short: that they can be measured and drawn.
pub(crate) fn quick_charts() -> Result<(), Failure> {
    quick("chart")
}

/// Sweeps, in short: that no shipped method hides anything, and that the naive ones do.
pub(crate) fn quick_stability() -> Result<(), Failure> {
    quick("stability")
}
