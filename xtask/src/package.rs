//! The published crates as packages: what their manifests have, what lies in the packages, and that they compile from
//! nothing else.

use crate::debian::in_file;
use crate::metadata::{self, Package};
use crate::step::{self, Failure, cargo, root};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files that every package has as they are in the folder of the workspace.
const LICENCES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// Packs all published crates, unpacks them elsewhere, and compiles them there, each with the others as packaged.
///
/// Instead of `cargo package` with its own check, which compiles every crate once for each of those above it, the unpacked
/// crates make one workspace.
pub(crate) fn check() -> Result<(), Failure> {
    let packages = metadata::published()?;
    refuse_incomplete(&packages)?;
    let folder = unpacked(&packages)?;
    let mut command = cargo();
    command
        .current_dir(&folder)
        .args(["check", "--workspace", "--lib", "--bins", "--offline", "--target-dir"])
        .arg(target());
    // As the profile of the workspace, so that what both depend on is compiled once.
    let profile = [("OPT_LEVEL", "1"), ("DEBUG", "false"), ("LTO", "off")];
    step::run(command.envs(profile.map(|(name, value)| (format!("CARGO_PROFILE_DEV_{name}"), value))))?;
    eprintln!("{} packages compile as packaged", packages.len());
    Ok(())
}

/// The folder for build outputs.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// Packs `packages` and unpacks them into a workspace in which each takes the others from there; returns its folder.
pub(crate) fn unpacked(packages: &[Package]) -> Result<PathBuf, Failure> {
    pack(packages)?;
    let folder = target().join("unpacked");
    if folder.is_dir() {
        in_file(&folder, fs::remove_dir_all(&folder))?;
    }
    in_file(&folder, fs::create_dir_all(&folder))?;
    let mut n_wrong = 0;
    for package in packages {
        let file = target().join("package").join(format!("{}.crate", folder_name(package)));
        // With the time of now: in packages all files have one time of long ago, by which Cargo would take them for the ones that it compiled
        // last time.
        step::run(Command::new("tar").args(["--touch", "-xzf"]).arg(&file).arg("-C").arg(&folder))?;
        n_wrong += lacking(package, &folder.join(folder_name(package)))?;
    }
    if n_wrong > 0 {
        return Err(Failure::Found { what: "files that packages lack", n: n_wrong });
    }
    let manifest = folder.join("Cargo.toml");
    in_file(&manifest, fs::write(&manifest, workspace(packages)))?;
    let lock = folder.join("Cargo.lock");
    in_file(&lock, fs::copy(root().join("Cargo.lock"), &lock))?;
    Ok(folder)
}

/// `cargo package` for all of them at once; it orders them by their dependencies itself.
fn pack(packages: &[Package]) -> Result<(), Failure> {
    step::run(cargo().args(["fetch", "--locked"]))?;
    let names = packages.iter().flat_map(|p| ["--package", &p.name]);
    // Those who change something here have not committed it. `cargo publish` refuses that.
    step::run(cargo().args(["package", "--quiet", "--no-verify", "--offline", "--locked", "--allow-dirty"]).args(names))
}

/// The name of a package's file and of the folder within it.
pub(crate) fn folder_name(package: &Package) -> String {
    format!("{}-{}", package.name, package.version)
}

/// The manifest of a workspace of unpacked packages.
fn workspace(packages: &[Package]) -> String {
    let members: Vec<_> = packages.iter().map(|p| format!("\"{}\"", folder_name(p))).collect();
    let patches = packages.iter().map(|p| format!("{} = {{ path = \"{}\" }}\n", p.name, folder_name(p)));
    let patches: String = patches.collect();
    format!("[workspace]\nresolver = \"3\"\nmembers = [{}]\n\n[patch.crates-io]\n{patches}", members.join(", "))
}

/// Counts and prints which files an unpacked package lacks.
fn lacking(package: &Package, folder: &Path) -> Result<usize, Failure> {
    let mut n_lacking = 0;
    for name in LICENCES {
        let ours = root().join(name);
        let ours = in_file(&ours, fs::read(&ours))?;
        if fs::read(folder.join(name)).ok().as_ref() != Some(&ours) {
            eprintln!("{}: {name} is missing from the package, or is not ours", package.name);
            n_lacking += 1;
        }
    }
    if !folder.join("README.md").is_file() {
        eprintln!("{}: README.md is missing from the package", package.name);
        n_lacking += 1;
    }
    Ok(n_lacking)
}

fn refuse_incomplete(packages: &[Package]) -> Result<(), Failure> {
    let mut n_found = 0;
    for package in packages {
        for what in incomplete(package) {
            eprintln!("{}: {what}", package.name);
            n_found += 1;
        }
    }
    if n_found == 0 {
        Ok(())
    } else {
        Err(Failure::Found { what: "defects in manifests of published crates", n: n_found })
    }
}

/// What a manifest lacks that a published crate needs.
fn incomplete(package: &Package) -> Vec<&'static str> {
    let wrong = [
        (package.description.as_deref().is_none_or(str::is_empty), "no description"),
        (package.readme.is_none(), "no README"),
        (package.license.is_none(), "no licence"),
        (package.keywords.is_empty() || package.keywords.len() > 5, "not one to five keywords"),
        (package.categories.is_empty() || package.categories.len() > 5, "not one to five categories"),
        (
            !package.features.is_empty() && !package.has_docs_rs,
            "has features, and does not tell docs.rs which to build",
        ),
    ];
    wrong.into_iter().filter_map(|(is_wrong, what)| is_wrong.then_some(what)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complete() -> Package {
        Package {
            name: "a".into(),
            version: "1.0.0".into(),
            description: Some("what".into()),
            readme: Some("README.md".into()),
            license: Some("MIT".into()),
            keywords: vec!["b".into()],
            categories: vec!["c".into()],
            ..Package::default()
        }
    }

    #[test]
    fn impostor_each_missing_part_of_a_manifest_is_caught() {
        assert!(incomplete(&complete()).is_empty());
        let spoil: [fn(&mut Package); 6] = [
            |p| p.description = None,
            |p| p.readme = None,
            |p| p.license = None,
            |p| p.keywords.clear(),
            |p| p.categories = vec!["c".into(); 6],
            |p| p.features = vec!["d".into()],
        ];
        for spoil in spoil {
            let mut package = complete();
            spoil(&mut package);
            assert_eq!(incomplete(&package).len(), 1, "{package:?}");
        }
    }

    #[test]
    fn our_manifests_are_complete() {
        refuse_incomplete(&metadata::published().expect("the workspace is readable")).expect("nothing is missing");
    }

    #[test]
    fn the_citation_and_the_changelog_have_the_version() {
        let version = &metadata::published().expect("the workspace is readable")[0].version;
        let text = |name: &str| fs::read_to_string(root().join(name)).expect("it is readable");
        assert!(text("CITATION.cff").lines().any(|l| l == format!("version: {version}")), "{version}");
        assert!(text("CHANGELOG.md").contains(version.as_str()), "{version}");
    }

    #[test]
    fn impostor_a_package_without_licences_is_caught() {
        let package = complete();
        assert_eq!(lacking(&package, &root().join("docs")).expect("our licences are readable"), LICENCES.len() + 1);
        assert_eq!(lacking(&package, root()).expect("our licences are readable"), 0);
    }

    #[test]
    fn the_workspace_of_packages_takes_them_from_itself() {
        let text = workspace(&[complete()]);
        assert!(text.contains("members = [\"a-1.0.0\"]") && text.ends_with("a = { path = \"a-1.0.0\" }\n"), "{text}");
    }
}
