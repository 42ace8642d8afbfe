//! Installing a release as its users do, in a Debian that has nothing of ours.

use crate::debian::{files, in_file};
use crate::dist;
use crate::metadata;
use crate::package::{self, target};
use crate::step::{self, Failure, cargo};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The release of Debian that is installed into.
const SUITE: &str = "bookworm";

/// Installs the package for Debian, then the packages of the crates by `cargo install`, each in an empty Debian, and runs
/// the demo and the commands of the guides with each.
///
/// * `dist`: a folder with the files of a release; they are made if it is not given
pub(crate) fn check(dist: Option<PathBuf>) -> Result<(), Failure> {
    let dist = dist.map_or_else(|| dist::make(None), Ok)?;
    let work = target().join("install-check");
    in_file(&work, fs::create_dir_all(&work))?;
    let work = in_file(&work, fs::canonicalize(&work))?;
    let base = base(&work)?;
    let debian = Debian::fresh(&base, work.join("by-package"))?;
    by_package(&debian, &dist)?;
    let debian = Debian::fresh(&base, work.join("by-cargo"))?;
    by_cargo(&debian)?;
    eprintln!("installed in two ways, and the commands of the guides work with both");
    Ok(())
}

/// A Debian with nothing but its essential packages, made once.
fn base(work: &Path) -> Result<PathBuf, Failure> {
    let folder = work.join(SUITE);
    if !folder.join("etc/debian_version").is_file() || folder.join("debootstrap").is_dir() {
        if folder.is_dir() {
            in_file(&folder, fs::remove_dir_all(&folder))?;
        }
        step::run(Command::new("debootstrap").args(["--variant=minbase", SUITE]).arg(&folder))?;
    }
    Ok(folder)
}

/// A root folder to install into.
#[derive(Debug)]
struct Debian {
    root: PathBuf,
}

impl Debian {
    fn fresh(base: &Path, root: PathBuf) -> Result<Self, Failure> {
        if root.is_dir() {
            in_file(&root, fs::remove_dir_all(&root))?;
        }
        step::run(Command::new("cp").arg("-a").arg(base).arg(&root))?;
        Ok(Self { root })
    }

    /// Runs a line of a shell inside, with an environment of its own.
    fn shell(&self, line: &str) -> Result<(), Failure> {
        self.shell_with(line, None)
    }

    /// The same, where the toolchain of Rust lies below `/opt/rust`, if there is one.
    fn shell_with(&self, line: &str, toolchain: Option<&Path>) -> Result<(), Failure> {
        // In a namespace of mounts of its own, which ends with the command.
        let mut command = Command::new("unshare");
        command.args(["--mount", "/bin/sh", "-euc"]);
        command.arg(
            "mount --bind /proc \"$1/proc\"\n\
             [ -z \"$2\" ] || { mkdir -p \"$1/opt/rust\"; mount --bind -o ro \"$2\" \"$1/opt/rust\"; }\n\
             exec chroot \"$1\" /usr/bin/env -i HOME=/root PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin:/opt/rust/bin \
             DEBIAN_FRONTEND=noninteractive /bin/sh -euxc \"$3\"",
        );
        command.arg("sh").arg(&self.root).arg(toolchain.unwrap_or(Path::new(""))).arg(line);
        step::run(&mut command)
    }

    /// Copies a file or folder to a path inside.
    fn bring(&self, from: &Path, to: &str) -> Result<(), Failure> {
        step::run(Command::new("cp").arg("-rL").arg(from).arg(self.inside(to)))
    }

    fn inside(&self, path: &str) -> PathBuf {
        self.root.join(path.trim_start_matches('/'))
    }

    /// Runs the demo, and the tests that follow the guides with the program that is installed here.
    fn try_program(&self) -> Result<(), Failure> {
        self.shell("sightlines --version; sightlines-vis --version; cd /tmp; sightlines demo -q; ls sightlines-demo; rm -r sightlines-demo")?;
        let program = self.wrapper()?;
        let mut tests = cargo();
        tests.args(["test", "-p", "sightlines-cli", "--test", "cli", "--", "guides::"]);
        // The folders of the tests are to lie inside; real data lies outside.
        tests.env("TMPDIR", self.inside("/tmp")).env("SIGHTLINES_PROGRAM", &program).env_remove("SIGHTLINES_DATA");
        step::run(&mut tests)
    }

    /// A program outside that runs the one that is installed here.
    fn wrapper(&self) -> Result<PathBuf, Failure> {
        let program = self.inside("/run/installed-sightlines");
        in_file(&program, fs::write(&program, wrapper(&self.root)))?;
        step::run(Command::new("chmod").arg("+x").arg(&program))?;
        Ok(program)
    }
}

/// A program that runs the installed one inside `root`, in the same folder.
fn wrapper(root: &Path) -> String {
    let root = root.display();
    format!(
        "#!/bin/sh\nexec chroot '{root}' /usr/bin/env -i PATH=/usr/local/bin:/usr/bin:/bin /bin/sh -c \
         'cd \"$1\" && shift && exec sightlines \"$@\"' sh \"${{PWD#'{root}'}}\" \"$@\"\n"
    )
}

fn by_package(debian: &Debian, dist: &Path) -> Result<(), Failure> {
    let debs = files(dist)?.into_iter().filter(|p| p.extension().is_some_and(|e| e == "deb"));
    let debs: Vec<_> = debs.collect();
    let [deb] = debs.as_slice() else {
        return Err(Failure::Found { what: "packages for Debian, not one", n: debs.len() });
    };
    debian.bring(deb, "/tmp/sightlines.deb")?;
    debian.shell("dpkg -i /tmp/sightlines.deb; dpkg -L sightlines | grep -c /man1/")?;
    debian.try_program()?;
    debian.shell("dpkg -r sightlines; ! command -v sightlines")?;
    // The impostor: what the guides were followed with was that one, for it is gone.
    match step::run(Command::new(debian.wrapper()?).arg("--version").current_dir(debian.inside("/tmp"))) {
        Err(Failure::Status { .. }) => Ok(()),
        Ok(()) => Err(Failure::Found { what: "programs left after their package was removed", n: 1 }),
        other => other,
    }
}

/// `cargo install` of the program's package with what Cargo finds newest of everything else, but for our own crates, which it takes from
/// their packages as it would from the registry.
fn by_cargo(debian: &Debian) -> Result<(), Failure> {
    let packages = metadata::published()?;
    let unpacked = package::unpacked(&packages)?;
    let (crates, home) = (debian.inside("/crates"), debian.inside("/cargo"));
    for folder in [&crates, &home] {
        in_file(folder, fs::create_dir_all(folder))?;
    }
    let mut patches = String::from("[patch.crates-io]\n");
    for package in &packages {
        let name = package::folder_name(package);
        debian.bring(&unpacked.join(&name), "/crates/")?;
        patches += &format!("{} = {{ path = \"/crates/{name}\" }}\n", package.name);
    }
    let config = home.join("config.toml");
    in_file(&config, fs::write(&config, patches))?;
    // The certificates of this machine, which may stand behind a proxy.
    let certificates = Path::new("/etc/ssl/certs/ca-certificates.crt");
    if certificates.is_file() {
        let folder = debian.inside("/etc/ssl/certs");
        in_file(&folder, fs::create_dir_all(&folder))?;
        debian.bring(certificates, "/etc/ssl/certs/ca-certificates.crt")?;
    }
    debian.shell("apt-get update -q; apt-get install -q -y --no-install-recommends gcc libc6-dev")?;
    let toolchain = PathBuf::from(step::output(Command::new("rustc").args(["--print", "sysroot"]))?.trim());
    let program = packages.iter().find(|p| p.name == "sightlines-cli").map(package::folder_name).unwrap_or_default();
    let install = format!(
        "export CARGO_HOME=/cargo CARGO_HTTP_CAINFO=/etc/ssl/certs/ca-certificates.crt; cargo install --path /crates/{program} --root /usr/local"
    );
    debian.shell_with(&install, Some(&toolchain))?;
    debian.try_program()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wrapper_goes_to_the_same_folder_inside() {
        let text = wrapper(Path::new("/a/b"));
        assert!(text.starts_with("#!/bin/sh\nexec chroot '/a/b' ") && text.contains("\"${PWD#'/a/b'}\""), "{text}");
    }
}
