//! What a change has to pass, in order.

use crate::gpu::Wish;
use crate::step::{self, Failure, cargo};
use crate::{bevy, deny, lab, metadata, package, python, tally, tidy};
use std::time::{Duration, Instant};

/// Builds the documentation of every crate; a warning is an error.
pub(crate) fn docs() -> Result<(), Failure> {
    let features = ["--features", "sightlines/png,sightlines/multifocal-gpu"];
    step::run(cargo().args(["doc", "--no-deps", "--workspace"]).args(features).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Checks each published crate on its own, so that none lives on features that another one turns on.
pub(crate) fn alone() -> Result<(), Failure> {
    for package in metadata::published()? {
        step::run(cargo().args(["check", "-p", &package.name, "--all-features"]))?;
    }
    // Those with features that are off by default, or that can be left out: without them, and the program with each alone.
    for options in [
        &["sightlines"][..],
        &["sightlines-report"],
        &["sightlines-bake"],
        &["sightlines-walkthrough", "--no-default-features"],
        &["sightlines-capi", "--no-default-features"],
        &["sightlines-capi", "--no-default-features", "--features", "packed"],
        &["sightlines-capi", "--no-default-features", "--features", "bake"],
        &["sightlines-cli"],
        &["sightlines-cli", "--features", "png"],
        &["sightlines-cli", "--features", "gpu"],
    ] {
        step::run(cargo().args(["check", "-p"]).args(options))?;
    }
    Ok(())
}

/// Runs a bench of each kind once: that it runs, and that its answer is right.
fn benches_once() -> Result<(), Failure> {
    step::run(cargo().args(["bench", "-p", "sightlines-benches", "--", "--test"]))
}

/// The first command of the README.
fn demo() -> Result<(), Failure> {
    step::run(cargo().args(["run", "--release", "--", "demo"]))
}

/// Tests of the program that take long and know no difference between its features: those on real maps, and those of work that is stopped or shared.
const SAME_WITH_ALL_FEATURES: [&str; 7] = ["real", "resume::", "jobs::", "workers::", "slurm::", "memory::", "tiles::"];

/// The tests of the program as it is installed by default: without the features that the step of all tests turns on.
fn default_program() -> Result<(), Failure> {
    let skipped = SAME_WITH_ALL_FEATURES.iter().flat_map(|name| ["--skip", name]);
    step::run(cargo().args(["test", "--release", "-p", "sightlines-cli", "--test", "cli", "--"]).args(skipped))
}

/// Everything, up to the first failure; the tests last, so that their summary is the last line.
///
/// * `gpu`: which device the tests on one are run on
pub(crate) fn ci(gpu: Wish) -> Result<(), Failure> {
    type Step = (&'static str, fn() -> Result<(), Failure>);
    let steps: [Step; 10] = [
        ("tidy", tidy::tidy),
        ("deny", deny::check),
        ("docs", docs),
        ("alone", alone),
        ("package", package::check),
        ("demo", demo),
        ("program", default_program),
        ("benches", benches_once),
        ("stability", lab::quick_stability),
        ("charts", lab::quick_charts),
    ];
    let mut times = Vec::new();
    for (name, step) in steps {
        timed(name, &mut times, step)?;
    }
    timed("python", &mut times, || python::check(false))?;
    timed("bevy", &mut times, || bevy::check(gpu))?;
    let tally = timed("test", &mut times, || tally::test(gpu))?;
    for (name, time) in times {
        println!("{name:>9} {:6.1} s", time.as_secs_f64());
    }
    tally.conclude()
}

fn timed<T>(
    name: &'static str,
    times: &mut Vec<(&'static str, Duration)>,
    step: impl FnOnce() -> Result<T, Failure>,
) -> Result<T, Failure> {
    eprintln!("\n== {name}");
    let start = Instant::now();
    let result = step();
    let took = start.elapsed();
    eprintln!("== {name}: {} after {:.1} s", if result.is_ok() { "done" } else { "FAILED" }, took.as_secs_f64());
    times.push((name, took));
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_timed_whether_they_pass_or_not() {
        let mut times = Vec::new();
        timed("good", &mut times, || Ok(())).expect("it passes");
        timed("bad", &mut times, || Err::<(), _>(Failure::Found { what: "faults", n: 1 })).expect_err("it fails");
        assert_eq!(times.iter().map(|t| t.0).collect::<Vec<_>>(), ["good", "bad"]);
    }
}
