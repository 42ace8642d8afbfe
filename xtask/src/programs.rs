//! Test programs of the workspace: compiled by Cargo, run one by one, so that each can leave out modules of its own.

use crate::step::{FULL_PROGRAM, Failure, announce, cargo, output, root};
use serde_json::Value;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Variables for compilers and tests.
pub(crate) type Environment = [(&'static str, OsString)];

/// A compiled test program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Program {
    /// The name that `cargo test --test` takes, or that of a library or program with unit tests.
    pub(crate) name: String,
    /// Where its source begins, from the folder of the workspace.
    pub(crate) source: String,
    /// Whether it is one that `cargo test --test` takes.
    pub(crate) is_integration: bool,
    file: PathBuf,
    /// The folder of its package, in which it is run.
    folder: PathBuf,
}

/// Compiles test programs, with the features of all tests, so that nothing is compiled twice however few are asked for.
///
/// * `targets`: options of Cargo that say which
pub(crate) fn compiled(environment: &Environment, targets: &[&str]) -> Result<Vec<Program>, Failure> {
    let mut command = cargo();
    command.args(["test", "--workspace", "--features", FULL_PROGRAM, "--no-run"]).args(targets);
    command.arg("--message-format=json-render-diagnostics").envs(environment.iter().map(|(name, value)| (name, value)));
    let mut programs = parse(&output(&mut command)?, root());
    programs.sort_by(|a, b| (&a.folder, &a.source).cmp(&(&b.folder, &b.source)));
    if programs.is_empty() { Err(Failure::Found { what: "test programs", n: 0 }) } else { Ok(programs) }
}

fn parse(messages: &str, root: &Path) -> Vec<Program> {
    messages.lines().filter_map(|line| program(&serde_json::from_str(line).ok()?, root)).collect()
}

fn program(message: &Value, root: &Path) -> Option<Program> {
    if message["reason"] != "compiler-artifact" || message["profile"]["test"] != true {
        return None;
    }
    let path = |value: &Value| value.as_str().map(PathBuf::from);
    let (target, source) = (&message["target"], path(&message["target"]["src_path"])?);
    Some(Program {
        name: target["name"].as_str()?.to_owned(),
        source: source.strip_prefix(root).unwrap_or(&source).display().to_string(),
        is_integration: target["kind"].as_array()?.iter().any(|kind| kind == "test"),
        file: path(&message["executable"])?,
        folder: path(&message["manifest_path"])?.parent()?.to_path_buf(),
    })
}

impl Program {
    /// The command that runs it as `cargo test` would; says so.
    ///
    /// * `options`: its own options, and what the names of tests contain
    pub(crate) fn command(&self, environment: &Environment, options: &[&str]) -> Command {
        let mut command = Command::new(&self.file);
        command.current_dir(&self.folder).args(options).envs(environment.iter().map(|(name, value)| (name, value)));
        command.env("CARGO_MANIFEST_DIR", &self.folder);
        announce(&command);
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_those_that_cargo_names() {
        let messages = r#"{"reason":"compiler-artifact","manifest_path":"/w/a/Cargo.toml","target":{"kind":["lib"],"name":"a","src_path":"/w/a/src/lib.rs"},"profile":{"test":false},"executable":null}
{"reason":"compiler-artifact","manifest_path":"/w/a/Cargo.toml","target":{"kind":["lib"],"name":"a","src_path":"/w/a/src/lib.rs"},"profile":{"test":true},"executable":"/w/target/debug/deps/a-1"}
{"reason":"compiler-artifact","manifest_path":"/w/a/Cargo.toml","target":{"kind":["test"],"name":"all","src_path":"/w/a/tests/all/main.rs"},"profile":{"test":true},"executable":"/w/target/debug/deps/all-2"}
{"reason":"compiler-artifact","manifest_path":"/w/a/Cargo.toml","target":{"kind":["bin"],"name":"p","src_path":"/w/a/src/main.rs"},"profile":{"test":false},"executable":"/w/target/debug/p"}
{"reason":"build-finished","success":true}"#;
        let found = parse(messages, Path::new("/w"));
        let names: Vec<_> = found.iter().map(|p| (p.name.as_str(), p.source.as_str(), p.is_integration)).collect();
        assert_eq!(names, [("a", "a/src/lib.rs", false), ("all", "a/tests/all/main.rs", true)]);
        assert_eq!(found[1].folder, Path::new("/w/a"));
    }
}
