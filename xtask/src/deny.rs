//! What the project may depend on: licences and sources, by the rules in `deny.toml`.

use crate::debian::in_file;
use crate::metadata::{self, Package};
use crate::python;
use crate::spdx::is_allowed;
use crate::step::{self, Failure, cargo, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::process::{Command, Stdio};
use toml::{Table, Value};

/// The registry whose packages may be used, as `cargo metadata` names it.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The rules on licences.
#[derive(Debug, Default)]
struct Rules {
    allowed: BTreeSet<String>,
    /// What single packages may have as well.
    exceptions: BTreeMap<String, BTreeSet<String>>,
}

/// Checks the licence and source of every package that anything here depends on, for any platform and with any feature; then
/// lets cargo-deny check all its rules, and known advisories, if it is there.
pub(crate) fn check() -> Result<(), Failure> {
    let path = root().join("deny.toml");
    let text = in_file(&path, fs::read_to_string(&path))?;
    let rules = rules(&text).ok_or(Failure::Found { what: "lists of licences in deny.toml", n: 0 })?;
    // The Python package has a workspace of its own, and is offered for download too.
    let of_python = metadata::all_of(&python::folder().join("Cargo.toml"))?;
    let packages = [metadata::all()?, of_python].concat();
    let (mut n_looked_at, mut n_found) = (0, 0);
    for package in packages.iter().filter(|p| p.source.is_some()) {
        n_looked_at += 1;
        if let Some(why) = refused(package, &rules) {
            eprintln!("{} {}: {why}", package.name, package.version);
            n_found += 1;
        }
    }
    eprintln!("licences and sources of {n_looked_at} packages looked at");
    if n_found > 0 || n_looked_at == 0 {
        return Err(Failure::Found { what: "packages that deny.toml does not allow", n: n_found });
    }
    cargo_deny()
}

/// Runs cargo-deny. Advisories need a network; without, they are left out, and that is said.
fn cargo_deny() -> Result<(), Failure> {
    if !is_installed("cargo-deny") {
        eprintln!("!! cargo-deny is not installed: advisories and yanked versions WILL NOT be checked");
        return Ok(());
    }
    step::run(cargo().args(["deny", "--workspace", "check", "bans", "licenses", "sources"]))?;
    if step::run(cargo().args(["deny", "fetch", "db"])).is_err() {
        eprintln!("!! the database of advisories is out of reach: advisories and yanked versions WILL NOT be checked");
        return Ok(());
    }
    step::run(cargo().args(["deny", "--workspace", "check", "advisories"]))
}

/// Whether a program can be started.
pub(crate) fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

fn rules(text: &str) -> Option<Rules> {
    let table: Table = text.parse().ok()?;
    let licenses = table.get("licenses")?;
    let exceptions = licenses.get("exceptions").and_then(Value::as_array).into_iter().flatten();
    let exceptions = exceptions.map(|e| Some((e.get("name")?.as_str()?.to_owned(), texts(e.get("allow")?)?)));
    let rules = Rules { allowed: texts(licenses.get("allow")?)?, exceptions: exceptions.collect::<Option<_>>()? };
    (!rules.allowed.is_empty()).then_some(rules)
}

fn texts(value: &Value) -> Option<BTreeSet<String>> {
    value.as_array()?.iter().map(|v| v.as_str().map(str::to_owned)).collect()
}

/// Why a package may not be used, if so.
fn refused(package: &Package, rules: &Rules) -> Option<String> {
    if let Some(source) = package.source.as_deref().filter(|s| *s != REGISTRY) {
        return Some(format!("comes from {source}"));
    }
    let Some(license) = &package.license else { return Some("names no licence".into()) };
    let mut allowed = rules.allowed.clone();
    allowed.extend(rules.exceptions.get(&package.name).into_iter().flatten().cloned());
    match is_allowed(license, &allowed) {
        Some(true) => None,
        Some(false) => Some(format!("{license} is not allowed")),
        None => Some(format!("`{license}` is no expression of licences")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, license: Option<&str>, source: &str) -> Package {
        Package {
            name: name.into(),
            license: license.map(str::to_owned),
            source: Some(source.into()),
            ..Package::default()
        }
    }

    #[test]
    fn impostor_packages_that_are_not_allowed_are_refused() {
        let text = "[licenses]\nallow = [\"MIT\"]\nexceptions = [{ name = \"b\", allow = [\"MPL-2.0\"] }]\n";
        let rules = rules(text).expect("these are rules");
        for (name, license) in [("a", "MIT"), ("a", "MIT OR GPL-3.0"), ("b", "MPL-2.0")] {
            assert_eq!(refused(&package(name, Some(license), REGISTRY), &rules), None, "{name} {license}");
        }
        for (name, license, source) in [
            ("a", Some("MPL-2.0"), REGISTRY),
            ("a", Some("MIT AND GPL-3.0"), REGISTRY),
            ("a", None, REGISTRY),
            ("a", Some("as is"), REGISTRY),
            ("a", Some("MIT"), "git+https://example.org/a"),
        ] {
            assert!(refused(&package(name, license, source), &rules).is_some(), "{name} {license:?} {source}");
        }
    }

    #[test]
    fn rules_without_licences_are_none() {
        for text in ["", "[licenses]\n", "[licenses]\nallow = []\n", "[licenses]\nallow = \"MIT\"\n"] {
            assert!(rules(text).is_none(), "{text}");
        }
    }
}
