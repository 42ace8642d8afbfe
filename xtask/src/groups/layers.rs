//! Which files a crate is made of, with all that it uses: by `docs/layers.toml`.

use crate::debian::in_file;
use crate::step::{Failure, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use toml::{Table, Value};

/// The crates that each crate uses, by the names of their folders.
#[derive(Debug, Clone, Default)]
pub(super) struct Layers(BTreeMap<String, Vec<String>>);

impl Layers {
    pub(super) fn read() -> Result<Self, Failure> {
        let path = root().join("docs").join("layers.toml");
        let text = in_file(&path, fs::read_to_string(&path))?;
        Self::parse(&text).ok_or(Failure::Found { what: "lists of crates in layers.toml", n: 0 })
    }

    pub(super) fn parse(text: &str) -> Option<Self> {
        let table: Table = text.parse().ok()?;
        let crates = table.get("crates")?.as_table()?.iter();
        let uses = |entry: &Value| -> Option<Vec<String>> {
            entry.get("uses")?.as_array()?.iter().map(|name| name.as_str().map(str::to_owned)).collect()
        };
        crates.map(|(name, entry)| Some((name.clone(), uses(entry)?))).collect::<Option<_>>().map(Self)
    }

    /// `crates` and all that they use, directly or through others.
    pub(super) fn below(&self, crates: &[&str]) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let mut open: Vec<String> = crates.iter().map(|&name| name.to_owned()).collect();
        while let Some(name) = open.pop() {
            open.extend(self.0.get(&name).into_iter().flatten().cloned());
            found.insert(name);
        }
        found
    }

    /// Whether there is a crate of this name.
    #[cfg(test)]
    pub(super) fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }
}

/// The crate that a file is compiled into, by the name of its folder. Tests and texts of a crate change nothing for others.
pub(super) fn crate_of(path: &str) -> Option<&str> {
    let (name, rest) = if let Some(inside) = path.strip_prefix("crates/") {
        inside.split_once('/')?
    } else {
        ("shaders", path.strip_prefix("shaders/")?)
    };
    let is_apart = ["tests/", "examples/"].iter().any(|folder| rest.starts_with(folder)) || rest.ends_with(".md");
    (!is_apart).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_crate_uses_is_followed_down() {
        let text = "[crates.a]\nuses = []\n[crates.b]\nuses = [\"a\"]\n[crates.c]\nuses = [\"b\"]\n[crates.d]\nuses = [\"a\"]\n";
        let layers = Layers::parse(text).expect("these are layers");
        let below = |names: &[&str]| layers.below(names).into_iter().collect::<Vec<_>>().join(" ");
        assert_eq!(below(&["c"]), "a b c");
        assert_eq!(below(&["b", "d"]), "a b d");
        assert!(layers.has("d") && !layers.has("e"));
        for text in ["", "[crates.a]\n", "[crates.a]\nuses = [1]\n"] {
            assert!(Layers::parse(text).is_none(), "{text}");
        }
    }

    #[test]
    fn files_belong_to_the_crate_that_they_are_compiled_into() {
        for (path, expected) in [
            ("crates/pvs/src/table.rs", Some("pvs")),
            ("crates/capi/include/sightlines.h", Some("capi")),
            ("crates/viewer/web/table.js", Some("viewer")),
            ("crates/pvs/Cargo.toml", Some("pvs")),
            ("shaders/wgsl/splat.wgsl", Some("shaders")),
            ("crates/pvs/tests/pvs/main.rs", None),
            ("crates/pvs/README.md", None),
            ("docs/layers.toml", None),
            ("crates/LICENSE", None),
        ] {
            assert_eq!(crate_of(path), expected, "{path}");
        }
    }
}
