//! A package for Debian and its relatives, from the tree of the archive.

use super::{PROGRAMS, Release, copy, empty};
use crate::debian::{files, in_file};
use crate::step::{self, Failure};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

/// Writes `sightlines_VERSION-1_ARCH.deb` into `out`.
///
/// * `tree`: what it installs below `/usr`
/// * `work`: a folder that is emptied
pub(super) fn make(tree: &Path, work: &Path, out: &Path, release: &Release) -> Result<(), Failure> {
    let architecture = output(Command::new("dpkg").arg("--print-architecture"))?;
    let depends = depends(&work.join("depends"), tree)?;
    let package = work.join("package");
    let usr = package.join("usr");
    empty(&usr)?;
    step::run(Command::new("cp").arg("-r").arg(tree.join("bin")).arg(tree.join("share")).arg(&usr))?;
    for page in files(&usr.join("share/man/man1"))? {
        step::run_silently(Command::new("gzip").args(["-9", "-n"]).arg(page))?;
    }
    let doc = usr.join("share/doc/sightlines");
    copy(&doc.join("LICENSE-MIT"), &doc.join("copyright"))?;
    let size = output(Command::new("du").args(["-sk", "--apparent-size"]).arg(&usr))?;
    let size = size.split_whitespace().next().unwrap_or("0").to_owned();
    let control = package.join("DEBIAN");
    in_file(&control, fs::create_dir_all(&control))?;
    let file = control.join("control");
    in_file(&file, fs::write(&file, fields(&release.version, architecture.trim(), &depends, &size)))?;
    step::run(Command::new("chmod").args(["-R", "u+rwX,go+rX,go-w"]).arg(&package))?;
    let name = format!("sightlines_{}-1_{}.deb", release.version, architecture.trim());
    let mut build = Command::new("dpkg-deb");
    build.args(["--root-owner-group", "-Zxz", "--build"]).arg(&package).arg(out.join(name));
    step::run(build.env("SOURCE_DATE_EPOCH", &release.epoch))
}

/// The libraries that the programs load, with the versions that have all they need: `libc6 (>= 2.34), libgcc-s1 (>= 4.2)`.
fn depends(work: &Path, tree: &Path) -> Result<String, Failure> {
    // It wants to stand beside the file of a source package.
    let control = work.join("debian");
    empty(&control)?;
    let file = control.join("control");
    in_file(&file, fs::write(&file, "Source: sightlines\n\nPackage: sightlines\nArchitecture: any\n"))?;
    let mut command = Command::new("dpkg-shlibdeps");
    command.current_dir(work).arg("-O").args(PROGRAMS.map(|p| tree.join("bin").join(p)));
    let lines = output(&mut command)?;
    Ok(lines.lines().find_map(|l| l.strip_prefix("shlibs:Depends=")).unwrap_or_default().to_owned())
}

/// What `dpkg` knows of the package.
fn fields(version: &str, architecture: &str, depends: &str, size: &str) -> String {
    format!(
        "Package: sightlines\nVersion: {version}-1\nArchitecture: {architecture}\nMaintainer: The sightlines developers\n\
         Installed-Size: {size}\nDepends: {depends}\nSuggests: libvulkan1\nSection: graphics\nPriority: optional\n\
         Description: precomputed visibility that never hides what can be seen\n \
         Computes, with exact decisions, which parts of a scene can be seen from\n which: of floor plans, Doom and Quake maps, and \
         scenes in space. Writes\n tables for games and tools, REJECT lumps, and the visibility of Quake maps.\n"
    )
}

fn output(command: &mut Command) -> Result<String, Failure> {
    step::output(command).map_err(|failure| match failure {
        Failure::Start { error, .. } if error.kind() == ErrorKind::NotFound => Failure::NoDebian,
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_lines_and_the_description_is_indented() {
        let text = fields("1.2.3", "amd64", "libc6 (>= 2.36)", "5");
        assert!(
            text.contains("\nVersion: 1.2.3-1\nArchitecture: amd64\n") && text.contains("\nDepends: libc6 (>= 2.36)\n")
        );
        let description = text.lines().skip_while(|l| !l.starts_with("Description: ")).skip(1);
        assert!(description.clone().count() == 3 && description.clone().all(|l| l.starts_with(' ')), "{text}");
        assert!(text.ends_with('\n'));
    }
}
