//! Running all tests and adding up what they say.

use crate::freedoom;
use crate::gpu::{self, Wish};
use crate::step::{Failure, announce, cargo, start_failure};
use std::fmt;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

/// What all test programs said together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Tally {
    passed: usize,
    failed: usize,
    ignored: usize,
    /// Test programs that came to an end.
    programs: usize,
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
        self.programs += 1;
    }

    /// Takes in how cargo ended: a failure without a failed test is a build that broke, or a test
    /// program that ended before its result.
    fn close(&mut self, success: bool) {
        if !success && self.failed == 0 {
            eprintln!("xtask: cargo test failed, though no test did: a build or a test program broke off");
            self.failed = 1;
        }
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

/// Runs `cargo test --workspace`, shows its output, and adds up the results.
///
/// * `gpu`: which device the tests on one are run on
pub(crate) fn test(gpu: Wish) -> Result<Tally, Failure> {
    let mut command = cargo();
    for (name, value) in gpu::environment(gpu)? {
        eprintln!("{name}={}", value.to_string_lossy());
        command.env(name, value);
    }
    command.args(["test", "--workspace", "--no-fail-fast"]).stdout(Stdio::piped());
    if let Some(folder) = freedoom::at_hand() {
        eprintln!("{}={}", freedoom::VARIABLE, folder.display());
        command.env(freedoom::VARIABLE, folder);
    }
    announce(&command);
    let mut child = command.spawn().map_err(|error| start_failure(&command, error))?;
    let mut tally = Tally::default();
    let mut output = BufReader::new(child.stdout.take().expect("standard output is piped"));
    let mut line = Vec::new();
    while output.read_until(b'\n', &mut line).is_ok_and(|n| n > 0) {
        // A closed pipe behind us must not stop the tests.
        let _ = std::io::stdout().write_all(&line);
        tally.add(&String::from_utf8_lossy(&line));
        line.clear();
    }
    let status = child.wait().map_err(|error| start_failure(&command, error))?;
    tally.close(status.success());
    println!("\n{} test programs", tally.programs);
    Ok(tally)
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
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s",
            "noisetest result: FAILED. 10 passed; 2 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.01s",
            "test result: who knows",
            "GPU test not run: forms of any size: SIGHTLINES_GPU=off",
        ]);
        assert_eq!(sum, Tally { passed: 13, failed: 2, ignored: 1, programs: 2, without_gpu: 1 });
        assert_eq!(sum.to_string(), "13 passed, 2 failed");
        assert!(!sum.is_good());
    }

    #[test]
    fn nothing_ignored_and_broken_are_no_success() {
        assert!(!Tally::default().is_good(), "no tests at all");
        let good = Tally { passed: 5, ..Tally::default() };
        assert!(good.is_good());
        assert!(!Tally { ignored: 1, ..good }.is_good());
        let mut broken = good;
        broken.close(false);
        assert_eq!((broken.failed, broken.is_good()), (1, false));
    }
}
