//! The licences of everything that is compiled into the programs, as one text.

use super::Release;
use super::linked::Linked;
use crate::debian::in_file;
use crate::step::Failure;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// How names of files with licences begin.
const NAMES: [&str; 5] = ["license", "licence", "notice", "copyright", "unlicense"];
const LINE: &str = "--------------------------------------------------------------------------------\n";

/// A list of all packages from outside with their licences, then the texts that lie in the packages, each once.
pub(super) fn text(release: &Release) -> Result<String, Failure> {
    let foreign: Vec<&Linked> = release.packages.iter().filter(|p| p.package.source.is_some()).collect();
    let mut text = format!(
        "sightlines {} contains the following packages of others. The texts of their licences follow.\nIt also contains the \
         standard library of Rust {} (MIT OR Apache-2.0, https://www.rust-lang.org).\n\n",
        release.version, release.rustc
    );
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut without = Vec::new();
    for linked in foreign {
        let package = &linked.package;
        let name = format!("{} {}", package.name, package.version);
        let (license, authors) = (package.license.as_deref().unwrap_or("?"), package.authors.join(", "));
        writeln!(text, "{name}: {license}{}{authors}", if authors.is_empty() { "" } else { "; " })
            .expect("a text is writable");
        let files = licence_files(&package.folder)?;
        if files.is_empty() {
            without.push(name.clone());
        }
        for file in files {
            let content = in_file(&file, fs::read(&file))?;
            let content = String::from_utf8_lossy(&content).replace("\r\n", "\n");
            let owners = texts.entry(content.trim_end().to_owned()).or_default();
            if !owners.contains(&name) {
                owners.push(name.clone());
            }
        }
    }
    if !without.is_empty() {
        let list = without.join(", ");
        writeln!(text, "\nWithout a text in their packages: {list}.").expect("a text is writable");
        eprintln!("{} packages have no text of a licence in them: {list}", without.len());
    }
    // In the order of the packages, not of the texts.
    let mut texts: Vec<_> = texts.into_iter().map(|(content, owners)| (owners, content)).collect();
    texts.sort();
    for (owners, content) in texts {
        write!(text, "\n{LINE}{}\n{LINE}\n{content}\n", owners.join(", ")).expect("a text is writable");
    }
    Ok(text)
}

/// Files with licences below the folder of a package, sorted. Those of the name COPYING, which hold one licence of several to
/// choose from, count only where there are no others.
fn licence_files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let named = |path: &Path, start: &str| {
        path.file_name().is_some_and(|n| n.to_string_lossy().to_lowercase().starts_with(start))
    };
    let good: Vec<_> = files.iter().filter(|p| NAMES.iter().any(|n| named(p, n))).cloned().collect();
    Ok(if good.is_empty() { files.into_iter().filter(|p| named(p, "copying")).collect() } else { good })
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    for entry in in_file(folder, fs::read_dir(folder))? {
        let path = in_file(folder, entry)?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_none_or(|e| !["rs", "toml", "json"].iter().any(|other| e == *other)) {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::root;

    #[test]
    fn files_with_licences_are_found() {
        let found = licence_files(&root().join("crates/pvs")).expect("the folder is readable");
        let names: Vec<_> = found.iter().filter_map(|p| p.file_name()?.to_str()).collect();
        assert_eq!(names, ["LICENSE-APACHE", "LICENSE-MIT"]);
        assert!(licence_files(&root().join("docs/guides")).expect("the folder is readable").is_empty());
    }
}
