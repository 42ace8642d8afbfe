//! Tasks of the project: `cargo xtask TASK`.
//!
//! Owns: how tests, benches, documentation and checks are called, and in which order. Depends on
//! nothing of the workspace, so that it builds in seconds and also where the workspace does not.

mod bevy;
mod circles;
mod debian;
mod deny;
mod dist;
mod freedoom;
mod gate;
mod gpu;
mod groups;
mod install;
mod lab;
mod metadata;
mod package;
mod programs;
mod proofs;
mod python;
mod semver;
mod spdx;
mod step;
mod tally;
mod tidy;
mod unused;
mod wasm;

use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use step::{Failure, cargo};

/// Tasks of the sightlines project.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Runs the tests of the core: units, properties, integration, documentation.
    Test {
        /// Which GPU the tests that need one run on.
        #[arg(long, value_enum, default_value_t)]
        gpu: gpu::Wish,
        /// Runs the tests of the heavy groups as well; `ci --plan` lists them.
        #[arg(long)]
        all: bool,
    },
    /// Throws random and mutated input at readers and algorithms.
    Fuzz {
        /// What to fuzz; everything in turn if it is not given.
        #[arg(long)]
        target: Option<String>,
        /// Seconds for each target.
        #[arg(long)]
        seconds: Option<u64>,
        /// Where chance begins, to replay a run.
        #[arg(long)]
        seed: Option<u64>,
        /// Lists the targets and stops; compiles nothing.
        #[arg(long)]
        list: bool,
    },
    /// Runs the benches, all or those whose name contains a filter.
    Bench {
        /// Part of a bench's name.
        filter: Option<String>,
    },
    /// Measures speed against accuracy and draws the charts; `-- --help` has the options.
    Chart {
        /// Options of the program behind it, such as `--quick`, `--only NAME`, `--draw`, `--out DIR`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
        options: Vec<String>,
    },
    /// Pushes methods to where they fail, and draws how often they do; `-- --help` has the options.
    Stability {
        /// Options of the program behind it, such as `--quick`, `--only NAME`, `--draw`, `--out DIR`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
        options: Vec<String>,
    },
    /// Builds the documentation; a warning is an error.
    Docs,
    /// Checks formatting, lints, file lengths, circles of modules, that dependencies are used, and that nothing is left unfinished.
    Tidy,
    /// Lists modules of one crate that use each other; a part of `tidy`.
    Circles,
    /// Lists dependencies that no source names; a part of `tidy`.
    Unused,
    /// Checks that each published crate compiles on its own.
    Alone,
    /// Checks the licences and sources of all dependencies, and with cargo-deny, if it is installed, their advisories.
    Deny,
    /// Compares the table of bounds on rounding with the sources, and lets Gappa prove them.
    Proofs {
        /// Prints how many times each constant is as large as the least that Gappa proves, and stops.
        #[arg(long)]
        least: bool,
    },
    /// Packs the published crates, and compiles them from what is in the packages.
    Package,
    /// Compares public items with those of the last tag, by cargo-semver-checks.
    Semver,
    /// Installs a release in an empty Debian, in two ways, and follows the guides there; needs root, debootstrap and the network.
    InstallCheck {
        /// The folder with the files of a release; they are made first if it is not given.
        #[arg(long)]
        dist: Option<PathBuf>,
    },
    /// Writes the manual pages and completions of the programs.
    Man {
        /// The folder to write into [default: target/manuals].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Makes what a release offers for download: an archive, a package for Debian, a bill of materials, checksums.
    Dist {
        /// The folder to work and write in [default: target/dist].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Runs what a change has to pass: the core, and the heavy groups that recent changes bring or whose turn it is.
    Ci {
        /// Which GPU the tests that need one run on.
        #[arg(long, value_enum, default_value_t)]
        gpu: gpu::Wish,
        /// Runs every group.
        #[arg(long)]
        all: bool,
        /// Prints which groups would run, and why, and stops.
        #[arg(long)]
        plan: bool,
        /// Prints the packages of Debian that the groups which would run need, and stops.
        #[arg(long, conflicts_with = "plan")]
        packages: bool,
    },
    /// Runs one heavy group of the gate.
    Group {
        /// Its name, as `ci --plan` prints it.
        name: String,
        /// Which GPU the tests that need one run on.
        #[arg(long, value_enum, default_value_t)]
        gpu: gpu::Wish,
    },
    /// Finds a GPU, or fetches one in software, and prints the environment that programs find it by.
    Gpu {
        /// Which one.
        #[arg(default_value_t, value_enum)]
        gpu: gpu::Wish,
    },
    /// Finds or fetches the Freedoom WADs and prints their folder.
    Freedoom,
    /// Builds the module of WebAssembly, and the playground, into target/wasm; without a compiler for it, fetches Debian's.
    Wasm,
    /// Formatting, lints and tests of the plugin for Bevy.
    Bevy {
        /// Which GPU the tests that compare pictures run on.
        #[arg(long, value_enum, default_value_t)]
        gpu: gpu::Wish,
    },
    /// Generates the levels that the plugin for Bevy is tested and shown with.
    BevyAssets,
    /// Formatting, lints and tests of the plugin for Quake maps in Bevy, which `ci` leaves out.
    BevyTrenchbroom {
        /// Which GPU the test that compares pictures runs on.
        #[arg(long, value_enum, default_value_t)]
        gpu: gpu::Wish,
    },
    /// Builds the Python package in a virtual environment, and checks and tests it there.
    Python {
        /// Takes the wheel that a release offers, optimized, and makes the source distribution too.
        #[arg(long)]
        release: bool,
    },
}

/// What the fuzzing program can break, one name in each line; a test of that program compares.
const FUZZ_TARGETS: &str = include_str!("../../tests/fuzz-targets.txt");

fn main() -> ExitCode {
    match run(Cli::parse().task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Tests) => ExitCode::FAILURE,
        Err(failure) => {
            eprintln!("xtask: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<(), Failure> {
    match task {
        Task::Test { gpu, all } => {
            let mut tally = tally::Tally::default();
            tally::test(gpu, if all { &[] } else { &groups::GROUPS }, &mut tally)?;
            tally.conclude()
        }
        Task::Fuzz { target, seconds, seed, list } => fuzz(target, seconds, seed, list),
        Task::Bench { filter } => {
            let filter = filter.iter().flat_map(|f| ["--", f]);
            step::run(cargo().args(["bench", "-p", "sightlines-benches"]).args(filter))
        }
        Task::Chart { options } => lab::run("chart", &options),
        Task::Stability { options } => lab::run("stability", &options),
        Task::Docs => gate::docs(),
        Task::Tidy => tidy::tidy(),
        Task::Circles => circles::refuse(),
        Task::Unused => unused::refuse(),
        Task::Alone => gate::alone(),
        Task::Deny => deny::check(),
        Task::Package => package::check(),
        Task::Proofs { least: true } => proofs::print_least(),
        Task::Proofs { least: false } => proofs::check(),
        Task::Semver => semver::check(),
        Task::InstallCheck { dist } => install::check(dist),
        Task::Man { out } => {
            let out = out.unwrap_or_else(|| package::target().join("manuals"));
            step::run(cargo().args(["run", "--quiet", "-p", "sightlines-manuals", "--"]).arg(out))
        }
        Task::Dist { out } => dist::make(out).map(|files| println!("in {}", files.display())),
        Task::Ci { gpu, all, plan, packages } => {
            let chosen = groups::plan(all)?;
            if packages {
                groups::packages(&chosen).iter().for_each(|name| println!("{name}"));
                Ok(())
            } else if plan {
                gate::print(&chosen);
                Ok(())
            } else {
                gate::ci(gpu, chosen)
            }
        }
        Task::Group { name, gpu } => gate::group(&name, gpu),
        Task::Gpu { gpu } => {
            for (name, value) in gpu::environment(gpu)? {
                println!("export {name}={}", value.to_string_lossy());
            }
            Ok(())
        }
        Task::Wasm => wasm::playground(),
        Task::Bevy { gpu } => bevy::check(gpu),
        Task::BevyAssets => bevy::assets(),
        Task::BevyTrenchbroom { gpu } => bevy::check_quake(gpu),
        Task::Python { release } => python::check(release),
        Task::Freedoom => freedoom::find_or_fetch().map(|folder| println!("{}", folder.display())),
    }
}

fn fuzz(target: Option<String>, seconds: Option<u64>, seed: Option<u64>, list: bool) -> Result<(), Failure> {
    if list {
        FUZZ_TARGETS.lines().for_each(|name| println!("{name}"));
        return Ok(());
    }
    let mut command = cargo();
    command.args(["run", "--release", "-p", "sightlines-tests", "--bin", "fuzz", "--"]);
    let numbers = [("--seconds", seconds), ("--seed", seed)];
    let options = [("--target", target)].into_iter().chain(numbers.map(|(name, n)| (name, n.map(|n| n.to_string()))));
    for (name, value) in options {
        command.args(value.iter().flat_map(|v| [name, v]));
    }
    step::run(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
        let Task::Fuzz { seconds, target, list, .. } =
            Cli::parse_from(["xtask", "fuzz", "--target", "wad", "--seconds", "5"]).task
        else {
            panic!("fuzz is a task");
        };
        assert_eq!((seconds, target.as_deref(), list), (Some(5), Some("wad"), false));
        let Task::Stability { options } = Cli::parse_from(["xtask", "stability", "--quick", "--only", "scale"]).task
        else {
            panic!("the stability lab is a task");
        };
        assert_eq!(options, ["--quick", "--only", "scale"]);
        let gpu = |words: &[&str]| match Cli::parse_from(words).task {
            Task::Test { gpu, .. } | Task::Ci { gpu, .. } => gpu,
            other => panic!("{other:?}"),
        };
        assert_eq!(gpu(&["xtask", "test"]), gpu::Wish::Auto);
        assert_eq!(gpu(&["xtask", "ci", "--gpu", "require"]), gpu::Wish::Require);
    }
}
