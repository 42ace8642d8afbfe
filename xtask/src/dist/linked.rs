//! Which packages are compiled into the programs.

use crate::debian::in_file;
use crate::metadata::{self, Package};
use crate::step::{self, Failure, cargo, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use toml::{Table, Value};

/// A package that is part of the programs.
#[derive(Debug, Clone)]
pub(super) struct Linked {
    pub(super) package: Package,
    /// SHA-256 of what the registry sent, in hexadecimal digits.
    pub(super) checksum: Option<String>,
    /// Names and versions of those that it uses itself.
    pub(super) uses: Vec<Id>,
}

/// Name and version.
pub(super) type Id = (String, String);

impl Linked {
    pub(super) fn id(&self) -> Id {
        (self.package.name.clone(), self.package.version.clone())
    }
}

/// The packages that the programs with all features contain, sorted: neither tools of the build nor procedural macros.
pub(super) fn packages(platform: &str) -> Result<Vec<Linked>, Failure> {
    let mut tree = cargo();
    tree.args(["tree", "--locked", "-p", "sightlines-cli", "--features", "png,gpu", "--target", platform]);
    tree.args(["--edges", "normal,no-proc-macro", "--prefix", "depth", "--format", " {p}", "--no-dedupe"]);
    let uses = uses(&step::output(&mut tree)?);
    let path = root().join("Cargo.lock");
    let lock = in_file(&path, fs::read_to_string(&path))?;
    let checksums = checksums(&lock);
    let mut packages: Vec<Linked> = Vec::new();
    for package in metadata::all()? {
        let id = (package.name.clone(), package.version.clone());
        if let Some(used) = uses.get(&id) {
            let (checksum, uses) = (checksums.get(&id).cloned(), used.iter().cloned().collect());
            packages.push(Linked { package, checksum, uses });
        }
    }
    packages.sort_by_key(Linked::id);
    let n_found = packages.len();
    if n_found == uses.len() && n_found > 1 {
        Ok(packages)
    } else {
        Err(Failure::Found { what: "packages in the tree that the metadata lacks", n: uses.len() - n_found })
    }
}

/// Who uses whom, from lines such as `2 clap_builder v4.6.7`, each after the one that uses it, which has a smaller depth.
fn uses(tree: &str) -> BTreeMap<Id, BTreeSet<Id>> {
    let mut found: BTreeMap<Id, BTreeSet<Id>> = BTreeMap::new();
    let mut above: Vec<Id> = Vec::new();
    for line in tree.lines() {
        let mut words = line.split_whitespace();
        let Some(depth) = words.next().and_then(|d| d.parse::<usize>().ok()) else { continue };
        let (Some(name), Some(version)) = (words.next(), words.next().and_then(|v| v.strip_prefix('v'))) else {
            continue;
        };
        let id = (name.to_owned(), version.to_owned());
        above.truncate(depth);
        if let Some(user) = above.last() {
            found.entry(user.clone()).or_default().insert(id.clone());
        }
        found.entry(id.clone()).or_default();
        above.push(id);
    }
    found
}

fn checksums(lock: &str) -> BTreeMap<Id, String> {
    let table: Table = lock.parse().unwrap_or_default();
    let packages = table.get("package").and_then(Value::as_array).into_iter().flatten();
    let text = |package: &Value, key: &str| package.get(key).and_then(Value::as_str).map(str::to_owned);
    packages.filter_map(|p| Some(((text(p, "name")?, text(p, "version")?), text(p, "checksum")?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(name: &str) -> Id {
        (name.to_owned(), "1.0.0".to_owned())
    }

    #[test]
    fn trees_are_read() {
        let tree = "0 a v1.0.0 (/here)\n1 b v1.0.0\n2 c v1.0.0\n1 c v1.0.0\n";
        let found = uses(tree);
        assert_eq!(found.len(), 3);
        assert_eq!(found[&id("a")], [id("b"), id("c")].into());
        assert_eq!(found[&id("b")], [id("c")].into());
        assert!(found[&id("c")].is_empty());
    }

    #[test]
    fn checksums_are_read() {
        let lock = "[[package]]\nname = \"a\"\nversion = \"1.0.0\"\nchecksum = \"0f\"\n\n[[package]]\nname = \"b\"\nversion = \"1.0.0\"\n";
        let found = checksums(lock);
        assert_eq!(found.len(), 1);
        assert_eq!(found[&id("a")], "0f");
    }
}
