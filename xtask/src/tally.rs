//! Running all tests and adding up what they say.

use crate::freedoom;
use crate::gpu::{self, Wish};
use crate::groups::{GROUPS, Group, Modules};
use crate::programs::{Environment, Program, compiled};
use crate::step::{FULL_PROGRAM, Failure, announce, cargo, start_failure, typed};
use std::ffi::OsString;
use std::fmt;
use std::io::{BufRead, BufReader, Write};
use std::process::Command;

/// What all test programs said together.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Tally {
    passed: usize,
    failed: usize,
    ignored: usize,
    /// Test programs that came to an end, and the seconds that each ran.
    programs: Vec<(String, f64)>,
    /// The program that runs.
    running: String,
    /// Tests that passed without having looked at anything, for want of a GPU.
    without_gpu: usize,
}

/// What a test says on a line of its own if it needs a GPU and there is none.
const WITHOUT_GPU: &str = "GPU test not run: ";

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed", self.passed, self.failed)
    }
}

impl Tally {
    /// Adds a line of output, if it is a result such as
    /// `test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s`.
    fn add(&mut self, line: &str) {
        self.without_gpu += usize::from(line.starts_with(WITHOUT_GPU));
        // `   Doc-tests sightlines_pvs`
        if let Some(name) = line.trim_start().strip_prefix("Doc-tests ") {
            self.running = format!("{} (examples in the documentation)", name.trim_end());
        }
        // A program without a line break at the end of its output puts its result behind it.
        let Some((_, result)) = line.split_once("test result: ") else { return };
        let number = |what: &str| {
            let words: Vec<&str> = result.split([' ', ';', '.']).filter(|w| !w.is_empty()).collect();
            words.windows(2).find(|pair| pair[1] == what).and_then(|pair| pair[0].parse::<usize>().ok())
        };
        let (Some(passed), Some(failed), Some(ignored)) = (number("passed"), number("failed"), number("ignored"))
        else {
            return;
        };
        self.passed += passed;
        self.failed += failed;
        self.ignored += ignored;
        let seconds = line.rsplit("finished in ").next().and_then(|t| t.trim_end().strip_suffix('s')?.parse().ok());
        self.programs.push((self.running.clone(), seconds.unwrap_or(0.0)));
    }

    /// The programs that ran longest, at most `n`, the slowest one first.
    fn slowest(&self, n: usize) -> Vec<(&str, f64)> {
        let mut programs: Vec<_> = self.programs.iter().map(|(name, seconds)| (name.as_str(), *seconds)).collect();
        programs.sort_by(|a, b| b.1.total_cmp(&a.1));
        programs.truncate(n);
        programs
    }

    /// Takes in how a command ended that was begun when `failed_before` tests had failed: a failure without a failed test is a build that
    /// broke, or a test program that ended before its result.
    fn close(&mut self, success: bool, failed_before: usize) {
        if !success && self.failed == failed_before {
            eprintln!("xtask: {} failed, though no test did: a build or a test program broke off", self.running);
            self.failed += 1;
        }
    }

    /// How many tests came to an end.
    fn n_run(&self) -> usize {
        self.passed + self.failed
    }

    pub(crate) fn has_failed(&self) -> bool {
        self.failed > 0
    }

    /// Whether this is what a finished project shows: tests, none failed, none left out.
    fn is_good(&self) -> bool {
        self.passed > 0 && self.failed == 0 && self.ignored == 0
    }

    /// Prints the summary as the last line.
    pub(crate) fn conclude(self) -> Result<(), Failure> {
        if self.ignored > 0 {
            println!("{} ignored, which counts as a failure", self.ignored);
        }
        if self.without_gpu > 0 {
            println!("{} GPU tests did not run, and count as passed; see --gpu", self.without_gpu);
        }
        println!("{self}");
        if self.is_good() { Ok(()) } else { Err(Failure::Tests) }
    }
}

/// Runs all tests, or those of the core, with all parts of the program; shows their output, adds up the results, and prints the slowest programs.
///
/// Examples are compiled by the lints, and not again here.
///
/// * `gpu`: which device the tests on one are run on
/// * `left_out`: groups whose modules are left out
pub(crate) fn test(gpu: Wish, left_out: &[Group], tally: &mut Tally) -> Result<(), Failure> {
    let environment = environment(gpu)?;
    for program in compiled(&environment, &["--tests"])? {
        let modules = left_out.iter().flat_map(Group::modules).filter(|of| of.is_of(&program));
        let skip: Vec<&str> = modules.flat_map(|of| of.modules).flat_map(|module| ["--skip", module]).collect();
        run_program(&program, &environment, &skip, tally)?;
    }
    let mut documentation = cargo();
    documentation.args(["test", "--workspace", "--no-fail-fast", "--features", FULL_PROGRAM, "--doc"]);
    documentation.envs(environment.iter().map(|(name, value)| (name, value)));
    announce(&documentation);
    run(documentation, tally)?;
    println!("\n{} test programs; the slowest ones:", tally.programs.len());
    for (name, seconds) in tally.slowest(10) {
        println!("{seconds:8.1} s  {name}");
    }
    Ok(())
}

/// Runs the tests of the core.
pub(crate) fn core(gpu: Wish, tally: &mut Tally) -> Result<(), Failure> {
    test(gpu, &GROUPS, tally)
}

/// Runs modules of test programs, which the core leaves out.
pub(crate) fn modules(modules: &[Modules], gpu: Wish, tally: &mut Tally) -> Result<(), Failure> {
    let environment = environment(gpu)?;
    for of_program in modules {
        for program in compiled(&environment, &["--test", of_program.program])? {
            if of_program.is_of(&program) {
                let before = tally.n_run();
                run_program(&program, &environment, of_program.modules, tally)?;
                if tally.n_run() == before {
                    return Err(Failure::Found { what: "tests in the modules of a group", n: 0 });
                }
            }
        }
    }
    Ok(())
}

/// What tests find their devices and their data by.
fn environment(gpu: Wish) -> Result<Vec<(&'static str, OsString)>, Failure> {
    let mut environment = gpu::environment(gpu)?;
    for (name, value) in &environment {
        eprintln!("{name}={}", value.to_string_lossy());
    }
    if let Some(folder) = freedoom::at_hand() {
        eprintln!("{}={}", freedoom::VARIABLE, folder.display());
        environment.push((freedoom::VARIABLE, folder.into_os_string()));
    }
    // Everything is compiled at once, so incremental builds would cost more than they save; and each crate as one unit, which makes tests quicker.
    for (name, value) in [("CARGO_INCREMENTAL", "0"), ("CARGO_PROFILE_DEV_CODEGEN_UNITS", "1")] {
        if std::env::var_os(name).is_none() {
            environment.push((name, value.into()));
        }
    }
    Ok(environment)
}

fn run_program(
    program: &Program,
    environment: &Environment,
    options: &[&str],
    tally: &mut Tally,
) -> Result<(), Failure> {
    tally.running = format!("{} ({})", program.name, program.source);
    run(program.command(environment, options), tally)
}

/// Runs a command of tests, shows all its output on standard output, and adds up the results.
fn run(mut command: Command, tally: &mut Tally) -> Result<(), Failure> {
    let typed = typed(&command);
    let failed_before = tally.failed;
    let failure = |error| Failure::Start { program: typed.clone(), error };
    // One pipe for both: the names of programs are on standard error, their results on standard output.
    let (output, input) = std::io::pipe().map_err(failure)?;
    command.stdout(input.try_clone().map_err(failure)?).stderr(input);
    let mut child = command.spawn().map_err(|error| start_failure(&command, error))?;
    // The command holds the ends that are written to; the output ends when all of them are closed.
    drop(command);
    let mut output = BufReader::new(output);
    let mut line = Vec::new();
    while output.read_until(b'\n', &mut line).is_ok_and(|n| n > 0) {
        // A closed pipe behind us must not stop the tests.
        let _ = std::io::stdout().write_all(&line);
        tally.add(&String::from_utf8_lossy(&line));
        line.clear();
    }
    let status = child.wait().map_err(failure)?;
    tally.close(status.success(), failed_before);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(lines: &[&str]) -> Tally {
        let mut tally = Tally::default();
        lines.iter().for_each(|line| tally.add(line));
        tally
    }

    #[test]
    fn results_are_added_up() {
        let sum = tally(&[
            "running 3 tests",
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s\n",
            "   Doc-tests sightlines_pvs\n",
            "noisetest result: FAILED. 10 passed; 2 failed; 1 ignored; 0 measured; 0 filtered out; finished in 2.50s",
            "test result: who knows",
            "GPU test not run: forms of any size: SIGHTLINES_GPU=off",
        ]);
        let names = ["", "sightlines_pvs (examples in the documentation)"];
        assert_eq!(sum.slowest(9), [(names[1], 2.5), (names[0], 0.01)]);
        assert_eq!((sum.passed, sum.failed, sum.ignored, sum.without_gpu), (13, 2, 1, 1));
        assert_eq!(sum.to_string(), "13 passed, 2 failed");
        assert!(!sum.is_good());
    }

    #[test]
    fn nothing_ignored_and_broken_are_no_success() {
        assert!(!Tally::default().is_good(), "no tests at all");
        let good = Tally { passed: 5, ..Tally::default() };
        assert!(good.is_good());
        assert!(!Tally { ignored: 1, ..good.clone() }.is_good());
        let mut broken = good;
        broken.close(false, 0);
        assert_eq!((broken.failed, broken.is_good()), (1, false));
    }
}
