//! Running other programs, and what can go wrong with them.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::{fmt, io};

/// Why a task failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A program could not be started.
    Start { program: String, error: io::Error },
    /// A program ended with something else than success.
    Status { command: String, status: ExitStatus },
    /// A file or folder could not be read or written.
    File { path: PathBuf, error: io::Error },
    /// A check found something; it has been printed.
    Found { what: &'static str, n: usize },
    /// The tests failed, and their summary is to be the last line.
    Tests,
    /// Packages are wanted, and this is no Debian.
    NoDebian,
    /// Something that this machine lacks could not be fetched either.
    Unavailable(Box<dyn std::error::Error>),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start { program, error } => write!(f, "cannot start {program}: {error}"),
            Self::Status { command, status } => write!(f, "{command}: {status}"),
            Self::File { path, error } => write!(f, "{}: {error}", path.display()),
            Self::Found { what, n } => write!(f, "{n} {what}"),
            Self::Tests => f.write_str("tests failed"),
            Self::NoDebian => f.write_str("there are no apt-get and dpkg here"),
            Self::Unavailable(missing) => missing.fmt(f),
        }
    }
}

/// The features of the program that are off by default, as an option of a command on the whole workspace.
pub(crate) const FULL_PROGRAM: &str = "sightlines-cli/png,sightlines-cli/gpu";

/// The folder of the workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace")
}

/// The cargo that runs this program, in the folder of the workspace.
pub(crate) fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root());
    command
}

/// A command as one would type it, without its environment.
pub(crate) fn typed(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|w| w.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Says what is run on standard error.
pub(crate) fn announce(command: &Command) {
    eprintln!("$ {}", typed(command));
}

/// Runs a command to its end, with this program's input and output.
pub(crate) fn run(command: &mut Command) -> Result<(), Failure> {
    announce(command);
    run_silently(command)
}

/// Runs a command to its end without saying so: one of many.
pub(crate) fn run_silently(command: &mut Command) -> Result<(), Failure> {
    let status = command.status().map_err(|error| start_failure(command, error))?;
    if status.success() { Ok(()) } else { Err(Failure::Status { command: typed(command), status }) }
}

/// Runs a command to its end, and returns what it writes to its standard output.
pub(crate) fn output(command: &mut Command) -> Result<String, Failure> {
    announce(command);
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| start_failure(command, error))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(Failure::Status { command: typed(command), status: output.status })
    }
}

pub(crate) fn start_failure(command: &Command, error: io::Error) -> Failure {
    Failure::Start { program: command.get_program().to_string_lossy().into_owned(), error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_name_the_command() {
        let mut command = cargo();
        command.args(["no-such-command", "--at-all"]).stderr(std::process::Stdio::null());
        let failure = run(&mut command).expect_err("cargo has no such command").to_string();
        assert!(failure.starts_with("cargo no-such-command --at-all: "), "{failure}");
        let failure = run(&mut Command::new("no-such-program-anywhere")).expect_err("there is none").to_string();
        assert!(failure.starts_with("cannot start no-such-program-anywhere: "), "{failure}");
    }
}
