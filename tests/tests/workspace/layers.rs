//! Who may use whom: the workspace against `docs/layers.toml`.
//!
//! The checks are functions over parsed data, so that each of them is also fed an impostor.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// What `docs/layers.toml` says of one crate.
#[derive(Debug, Clone, Default)]
struct Layer {
    row: i64,
    uses: BTreeSet<String>,
    packages: BTreeSet<String>,
    files: bool,
    /// Whether its lints are a copy of the workspace's, but for that of `unsafe` code.
    uses_unsafe: bool,
}

/// The whole of `docs/layers.toml`.
#[derive(Debug, Clone, Default)]
struct Layers {
    crates: BTreeMap<String, Layer>,
    dev: BTreeSet<String>,
    /// Packages of `dev` that may open files too.
    dev_files: BTreeSet<String>,
    only: BTreeMap<String, BTreeSet<String>>,
    /// The lints of the workspace.
    lints: toml::Table,
}

/// One package of the workspace, named by its folder.
#[derive(Debug, Clone, Default)]
struct Package {
    folder: String,
    name: String,
    /// Package names of ordinary and build dependencies.
    dependencies: Vec<String>,
    published: bool,
    inherits_rust_version: bool,
    inherits_lints: bool,
    /// Its own lints, if it does not inherit them.
    lints: toml::Table,
    /// Path and text of each source file that is not a test; only for packages below `crates/`.
    sources: Vec<(String, String)>,
}

/// How much was looked at.
#[derive(Debug, Default, Clone, Copy)]
struct Counts {
    packages: usize,
    dependencies: usize,
    files: usize,
    lines: usize,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace").to_path_buf()
}

// --- Reading ---------------------------------------------------------------------------------------

fn strings(value: Option<&toml::Value>) -> BTreeSet<String> {
    let list = value.and_then(toml::Value::as_array).expect("a list of names");
    list.iter().map(|v| v.as_str().expect("a name").to_owned()).collect()
}

fn read_layers(text: &str) -> Layers {
    let file: toml::Table = text.parse().expect("layers.toml is TOML");
    let crates = file["crates"].as_table().expect("[crates.NAME]").iter().map(|(name, entry)| {
        let layer = Layer {
            row: entry.get("row").and_then(toml::Value::as_integer).expect("a row"),
            uses: strings(entry.get("uses")),
            packages: strings(entry.get("packages")),
            files: entry.get("files").and_then(toml::Value::as_bool).unwrap_or(false),
            uses_unsafe: entry.get("unsafe").and_then(toml::Value::as_bool).unwrap_or(false),
        };
        (name.clone(), layer)
    });
    let only = file["only"].as_table().expect("[only]").iter().map(|(name, list)| (name.clone(), strings(Some(list))));
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the workspace has a manifest");
    let manifest: toml::Table = manifest.parse().expect("a manifest is TOML");
    let lints = manifest["workspace"]["lints"].as_table().expect("the workspace has lints").clone();
    let dev = |key: &str| strings(file["dev"].get(key));
    Layers { crates: crates.collect(), dev: dev("packages"), dev_files: dev("files"), only: only.collect(), lints }
}

/// All packages, from `cargo metadata` and, for what it does not tell, from their manifests.
fn read_packages() -> Vec<Package> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON");
    metadata["packages"].as_array().expect("packages").iter().map(read_package).collect()
}

fn read_package(package: &serde_json::Value) -> Package {
    let manifest = PathBuf::from(package["manifest_path"].as_str().expect("a path"));
    let folder = manifest.parent().expect("a manifest lies in a folder");
    let text = fs::read_to_string(&manifest).expect("a manifest is readable");
    let toml: toml::Table = text.parse().expect("a manifest is TOML");
    let inherits = |value: Option<&toml::Value>| {
        value.and_then(|v| v.get("workspace")).and_then(toml::Value::as_bool).unwrap_or(false)
    };
    let dependencies = package["dependencies"].as_array().expect("dependencies").iter();
    let ordinary = dependencies.filter(|d| d["kind"].as_str() != Some("dev"));
    let in_crates = folder.parent().is_some_and(|p| p.ends_with("crates"));
    Package {
        folder: folder.file_name().expect("a folder has a name").to_string_lossy().into_owned(),
        name: package["name"].as_str().expect("a name").to_owned(),
        dependencies: ordinary.map(|d| d["name"].as_str().expect("a name").to_owned()).collect(),
        published: package["publish"].is_null(),
        inherits_rust_version: inherits(toml["package"].get("rust-version")),
        inherits_lints: inherits(toml.get("lints")),
        lints: toml.get("lints").and_then(toml::Value::as_table).cloned().unwrap_or_default(),
        sources: if in_crates { read_sources(&folder.join("src")) } else { Vec::new() },
    }
}

fn read_sources(src: &Path) -> Vec<(String, String)> {
    let mut paths = Vec::new();
    collect_rust_files(src, &mut paths);
    paths.sort();
    let files: Vec<(PathBuf, String)> =
        paths.into_iter().map(|p| (p.clone(), fs::read_to_string(&p).expect("a source file is readable"))).collect();
    let tests: BTreeSet<PathBuf> = files.iter().flat_map(|(path, text)| test_modules(path, text)).collect();
    let is_test = |path: &Path| path.ancestors().any(|a| tests.contains(&a.with_extension("")));
    let sources = files.iter().filter(|(path, _)| !is_test(path));
    sources.map(|(path, text)| (path.display().to_string(), without_tests(text))).collect()
}

fn collect_rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a source folder is readable") {
        let path = entry.expect("an entry is readable").path();
        if path.is_dir() {
            collect_rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Where the files lie that `text` declares as `#[cfg(test)] mod name;`, without their extension.
fn test_modules(path: &Path, text: &str) -> Vec<PathBuf> {
    let stem = path.file_stem().expect("a source file has a name");
    let own = if ["lib", "main", "mod"].iter().any(|s| stem == *s) {
        path.with_file_name("")
    } else {
        path.with_extension("")
    };
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let declared = lines.windows(2).filter(|pair| pair[0] == "#[cfg(test)]").filter_map(|pair| {
        let name = pair[1].strip_suffix(';')?.split(' ').next_back()?;
        pair[1].contains("mod ").then(|| own.join(name))
    });
    declared.collect()
}

/// `text` without its `#[cfg(test)] mod … { … }` and without comments. Relies on rustfmt: a module ends
/// with a brace at its own indentation.
fn without_tests(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let opens = lines.peek().is_some_and(|next| next.contains("mod ") && next.ends_with('{'));
        if line.trim() == "#[cfg(test)]" && opens {
            let end = format!("{}}}", &line[..line.len() - line.trim_start().len()]);
            lines.by_ref().find(|l| *l == end);
        } else if !line.trim_start().starts_with("//") {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}

// --- Checks ----------------------------------------------------------------------------------------

/// Every package is listed, and everything listed exists, with the name that its folder gives it.
fn check_listing(layers: &Layers, packages: &[Package], complaints: &mut Vec<String>) {
    let folders: BTreeSet<&String> = packages.iter().map(|p| &p.folder).collect();
    let listed: BTreeSet<&String> = layers.crates.keys().chain(&layers.dev).collect();
    complaints.extend(folders.difference(&listed).map(|f| format!("{f} is not in layers.toml")));
    complaints.extend(listed.difference(&folders).map(|f| format!("{f} is in layers.toml and not in the workspace")));
    for package in packages {
        let Package { folder, name, published, .. } = package;
        let usual = format!("sightlines-{folder}");
        if *name != usual && !["sightlines", "xtask"].contains(&name.as_str()) {
            complaints.push(format!("{folder} should be named {usual}, not {name}"));
        }
        if *published == layers.dev.contains(folder) {
            complaints.push(format!("{folder}: published must be {}", !published));
        }
    }
}

/// Dependencies between packages point strictly down, those to the outside are listed.
fn check_dependencies(layers: &Layers, packages: &[Package], complaints: &mut Vec<String>) {
    let folder_of: BTreeMap<&str, &str> = packages.iter().map(|p| (p.name.as_str(), p.folder.as_str())).collect();
    for package in packages {
        let from = &package.folder;
        for name in &package.dependencies {
            if layers.only.get(name).is_some_and(|only| !only.contains(from)) {
                complaints.push(format!("{from} uses {name}, which is kept to {:?}", layers.only[name]));
            }
            let Some(layer) = layers.crates.get(from) else { continue };
            let Some(&to) = folder_of.get(name.as_str()) else {
                if !layer.packages.contains(name) {
                    complaints.push(format!("{from} may not use {name}"));
                }
                continue;
            };
            match layers.crates.get(to) {
                None => complaints.push(format!("{from} uses {to}, which is no crate of a row")),
                Some(below) if below.row >= layer.row => {
                    complaints.push(format!("{from} (row {}) uses {to} (row {})", layer.row, below.row));
                }
                Some(_) if !layer.uses.contains(to) => complaints.push(format!("{from} may not use {to}")),
                Some(_) => {}
            }
        }
    }
}

/// One rust-version and one set of lints for all; a crate with `unsafe` code has a copy of them with that lint as the one difference.
fn check_inheritance(layers: &Layers, packages: &[Package], complaints: &mut Vec<String>) {
    for package in packages {
        let folder = &package.folder;
        if !package.inherits_rust_version {
            complaints.push(format!("{folder} does not inherit rust-version"));
        }
        if !layers.crates.get(folder).is_some_and(|layer| layer.uses_unsafe) {
            if !package.inherits_lints {
                complaints.push(format!("{folder} does not inherit the lints"));
            }
            continue;
        }
        let (ours, theirs) = (without_unsafe(&layers.lints), without_unsafe(&package.lints));
        if ours.is_empty() || ours != theirs {
            complaints.push(format!("{folder} has other lints than the workspace, not only for unsafe code"));
        }
        if unsafe_code(&package.lints) != Some("allow") {
            complaints.push(format!("{folder} does not allow unsafe code: it can inherit the lints"));
        }
    }
    if unsafe_code(&layers.lints) != Some("forbid") {
        complaints.push("the workspace does not forbid unsafe code".to_owned());
    }
}

fn unsafe_code(lints: &toml::Table) -> Option<&str> {
    lints.get("rust")?.get("unsafe_code")?.as_str()
}

fn without_unsafe(lints: &toml::Table) -> toml::Table {
    let mut lints = lints.clone();
    if let Some(rust) = lints.get_mut("rust").and_then(toml::Value::as_table_mut) {
        rust.remove("unsafe_code");
    }
    lints
}

/// Whether a line of code opens files: `std::fs`, `fs::…`, `File::…`, `OpenOptions`.
fn touches_files(line: &str) -> bool {
    let starts_word = |at: usize| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    ["std::fs", "fs::", "File::", "OpenOptions"]
        .iter()
        .any(|word| line.match_indices(word).any(|(at, _)| starts_word(at)))
}

/// Only crates marked so open files.
fn check_files(layers: &Layers, packages: &[Package], complaints: &mut Vec<String>) {
    let may =
        |p: &Package| layers.crates.get(&p.folder).is_some_and(|l| l.files) || layers.dev_files.contains(&p.folder);
    for (path, text) in packages.iter().filter(|p| !may(p)).flat_map(|p| &p.sources) {
        for line in text.lines().filter(|l| touches_files(l)) {
            complaints.push(format!("{path} opens files: {}", line.trim()));
        }
    }
}

fn check(layers: &Layers, packages: &[Package]) -> (Vec<String>, Counts) {
    let mut complaints = Vec::new();
    check_listing(layers, packages, &mut complaints);
    check_dependencies(layers, packages, &mut complaints);
    check_inheritance(layers, packages, &mut complaints);
    check_files(layers, packages, &mut complaints);
    let sources = || packages.iter().flat_map(|p| &p.sources);
    let counts = Counts {
        packages: packages.len(),
        dependencies: packages.iter().map(|p| p.dependencies.len()).sum(),
        files: sources().count(),
        lines: sources().map(|(_, text)| text.lines().count()).sum(),
    };
    (complaints, counts)
}

// --- The workspace as it is ------------------------------------------------------------------------

fn real_layers() -> Layers {
    read_layers(&fs::read_to_string(root().join("docs/layers.toml")).expect("docs/layers.toml is readable"))
}

/// What `docs/layers.toml` says, what there is, and what is wrong with it. Read once: that takes long.
static REAL: LazyLock<(Layers, Vec<Package>, Vec<String>, Counts)> = LazyLock::new(|| {
    let (layers, packages) = (real_layers(), read_packages());
    let (complaints, counts) = check(&layers, &packages);
    (layers, packages, complaints, counts)
});

#[test]
fn layers_every_package_keeps_to_its_row() {
    let (_, _, complaints, counts) = &*REAL;
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert!(counts.packages >= 17, "{counts:?}");
    assert!(counts.dependencies >= 60, "{counts:?}");
    assert!(counts.files >= 50 && counts.lines >= 4000, "{counts:?}");
}

#[test]
fn layers_what_a_game_ships_stands_alone() {
    let packages = &REAL.1;
    let pvs = packages.iter().find(|p| p.folder == "pvs").expect("pvs exists");
    let allowed = ["glam", "crc32fast", "thiserror"];
    assert!(!pvs.dependencies.is_empty(), "nothing was checked");
    assert!(pvs.dependencies.iter().all(|d| allowed.contains(&d.as_str())), "pvs uses {:?}", pvs.dependencies);
}

#[test]
fn layers_the_architecture_tells_the_same_rows() {
    let text = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).expect("docs/ARCHITECTURE.md is readable");
    let layers = &REAL.0;
    for (name, layer) in &layers.crates {
        let start = format!("| {} | {name} |", layer.row);
        assert!(text.lines().any(|l| l.starts_with(&start)), "ARCHITECTURE.md has no table row `{start}`");
    }
    for name in &layers.dev {
        assert!(text.contains(&format!("| dev | {name} |")), "ARCHITECTURE.md has no table row for {name}");
    }
}

// --- Impostors -------------------------------------------------------------------------------------

/// What `spoil` adds to the complaints about the real workspace.
fn complaints_after(spoil: impl FnOnce(&mut Layers, &mut Vec<Package>)) -> Vec<String> {
    let (layers, packages, before, _) = &*REAL;
    let (mut layers, mut packages) = (layers.clone(), packages.clone());
    spoil(&mut layers, &mut packages);
    check(&layers, &packages).0.into_iter().filter(|c| !before.contains(c)).collect()
}

fn package<'a>(packages: &'a mut [Package], folder: &str) -> &'a mut Package {
    packages.iter_mut().find(|p| p.folder == folder).expect("the package exists")
}

#[test]
fn impostor_a_dependency_that_does_not_point_down_is_caught() {
    for (from, to) in [("cells", "kdtree"), ("sightline", "cells"), ("pvs", "geometry"), ("formats", "bake")] {
        let name = format!("sightlines-{to}");
        let complaints = complaints_after(|_, p| package(p, from).dependencies.push(name));
        assert!(complaints.iter().any(|c| c.starts_with(&format!("{from} (row"))), "{from} to {to}: {complaints:?}");
    }
}

#[test]
fn impostor_a_dependency_that_is_not_listed_is_caught() {
    let add = |from: &'static str, name: &'static str| {
        complaints_after(move |_, p| package(p, from).dependencies.push(name.to_owned()))
    };
    assert_eq!(add("cli", "sightlines-pvs"), ["cli may not use pvs"]);
    assert_eq!(add("pvs", "rayon"), ["pvs may not use rayon"]);
    assert_eq!(add("cells", "sightlines-testkit"), ["cells uses testkit, which is no crate of a row"]);
    assert_eq!(add("tests", "good_lp"), [r#"tests uses good_lp, which is kept to {"lab", "testkit"}"#]);
    assert_eq!(add("kdtree", "spade").len(), 2, "not listed, and kept to another crate");
}

#[test]
fn impostor_a_missing_or_invented_crate_is_caught() {
    let unlisted = complaints_after(|layers, _| drop(layers.crates.remove("stabtree")));
    assert!(unlisted.contains(&"stabtree is not in layers.toml".to_owned()), "{unlisted:?}");
    let invented = complaints_after(|layers, _| drop(layers.crates.insert("ghost".into(), Layer::default())));
    assert_eq!(invented, ["ghost is in layers.toml and not in the workspace"]);
    let misnamed = complaints_after(|_, p| package(p, "testkit").published = true);
    assert_eq!(misnamed, ["testkit: published must be false"]);
}

#[test]
fn impostor_an_own_rust_version_and_own_lints_are_caught() {
    let version = complaints_after(|_, p| package(p, "pvs").inherits_rust_version = false);
    assert_eq!(version, ["pvs does not inherit rust-version"]);
    let lints = complaints_after(|_, p| package(p, "xtask").inherits_lints = false);
    assert_eq!(lints, ["xtask does not inherit the lints"]);
}

#[test]
fn impostor_a_copy_of_the_lints_that_differs_is_caught() {
    let with = |change: fn(&mut toml::Table)| complaints_after(|_, p| change(&mut package(p, "capi").lints));
    let differs = ["capi has other lints than the workspace, not only for unsafe code"];
    let table = |lints: &mut toml::Table, key: &str| lints[key].as_table().expect("lints of a tool").clone();
    assert!(table(&mut REAL.0.lints.clone(), "clippy").contains_key("undocumented_unsafe_blocks"));
    let dropped = |lints: &mut toml::Table| {
        lints["clippy"].as_table_mut().map(|clippy| clippy.remove("undocumented_unsafe_blocks"));
    };
    assert_eq!(with(dropped), differs);
    let weaker = |lints: &mut toml::Table| {
        lints["rust"].as_table_mut().map(|rust| rust.insert("missing_docs".into(), "allow".into()));
    };
    assert_eq!(with(weaker), differs);
    assert_eq!(with(|lints| drop(lints.remove("rustdoc"))), differs);
    let idle = |lints: &mut toml::Table| {
        lints["rust"].as_table_mut().map(|rust| rust.insert("unsafe_code".into(), "forbid".into()));
    };
    assert_eq!(with(idle), ["capi does not allow unsafe code: it can inherit the lints"]);
    let lifted = complaints_after(|layers, _| {
        layers.lints["rust"].as_table_mut().map(|rust| rust.insert("unsafe_code".into(), "warn".into()));
    });
    assert_eq!(lifted, ["the workspace does not forbid unsafe code"]);
    let unlisted = complaints_after(|layers, _| layers.crates.entry("capi".into()).or_default().uses_unsafe = false);
    assert_eq!(unlisted, ["capi does not inherit the lints"]);
}

#[test]
fn impostor_a_file_access_is_caught_in_code_and_only_there() {
    let with = |text: &'static str| {
        let add = |packages: &mut Vec<Package>| {
            package(packages, "geometry").sources.push(("x.rs".into(), without_tests(text)))
        };
        complaints_after(|_, p| add(p)).len()
    };
    assert_eq!(with("fn f() { let _ = std::fs::read(\"x\"); }\n"), 1);
    assert_eq!(with("use std::{fs, io};\nfn f() { let _ = fs::read(\"x\"); }\n"), 1);
    assert_eq!(with("fn f() { let _ = File::open(\"x\"); }\n"), 1);
    assert_eq!(with("#[cfg(test)]\nmod tests {\n    use std::fs;\n}\nfn f() { File::open(\"x\"); }\n"), 1);
    assert_eq!(with("// std::fs is not for us.\n#[cfg(test)]\nmod tests {\n    use std::fs;\n}\n"), 0);
    assert_eq!(with("fn f() { WadFile::new(offs::START) }\n"), 0);
}

#[test]
fn modules_of_tests_are_distinguished_from_code() {
    let declared = |path: &str| test_modules(Path::new(path), "mod a;\n#[cfg(test)]\nmod check;\nmod b;\n");
    assert_eq!(declared("x/src/lib.rs"), [Path::new("x/src/check")]);
    assert_eq!(declared("x/src/tree.rs"), [Path::new("x/src/tree/check")]);
}
