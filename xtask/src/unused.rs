//! Dependencies that a manifest lists and no source of its package names.
//!
//! Each costs everyone who compiles the package, and stands in lists of what a crate may use as if it were used. A
//! dependency is used where its name stands as a word in code: of `src` for an ordinary one, of the build script for one of
//! the build. One of the tests may be named by any source, by an example in a comment, or by the README; one that is
//! optional by any source too, as there are no optional ones of tests. Files that `#[path]` brings in belong to the package.

use crate::circles;
use crate::debian::in_file;
use crate::step::{Failure, root};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Folders of packages, and folders in which each folder with a manifest is one.
const PACKAGES: [&str; 7] = ["benches", "lab", "manuals", "python", "shaders", "tests", "xtask"];
const FOLDERS_OF_PACKAGES: [&str; 2] = ["crates", "integrations"];

/// Dependencies that no source names, for a reason: package, dependency, why.
const UNNAMED: [(&str, &str, &str); 2] = [
    ("sightlines-tests", "sightlines-eye-to-cell", "the example in the README of the workspace names it"),
    ("sightlines-tests", "sightlines-walkthrough", "the example in the README of the workspace names it"),
];

/// The words of a package, by what may use them.
#[derive(Debug, Default)]
struct Words {
    src: BTreeSet<String>,
    build: BTreeSet<String>,
    /// Those of all code.
    all: BTreeSet<String>,
    /// Those of comments and of the README.
    texts: BTreeSet<String>,
}

/// Prints the dependencies that nothing names; it is a failure if there is one, or no manifest at all.
pub(crate) fn refuse() -> Result<(), Failure> {
    let mut packages: Vec<PathBuf> = PACKAGES.map(|p| root().join(p)).into();
    for folder in FOLDERS_OF_PACKAGES {
        packages.extend(circles::entries(&root().join(folder))?);
    }
    packages.retain(|package| package.join("Cargo.toml").is_file());
    packages.sort();
    let (mut n_found, mut n_looked) = (0, 0);
    for package in &packages {
        let path = package.join("Cargo.toml");
        let text = in_file(&path, fs::read_to_string(&path))?;
        let manifest: Table = text.parse().map_err(|_| Failure::Found { what: "manifests that are no TOML", n: 1 })?;
        let name = manifest.get("package").and_then(|p| p.get("name")).and_then(Value::as_str).unwrap_or_default();
        let words = words(package)?;
        n_looked += dependencies(&manifest).len();
        for dependency in unused(&manifest, &words) {
            if !UNNAMED.iter().any(|(of, unnamed, _)| *of == name && *unnamed == dependency) {
                eprintln!("{name}: no source names the dependency {dependency}");
                n_found += 1;
            }
        }
    }
    eprintln!("{n_looked} dependencies of {} packages looked for", packages.len());
    if n_found == 0 && n_looked > 0 {
        Ok(())
    } else {
        Err(Failure::Found { what: "dependencies without a use", n: n_found })
    }
}

/// What a dependency is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Ordinary,
    Optional,
    Build,
    Tests,
}

/// The dependencies of a manifest, those of some systems too.
fn dependencies(manifest: &Table) -> Vec<(String, Kind)> {
    let targets = manifest.get("target").and_then(Value::as_table);
    let tables = [manifest].into_iter().chain(targets.into_iter().flat_map(Table::values).filter_map(Value::as_table));
    let mut found = Vec::new();
    for table in tables {
        for (key, kind) in
            [("dependencies", Kind::Ordinary), ("build-dependencies", Kind::Build), ("dev-dependencies", Kind::Tests)]
        {
            let listed = table.get(key).and_then(Value::as_table).into_iter().flatten();
            found.extend(listed.map(|(name, value)| match value.get("optional").and_then(Value::as_bool) {
                Some(true) if kind == Kind::Ordinary => (name.clone(), Kind::Optional),
                _ => (name.clone(), kind),
            }));
        }
    }
    found
}

/// Those that none of the words names that may. A key in a manifest is the name in code, of a renamed package too.
fn unused(manifest: &Table, words: &Words) -> Vec<String> {
    let is_unused = |(name, kind): &(String, Kind)| {
        let word = name.replace('-', "_");
        !match kind {
            Kind::Ordinary => words.src.contains(&word),
            Kind::Optional => words.all.contains(&word),
            Kind::Build => words.build.contains(&word),
            Kind::Tests => words.all.contains(&word) || words.texts.contains(&word),
        }
    };
    dependencies(manifest).into_iter().filter(is_unused).map(|(name, _)| name).collect()
}

/// The words of the package in a folder.
fn words(package: &Path) -> Result<Words, Failure> {
    let mut words = Words::default();
    let mut texts = String::new();
    for folder in ["src", "tests", "benches", "examples", "build.rs"] {
        let mut files = sources(&package.join(folder))?;
        let mut at = 0;
        while let Some(path) = files.get(at).cloned() {
            at += 1;
            let text = in_file(&path, fs::read_to_string(&path))?;
            let brought = brought_in(&text).map(|file| path.with_file_name("").join(file)).filter(|p| p.is_file());
            let brought: Vec<PathBuf> = brought.filter(|path| !files.contains(path)).collect();
            files.extend(brought);
            let found = circles::words(&text);
            match folder {
                "src" => words.src.extend(found.clone()),
                "build.rs" => words.build.extend(found.clone()),
                _ => {}
            }
            words.all.extend(found);
            texts.extend(text.lines().filter(|line| line.trim_start().starts_with("//")).flat_map(|line| [line, "\n"]));
        }
    }
    let readme = package.join("README.md");
    if readme.is_file() {
        texts += &in_file(&readme, fs::read_to_string(&readme))?;
    }
    words.texts = texts.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').map(str::to_owned).collect();
    Ok(words)
}

/// The Rust sources in a folder and below it, or the one file.
fn sources(place: &Path) -> Result<Vec<PathBuf>, Failure> {
    if place.is_file() {
        return Ok(vec![place.to_owned()]);
    }
    let mut found = Vec::new();
    for path in circles::entries(place)? {
        if path.is_dir() {
            found.extend(sources(&path)?);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    Ok(found)
}

/// The files that `#[path]` names, as it names them.
fn brought_in(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| line.trim().strip_prefix("#[path = \"")?.strip_suffix("\"]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(words: &[&str]) -> BTreeSet<String> {
        words.iter().map(|word| (*word).to_owned()).collect()
    }

    /// The impostors: of each kind one that is used and one that is not.
    #[test]
    fn dependencies_without_a_use_are_found() {
        let manifest = "[dependencies]\na-b = \"1\"\nno-use = \"1\"\nonly-tests = \"1\"\nin-comment.workspace = true\n\
                        new-name = { package = \"old-name\", version = \"1\" }\n\
                        some = { version = \"1\", optional = true }\nno-optional = { version = \"1\", optional = true }\n\
                        [build-dependencies]\nscript = \"1\"\na-b = \"1\"\n\
                        [dev-dependencies]\ntested = \"1\"\nshown = \"1\"\nno-test = \"1\"\n\
                        [target.'cfg(unix)'.dependencies]\nsystem = \"1\"\nno-system = \"1\"\n";
        let words = Words {
            src: set(&["a_b", "new_name", "system"]),
            build: set(&["script"]),
            all: set(&["a_b", "new_name", "system", "script", "only_tests", "some", "tested"]),
            texts: set(&["in_comment", "shown"]),
        };
        let mut found = unused(&manifest.parse().expect("it is TOML"), &words);
        found.sort();
        // Of the build, where `src` names it only.
        assert_eq!(found, ["a-b", "in-comment", "no-optional", "no-system", "no-test", "no-use", "only-tests"]);
    }

    #[test]
    fn words_of_code_are_told_from_words_of_comments() {
        let words = words(&root().join("xtask")).expect("the sources are readable");
        assert!(words.src.contains("serde_json") && words.src.contains("toml") && words.build.is_empty());
        // This comment names `in_a_comment`.
        assert!(words.texts.contains("in_a_comment") && !words.src.contains("in_a_comment"));
        let of_tests = super::words(&root().join("tests")).expect("the sources are readable");
        assert!(of_tests.src.contains("sightlines_formats"), "a file that `#[path]` brings in");
        assert_eq!(brought_in("  #[path = \"../a.rs\"]\nmod a;\n").collect::<Vec<_>>(), ["../a.rs"]);
    }

    #[test]
    fn exceptions_have_reasons() {
        assert!(UNNAMED.iter().all(|(package, dependency, why)| ![package, dependency, why].contains(&&"")));
    }
}
