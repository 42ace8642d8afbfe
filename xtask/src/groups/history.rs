//! What git knows of recent changes, and whose turn it is.

use crate::debian::in_file;
use crate::step::{Failure, root};
use std::fs;
use std::process::Command;

/// How far back a change still counts, in commits.
pub(super) const WINDOW: usize = 100;

/// The file with the number of the turn, which is raised before a change is handed in.
const TURN: &str = ".ci/turn";

/// The files that recent commits changed, the newest first.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    commits: Vec<Vec<String>>,
}

impl History {
    /// The last commits and, before them, what is not committed yet. None without git, or in a clone that lacks its past.
    pub(super) fn read() -> Option<Self> {
        if git(&["rev-parse", "--is-shallow-repository"])?.trim() != "false" {
            return None;
        }
        let count = format!("-{WINDOW}");
        let log = git(&["log", &count, "--format=%x00", "--name-only", "--no-renames", "-c"])?;
        let uncommitted = git(&["status", "--porcelain", "--no-renames", "--untracked-files=all"])?;
        let mut history = Self::parse(&log);
        history.commits.insert(0, uncommitted.lines().filter_map(|line| line.get(3..)).map(str::to_owned).collect());
        Some(history)
    }

    fn parse(log: &str) -> Self {
        let commits = log.split('\0').skip(1);
        let files = |text: &str| text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect();
        Self { commits: commits.map(files).collect() }
    }

    /// How many commits ago a file was last changed for which `concerns` holds, and which file that was.
    pub(super) fn last(&self, concerns: impl Fn(&str) -> bool) -> Option<(usize, &str)> {
        let found = |(ago, files): (usize, &'_ Vec<String>)| {
            let at = files.iter().position(|file| concerns(file))?;
            Some((ago, at))
        };
        let (ago, at) = self.commits.iter().enumerate().find_map(found)?;
        Some((ago, &self.commits[ago][at]))
    }

    #[cfg(test)]
    pub(super) fn of(commits: &[&[&str]]) -> Self {
        Self { commits: commits.iter().map(|files| files.iter().map(|&file| file.to_owned()).collect()).collect() }
    }
}

/// The number of the turn: the one in [`TURN`], and the commits since it was raised, so that turns go on if it is forgotten.
pub(super) fn turn() -> Result<usize, Failure> {
    let path = root().join(TURN);
    let text = in_file(&path, fs::read_to_string(&path))?;
    let stated: usize = text.trim().parse().map_err(|_| Failure::Found { what: "numbers in .ci/turn", n: 0 })?;
    Ok(stated + since_raised().unwrap_or(0))
}

/// How many commits there are since the turn was raised.
fn since_raised() -> Option<usize> {
    let raised = git(&["log", "-1", "--format=%H", "--", TURN])?;
    let range = format!("{}..HEAD", raised.trim());
    git(&["rev-list", "--count", &range])?.trim().parse().ok()
}

fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).current_dir(root()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_sorted_by_commit() {
        let history = History::parse("\0\n\ncrates/a/src/x.rs\nREADME.md\n\0\n\0\n\ncrates/b/src/y.rs\n");
        assert_eq!(history.last(|file| file.ends_with("x.rs")), Some((0, "crates/a/src/x.rs")));
        assert_eq!(history.last(|file| file.starts_with("crates/b")), Some((2, "crates/b/src/y.rs")));
        assert_eq!(history.last(|file| file == "z"), None);
    }

    #[test]
    fn this_history_is_read() {
        if git(&["rev-parse", "HEAD"]).is_none() {
            eprintln!("SKIPPED: there is no git here");
            return;
        }
        turn().expect("the turn is a number");
        if let Some(history) = History::read() {
            assert!(history.last(|file| file.ends_with(".rs")).is_some(), "a hundred commits without Rust");
        }
    }
}
