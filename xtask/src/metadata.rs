//! What `cargo metadata` knows of the workspace and of its dependencies.

use crate::step::{self, Failure, cargo};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A package of the workspace, or one that it depends on.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    /// Its licences, as an expression of SPDX.
    pub(crate) license: Option<String>,
    pub(crate) description: Option<String>,
    pub(crate) repository: Option<String>,
    pub(crate) authors: Vec<String>,
    /// The registry that it comes from; nothing for a package of the workspace.
    pub(crate) source: Option<String>,
    pub(crate) readme: Option<String>,
    pub(crate) keywords: Vec<String>,
    pub(crate) categories: Vec<String>,
    pub(crate) features: Vec<String>,
    /// Whether its manifest says how docs.rs builds its documentation.
    pub(crate) has_docs_rs: bool,
    pub(crate) published: bool,
    /// The folder of its manifest.
    pub(crate) folder: PathBuf,
}

/// Every package of the lock file, of the workspace and from outside.
pub(crate) fn all() -> Result<Vec<Package>, Failure> {
    read(&["metadata", "--format-version", "1", "--locked"])
}

/// Every package of the lock file of another workspace.
pub(crate) fn all_of(manifest: &Path) -> Result<Vec<Package>, Failure> {
    let words = ["metadata", "--format-version", "1", "--locked", "--manifest-path"];
    parse(&step::output(cargo().args(words).arg(manifest))?)
}

/// The packages of the workspace that are published, sorted by name.
pub(crate) fn published() -> Result<Vec<Package>, Failure> {
    let packages = read(&["metadata", "--format-version", "1", "--locked", "--no-deps"])?;
    let mut published: Vec<_> = packages.into_iter().filter(|p| p.published).collect();
    published.sort_by(|a, b| a.name.cmp(&b.name));
    if published.is_empty() { Err(Failure::Found { what: "published crates", n: 0 }) } else { Ok(published) }
}

fn read(words: &[&str]) -> Result<Vec<Package>, Failure> {
    parse(&step::output(cargo().args(words))?)
}

fn parse(json: &str) -> Result<Vec<Package>, Failure> {
    let root: Value = serde_json::from_str(json).map_err(|error| Failure::Unavailable(error.into()))?;
    Ok(root["packages"].as_array().into_iter().flatten().map(package).collect())
}

fn package(value: &Value) -> Package {
    let text = |key: &str| value[key].as_str().map(str::to_owned);
    let texts = |key: &str| value[key].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
    let manifest = text("manifest_path").unwrap_or_default();
    Package {
        name: text("name").unwrap_or_default(),
        version: text("version").unwrap_or_default(),
        license: text("license"),
        description: text("description"),
        repository: text("repository"),
        authors: texts("authors").collect(),
        source: text("source"),
        readme: text("readme"),
        keywords: texts("keywords").collect(),
        categories: texts("categories").collect(),
        features: value["features"].as_object().into_iter().flat_map(|f| f.keys().cloned()).collect(),
        has_docs_rs: value["metadata"]["docs"]["rs"].is_object(),
        published: value["publish"].is_null(),
        folder: Path::new(&manifest).parent().unwrap_or(Path::new("")).to_path_buf(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_are_read() {
        let json = r#"{"packages": [{"name": "a", "version": "1.0.0", "license": "MIT", "authors": ["b"], "source": null,
            "features": {"png": []}, "metadata": {"docs": {"rs": {}}}, "publish": [], "manifest_path": "/x/a/Cargo.toml"}]}"#;
        let packages = parse(json).expect("it is JSON");
        let expected = Package {
            name: "a".into(),
            version: "1.0.0".into(),
            license: Some("MIT".into()),
            authors: vec!["b".into()],
            features: vec!["png".into()],
            has_docs_rs: true,
            folder: "/x/a".into(),
            ..Package::default()
        };
        assert_eq!(packages, [expected]);
        parse("{").expect_err("it is no JSON");
    }

    #[test]
    fn published_crates_are_told_from_others() {
        let names: Vec<_> = published().expect("the workspace is readable").into_iter().map(|p| p.name).collect();
        assert!(names.len() >= 13 && ["sightlines", "sightlines-shaders"].iter().all(|n| names.iter().any(|m| m == n)));
        assert!(!names.iter().any(|n| n == "sightlines-testkit" || n == "xtask"), "{names:?}");
    }
}
