//! What a change has to pass, in order.

use crate::gpu::Wish;
use crate::groups::{self, Group, Step, Why, Work};
use crate::step::{self, Failure, cargo};
use crate::tally::{self, Tally};
use crate::{bevy, deny, lab, metadata, package, proofs, python, tidy, wasm};
use std::fs;
use std::io::ErrorKind;
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

/// What the core takes on two quiet cores. How much longer it takes says how busy the machine is.
const CORE: Duration = Duration::from_secs(1020);
/// After this a group is begun only if it must run.
const LATE: Duration = Duration::from_secs(40 * 60);

/// The core and the groups that are chosen, up to the first failure. Ends with the times, with what did not run and why, and with the sum of the tests.
///
/// * `gpu`: which device the tests on one are run on
/// * `plan`: what becomes of each group
pub(crate) fn ci(gpu: Wish, mut plan: Vec<(Group, Why)>) -> Result<(), Failure> {
    print(&plan);
    let start = Instant::now();
    let mut times = Vec::new();
    type Part = (&'static str, fn() -> Result<(), Failure>);
    let parts: [Part; 4] = [("tidy", tidy::tidy), ("deny", deny::check), ("docs", docs), ("demo", demo)];
    for (name, part) in parts {
        timed(name, &mut times, part)?;
    }
    let mut tally = Tally::default();
    timed("test", &mut times, || tally::core(gpu, &mut tally))?;
    let core = start.elapsed();
    // Those that must run are first, so that what is left out on a busy machine is left out at the end. What needs the most room comes after all that
    // needs what the core has built.
    plan.sort_by_key(|(group, why)| (is_bevy(group.work), !why.must()));
    for (group, why) in &mut plan {
        if !why.runs() || tally.has_failed() {
            continue;
        }
        if !why.must() && is_late(start.elapsed(), core, group.seconds) {
            eprintln!("\n== {}: left out, as this machine is busy", group.name);
            *why = Why::Late;
            continue;
        }
        if is_bevy(group.work) && std::env::var_os("CI").is_some() {
            make_room()?;
        }
        timed(group.name, &mut times, || run(group, gpu, &mut tally))?;
    }
    print(&plan);
    for (name, time) in times {
        println!("{name:>10} {:6.1} s", time.as_secs_f64());
    }
    println!("{:>10} {:6.1} s", "all", start.elapsed().as_secs_f64());
    tally.conclude()
}

fn is_bevy(work: Work) -> bool {
    matches!(work, Work::Step(Step::Bevy))
}

/// Removes the tests that have run: nobody comes back to them, and Bevy's need as much room again.
fn make_room() -> Result<(), Failure> {
    let folder = package::target().join("debug");
    eprintln!("\nremoves {}", folder.display());
    match fs::remove_dir_all(&folder) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Failure::File { path: folder, error }),
        _ => Ok(()),
    }
}

/// Whether a group that takes `seconds` on a quiet machine would end too late on this one.
///
/// * `core`: how long the core took here
fn is_late(elapsed: Duration, core: Duration, seconds: u32) -> bool {
    let slower = (core.as_secs_f64() / CORE.as_secs_f64()).max(1.0);
    elapsed + Duration::from_secs(seconds.into()).mul_f64(slower) > LATE
}

/// Runs the group of this name alone, and ends with the sum of its tests if it has any.
pub(crate) fn group(name: &str, gpu: Wish) -> Result<(), Failure> {
    let Some(group) = groups::GROUPS.iter().find(|group| group.name == name) else {
        let names: Vec<_> = groups::GROUPS.iter().map(|group| group.name).collect();
        eprintln!("the groups are {}", names.join(", "));
        return Err(Failure::Found { what: "groups of this name", n: 0 });
    };
    let mut tally = Tally::default();
    run(group, gpu, &mut tally)?;
    if group.modules().is_empty() { Ok(()) } else { tally.conclude() }
}

/// Runs one group.
fn run(group: &Group, gpu: Wish, tally: &mut Tally) -> Result<(), Failure> {
    match group.work {
        Work::Tests(modules) => tally::modules(modules, gpu, tally),
        Work::Step(Step::Alone) => alone(),
        Work::Step(Step::Package) => package::check(),
        Work::Step(Step::Program) => default_program(),
        Work::Step(Step::Benches) => benches_once(),
        Work::Step(Step::Lab) => lab::quick_stability().and_then(|()| lab::quick_charts()),
        Work::Step(Step::Python) => python::check(false),
        Work::Step(Step::Bevy) => bevy::check(gpu),
        Work::Step(Step::Wasm) => wasm::check(),
        Work::Step(Step::Proofs) => proofs::check(),
    }
}

/// Prints which groups run, which do not, and why.
pub(crate) fn print(plan: &[(Group, Why)]) {
    for (group, why) in plan {
        println!("{} {:>10}: {why} ({})", if why.runs() { "runs " } else { "waits" }, group.name, group.what);
    }
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

    #[test]
    fn what_would_end_too_late_is_left_out() {
        let minutes = |n: u64| Duration::from_secs(60 * n);
        assert!(!is_late(minutes(25), CORE, 300));
        assert!(is_late(minutes(38), CORE, 300));
        // A machine that is quicker than it was measured takes no longer; a busy one does.
        assert!(!is_late(minutes(30), CORE / 2, 590));
        assert!(is_late(minutes(32), CORE * 2, 300));
    }
}
