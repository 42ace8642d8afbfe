//! Cheap checks of the text of the sources, beside rustfmt and clippy.

use crate::step::{self, Failure, cargo, root};
use crate::{circles, unused};
use std::fs;
use std::path::{Path, PathBuf};

/// Above this a file is worth a thought.
const LONG: usize = 400;
/// Above this it must be split.
const TOO_LONG: usize = 800;

/// What must not stand in a source, and why. Written in two halves, so that this file may stand.
const UNFINISHED: [(&str, &str, &str); 7] = [
    ("todo", "!(", "is not written yet"),
    ("unimplemented", "!(", "is not written yet"),
    ("#[ign", "ore", "is a test that does not run"),
    ("```ign", "ore", "is an example that does not run"),
    ("FIX", "ME", "waits to be mended"),
    ("XX", "X", "waits to be mended"),
    ("with_ca", "ses(", "hides PROPTEST_CASES"),
];

/// Checks formatting, lints and texts.
pub(crate) fn tidy() -> Result<(), Failure> {
    step::run(cargo().args(["fmt", "--all", "--check"]))?;
    texts()?;
    circles::refuse()?;
    unused::refuse()?;
    let clippy = ["clippy", "--workspace", "--all-targets", "--features", step::FULL_PROGRAM, "--", "-D", "warnings"];
    step::run(cargo().args(clippy))
}

fn texts() -> Result<(), Failure> {
    let mut files = Vec::new();
    for folder in ["crates", "shaders", "tests", "benches", "lab", "manuals", "xtask", "integrations", "python"] {
        collect(&root().join(folder), &mut files)?;
    }
    files.sort();
    let mut n_found = 0;
    for path in &files {
        let text = fs::read_to_string(path).map_err(|error| Failure::File { path: path.clone(), error })?;
        let name = path.strip_prefix(root()).unwrap_or(path).display();
        let n_lines = text.lines().count();
        if n_lines > LONG {
            eprintln!("{name}: {n_lines} lines{}", if n_lines > TOO_LONG { ", too long" } else { "" });
        }
        n_found += usize::from(n_lines > TOO_LONG);
        for (line, what) in unfinished(&text) {
            eprintln!("{name}:{line}: {what}");
            n_found += 1;
        }
    }
    eprintln!("{} source files looked through", files.len());
    if n_found == 0 && !files.is_empty() {
        Ok(())
    } else {
        Err(Failure::Found { what: "defects in source texts", n: n_found })
    }
}

/// Rust sources below `folder`, without build outputs.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let failure = |error| Failure::File { path: folder.to_path_buf(), error };
    for entry in fs::read_dir(folder).map_err(failure)? {
        let path = entry.map_err(failure)?.path();
        if path.is_dir() && !path.ends_with("target") {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Lines, from 1, that say that something is unfinished.
fn unfinished(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        for (start, end, why) in UNFINISHED {
            let word = format!("{start}{end}");
            if content.contains(&word) {
                found.push((line, format!("`{word}` {why}")));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unfinished_work_is_found_where_it_is() {
        for (start, end, _) in UNFINISHED {
            let text = format!("fn f() {{\n    {start}{end}\n}}\n");
            let found = unfinished(&text);
            assert_eq!(found.len(), 1, "{start}{end}");
            assert_eq!(found[0].0, 2);
        }
        assert!(unfinished("fn finished() {}\n").is_empty());
    }

    #[test]
    fn this_file_is_among_those_looked_through() {
        let mut files = Vec::new();
        collect(&root().join("xtask"), &mut files).expect("xtask is readable");
        assert!(files.iter().any(|f| f.ends_with("xtask/src/tidy.rs")));
    }
}
