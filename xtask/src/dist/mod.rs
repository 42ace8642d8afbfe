//! What a release offers for download: programs, manuals, licences, a bill of materials, a package for Debian, checksums.
//!
//! The same sources, toolchain and system libraries give the same bytes, wherever they are built.

mod deb;
mod linked;
mod notices;
mod sbom;

use crate::debian::{files, in_file};
use crate::metadata;
use crate::package::target;
use crate::step::{self, Failure, cargo, root};
use linked::Linked;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The programs of a release.
const PROGRAMS: [&str; 2] = ["sightlines", "sightlines-vis"];
/// Texts that lie beside them.
const TEXTS: [&str; 9] = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-MIT",
    "LICENSE-APACHE",
    "docs/guides/quake.md",
    "docs/guides/doom.md",
    "docs/guides/udb/sightlines.cfg",
    "docs/guides/udb/zdbsp-reject.cmd",
    "docs/guides/udb/zdbsp-reject.sh",
];
/// The name of the file with the licences of others.
const NOTICES: &str = "THIRD-PARTY-LICENSES.txt";

/// What a release is made of.
#[derive(Debug)]
struct Release {
    version: String,
    /// The platform, as Rust names it.
    platform: String,
    /// The time of the commit, in seconds since 1970: the only time in any file.
    epoch: String,
    rustc: String,
    packages: Vec<Linked>,
}

/// Makes all files of a release below `out`, `target/dist` if it is not given; returns where they are.
pub(crate) fn make(out: Option<PathBuf>) -> Result<PathBuf, Failure> {
    let out = out.unwrap_or_else(|| target().join("dist"));
    in_file(&out, fs::create_dir_all(&out))?;
    let out = in_file(&out, fs::canonicalize(&out))?;
    let release = release()?;
    let built = build(&out.join("build"))?;
    let name = format!("sightlines-{}-{}", release.version, release.platform);
    let tree = out.join("tree").join(&name);
    stage(&tree, &built, &release)?;
    let files = out.join("files");
    empty(&files)?;
    archive(&tree, &files.join(format!("{name}.tar.gz")), &release.epoch)?;
    let bill = files.join(format!("sightlines-{}.cdx.json", release.version));
    in_file(&bill, fs::write(&bill, sbom::text(&release)?))?;
    match deb::make(&tree, &out.join("deb"), &files, &release) {
        Err(Failure::NoDebian) => eprintln!("!! this is no Debian with dpkg-dev: the package for it WILL BE MISSING"),
        other => other?,
    }
    checksums(&files)?;
    Ok(files)
}

fn release() -> Result<Release, Failure> {
    let version = metadata::published()?.swap_remove(0).version;
    let rustc = step::output(Command::new("rustc").arg("-vV"))?;
    let line = |key: &str| rustc.lines().find_map(|l| l.strip_prefix(key)).unwrap_or_default().trim().to_owned();
    let (platform, rustc) = (line("host:"), line("release:"));
    let epoch = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(epoch) => epoch,
        Err(_) => {
            step::output(Command::new("git").current_dir(root()).args(["log", "-1", "--format=%ct"]))?.trim().to_owned()
        }
    };
    let packages = linked::packages(&platform)?;
    Ok(Release { version, platform, epoch, rustc, packages })
}

/// Compiles the programs with all features, and the one that writes their manuals; returns the folder that they are in.
fn build(folder: &Path) -> Result<PathBuf, Failure> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    // Later ones count first.
    let replaced =
        [(Some(root().to_path_buf()), "sightlines"), (home, "cargo"), (Some(folder.to_path_buf()), "target")];
    let (mut rust, mut c) = (OsString::new(), OsString::new());
    for (from, to) in replaced.iter().filter_map(|(from, to)| Some((from.as_ref()?, to))) {
        if !rust.is_empty() {
            rust.push("\u{1f}");
            c.push(" ");
        }
        for (flags, option) in [(&mut rust, "--remap-path-prefix="), (&mut c, "-ffile-prefix-map=")] {
            flags.push(option);
            flags.push(from);
            flags.push("=");
            flags.push(to);
        }
    }
    let mut command = cargo();
    command.args(["build", "--release", "--locked", "-p", "sightlines-cli", "-p", "sightlines-manuals"]);
    command.args(["--features", step::FULL_PROGRAM, "--target-dir"]).arg(folder);
    command.env("CARGO_ENCODED_RUSTFLAGS", rust).env("CFLAGS", c).env_remove("RUSTFLAGS");
    step::run(command.envs([("CARGO_PROFILE_RELEASE_STRIP", "symbols"), ("CARGO_INCREMENTAL", "0")]))?;
    Ok(folder.join("release"))
}

/// Lays out what an archive contains: `bin`, `share/man`, completions, `share/doc`.
fn stage(tree: &Path, built: &Path, release: &Release) -> Result<(), Failure> {
    empty(tree)?;
    let (bin, share) = (tree.join("bin"), tree.join("share"));
    let doc = share.join("doc/sightlines");
    for folder in [&bin, &doc.join("docs/guides/udb")] {
        in_file(folder, fs::create_dir_all(folder))?;
    }
    for program in PROGRAMS {
        copy(&built.join(program), &bin.join(program))?;
    }
    step::run(Command::new(built.join("sightlines-manuals")).arg(&share))?;
    for text in TEXTS {
        copy(&root().join(text), &doc.join(text))?;
    }
    let notices = doc.join(NOTICES);
    in_file(&notices, fs::write(&notices, notices::text(release)?))
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    in_file(from, fs::copy(from, to)).map(|_| ())
}

/// Makes a folder, and removes what was in it.
fn empty(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        in_file(folder, fs::remove_dir_all(folder))?;
    }
    in_file(folder, fs::create_dir_all(folder))
}

/// An archive with sorted names, the time of the commit, and no owners.
fn archive(tree: &Path, file: &Path, epoch: &str) -> Result<(), Failure> {
    let (parent, name) = (tree.parent().expect("it lies in a folder"), tree.file_name().expect("it has a name"));
    let plain = file.with_extension("");
    let mut tar = Command::new("tar");
    tar.args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=u+rw,go+r-w,a+X", "--format=ustar"]);
    step::run(tar.arg(format!("--mtime=@{epoch}")).arg("-C").arg(parent).arg("-cf").arg(&plain).arg(name))?;
    step::run(Command::new("gzip").args(["-9", "-n", "-f"]).arg(&plain))
}

/// `SHA256SUMS` of all files in a folder, as `sha256sum --check` reads it.
fn checksums(folder: &Path) -> Result<(), Failure> {
    let names: Vec<_> = files(folder)?.iter().filter_map(|p| Some(p.file_name()?.to_owned())).collect();
    let sums = step::output(Command::new("sha256sum").current_dir(folder).args(names))?;
    let file = folder.join("SHA256SUMS");
    in_file(&file, fs::write(&file, &sums))?;
    print!("{sums}");
    Ok(())
}
