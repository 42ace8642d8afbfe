//! Circles of files: modules of one crate that use each other.
//!
//! A parent and its child may use each other. Of two modules beside each other, with all that lies below them, only one
//! may use the other, also by way of third ones: else none of them can be read, tested or moved alone.
//!
//! Paths are found in the text and followed by `mod` declarations, imports and re-exports to the file that defines what
//! they name. What macros make and methods that are called are not seen. What is compiled for unit tests only
//! (`#[cfg(test)]`) does not count.

mod lex;
mod program;
mod resolve;

use crate::step::{Failure, root};
use program::Program;
use resolve::{Use, uses};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::{fmt, fs, io};

/// Modules beside each other that use each other.
#[derive(Debug, PartialEq, Eq)]
struct Circle {
    /// Their names below the crate, `a::b`.
    members: Vec<String>,
    /// For each two of which one uses the other: who, whom, the first place, and how many there are.
    uses: Vec<(String, String, String, usize)>,
}

impl fmt::Display for Circle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "circle of modules {}", self.members.join(", "))?;
        for (from, to, place, n) in &self.uses {
            write!(f, "\n    {from} uses {to}: {place}")?;
            if *n > 1 {
                write!(f, " and {} more", n - 1)?;
            }
        }
        Ok(())
    }
}

/// Prints the circles of every program of the workspace; it is a failure if there is one, or no program at all.
pub(crate) fn refuse() -> Result<(), Failure> {
    let mut packages: Vec<PathBuf> = ["shaders", "tests", "benches", "lab", "xtask"].map(|p| root().join(p)).into();
    packages.extend(entries(&root().join("crates"))?);
    packages.sort();
    let (mut n_found, mut n_files) = (0, 0);
    for package in packages {
        for start in roots(&package)? {
            let program = Program::read(&start, &|path| fs::read_to_string(path).ok());
            n_files += program.files.len();
            let name = start.strip_prefix(root()).unwrap_or(&start).display();
            for circle in circles(&program) {
                eprintln!("{name}: {circle}");
                n_found += 1;
            }
        }
    }
    eprintln!("{n_found} circles of modules in {n_files} files");
    if n_found == 0 && n_files > 0 { Ok(()) } else { Err(Failure::Found { what: "circles of modules", n: n_found }) }
}

/// The root files of the programs and libraries of a package.
fn roots(package: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut found: Vec<PathBuf> = ["src/lib.rs", "src/main.rs"].map(|p| package.join(p)).into();
    for folder in ["src/bin", "tests", "benches", "examples"] {
        for path in entries(&package.join(folder))? {
            found.push(if path.is_dir() { path.join("main.rs") } else { path });
        }
    }
    found.retain(|path| path.is_file() && path.extension().is_some_and(|e| e == "rs"));
    Ok(found)
}

/// What lies in a folder, in order; nothing if there is no such folder.
pub(crate) fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failure = |error| Failure::File { path: folder.to_path_buf(), error };
    let listed = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        listed => listed.map_err(failure)?,
    };
    let paths: Result<Vec<PathBuf>, _> = listed.map(|entry| entry.map(|e| e.path())).collect();
    let mut paths = paths.map_err(failure)?;
    paths.sort();
    Ok(paths)
}

/// The identifiers and keywords of a source, without those in comments and strings.
pub(crate) fn words(text: &str) -> BTreeSet<String> {
    lex::tokens(text).iter().filter(|token| token.is_word()).map(|token| token.text.to_owned()).collect()
}

/// Uses between modules beside each other: by one, of another.
type Edges<'a> = BTreeMap<(&'a str, &'a str), Vec<Use>>;

/// All circles of a program.
///
/// Uses are gathered by the parent that two files have in common: there they count between two children of it, with all
/// below these. A use of an ancestor or a descendant counts nowhere.
fn circles(program: &Program) -> Vec<Circle> {
    let mut by_parent: BTreeMap<&[String], Edges<'_>> = BTreeMap::new();
    for used in uses(program) {
        let (from, to) = (&program.files[used.from].module, &program.files[used.to].module);
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if let (Some(a), Some(b)) = (from.get(common), to.get(common)) {
            by_parent.entry(&from[..common]).or_default().entry((a, b)).or_default().push(used);
        }
    }
    let mut found = Vec::new();
    for (parent, edges) in by_parent {
        let reach = reach(edges.keys().copied());
        let mut done = BTreeSet::new();
        for (&member, reached) in &reach {
            let others = reached.iter().filter(|other| reach.get(*other).is_some_and(|back| back.contains(member)));
            let members: BTreeSet<&str> = others.copied().collect();
            if members.is_empty() || !done.insert(members.clone()) {
                continue;
            }
            let name = |member: &str| parent.iter().map(|p| &p[..]).chain([member]).collect::<Vec<_>>().join("::");
            let inside = edges.iter().filter(|((a, b), _)| members.contains(a) && members.contains(b));
            let uses = inside.map(|((a, b), uses)| (name(a), name(b), place(program, &uses[0]), uses.len()));
            found.push(Circle { members: members.iter().map(|m| name(m)).collect(), uses: uses.collect() });
        }
    }
    found
}

fn place(program: &Program, used: &Use) -> String {
    let path = &program.files[used.from].path;
    let path = path.strip_prefix(root()).unwrap_or(path).display();
    format!("{path}:{}: {}", used.line, used.path)
}

/// For each node with a way out, all that ways lead to.
fn reach<'a>(edges: impl Iterator<Item = (&'a str, &'a str)>) -> BTreeMap<&'a str, BTreeSet<&'a str>> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (a, b) in edges {
        next.entry(a).or_default().insert(b);
    }
    let from = |start: &'a str| {
        let (mut found, mut stack) = (BTreeSet::new(), vec![start]);
        while let Some(node) = stack.pop() {
            stack.extend(next.get(node).into_iter().flatten().filter(|to| found.insert(**to)));
        }
        found
    };
    next.keys().map(|start| (*start, from(start))).collect()
}

#[cfg(test)]
mod tests;
