//! The module of WebAssembly: Debian's compiler, which needs no server of Rust's, builds it with the standard library from its sources.

use crate::debian::{self, in_file};
use crate::package;
use crate::step::{self, Failure, cargo, root};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiler, its cargo, the sources of the standard library, a linker.
const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld-22"];
const LINKER: &str = "usr/lib/llvm-22/bin/wasm-ld";
const TARGET: &str = "wasm32-unknown-unknown";

fn outputs() -> PathBuf {
    package::target().join("wasm")
}

/// The folder in which the packages lie: that of the system, or one below `target` into which they are unpacked.
fn toolchain() -> Result<PathBuf, Failure> {
    let is_complete = |folder: &Path| {
        ["usr/bin/rustc", "usr/bin/cargo", "usr/lib/rustlib/src/rust/library", LINKER]
            .iter()
            .all(|file| folder.join(file).exists())
    };
    let (system, own) = (PathBuf::from("/"), outputs().join("toolchain"));
    if let Some(found) = [&system, &own].into_iter().find(|folder| is_complete(folder)) {
        return Ok(found.clone());
    }
    let work = own.with_extension("part");
    for folder in [&work, &own] {
        if folder.exists() {
            in_file(folder, fs::remove_dir_all(folder))?;
        }
    }
    let (packages, unpacked) = (work.join("packages"), work.join("unpacked"));
    in_file(&packages, fs::create_dir_all(&packages))?;
    let missing = debian::missing(&packages, &PACKAGES)?;
    let wanted: BTreeSet<&str> = missing.iter().map(String::as_str).chain(PACKAGES).collect();
    debian::download(&packages, &wanted.into_iter().collect::<Vec<_>>())?;
    for file in debian::files(&packages)? {
        if file.extension().is_some_and(|e| e == "deb") {
            debian::unpack(&file, &unpacked)?;
        }
    }
    in_file(&own, fs::rename(&unpacked, &own))?;
    in_file(&work, fs::remove_dir_all(&work))?;
    if is_complete(&own) { Ok(own) } else { Err(Failure::Found { what: "compilers for WebAssembly", n: 0 }) }
}

/// Where the libraries of unpacked packages are.
fn libraries(toolchain: &Path) -> OsString {
    let mut path = OsString::new();
    for folder in ["usr/lib/x86_64-linux-gnu", "usr/lib/aarch64-linux-gnu", "usr/lib/llvm-22/lib"] {
        path.push(toolchain.join(folder));
        path.push(":");
    }
    path.push(std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default());
    path
}

/// The cargo of the toolchain, told to build the standard library too.
fn toolchain_cargo(toolchain: &Path, verb: &str) -> Command {
    let mut command = Command::new(toolchain.join("usr/bin/cargo"));
    command.current_dir(root()).args([verb, "--locked", "--target", TARGET, "-Zbuild-std=std,panic_abort"]);
    // What is unstable is to build the standard library, which this compiler has no other way to have.
    command.env("RUSTC", toolchain.join("usr/bin/rustc")).env("RUSTC_BOOTSTRAP", "1");
    command.env("CARGO_TARGET_DIR", outputs());
    command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", toolchain.join(LINKER));
    // As much stack as a program has, mostly.
    command.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", "-C link-arg=-zstack-size=8388608");
    if toolchain != Path::new("/") {
        command.env("LD_LIBRARY_PATH", libraries(toolchain));
    }
    // Those of the cargo that runs this program.
    for variable in ["CARGO", "RUSTUP_TOOLCHAIN", "RUSTDOC", "RUSTFLAGS", "RUSTC_WRAPPER"] {
        command.env_remove(variable);
    }
    command
}

/// A toolchain, with the packages that the standard library is made of.
fn fetched() -> Result<PathBuf, Failure> {
    let toolchain = toolchain()?;
    step::run(&mut toolchain_cargo(&toolchain, "fetch"))?;
    Ok(toolchain)
}

/// Builds the module; where it is.
fn build(toolchain: &Path) -> Result<PathBuf, Failure> {
    step::run(toolchain_cargo(toolchain, "build").args(["--release", "-p", "sightlines-wasm"]))?;
    Ok(outputs().join(TARGET).join("release/sightlines_wasm.wasm"))
}

/// Builds the module, and writes the playground beside it.
pub(crate) fn playground() -> Result<(), Failure> {
    let module = build(&fetched()?)?;
    let page = outputs().join("playground.html");
    let script = root().join("integrations/web/playground/make.mjs");
    step::run(Command::new("node").arg(script).arg(&module).arg(&page))?;
    println!("{}\n{}", module.display(), page.display());
    Ok(())
}

/// Builds the module, and runs its tests in Node and in a browser. Where there is no compiler to be had, that is said and nothing runs.
pub(crate) fn check() -> Result<(), Failure> {
    let toolchain = match fetched() {
        Ok(toolchain) => toolchain,
        Err(failure) => {
            eprintln!("!! {failure}: the module of WebAssembly WILL NOT be built or tested");
            return Ok(());
        }
    };
    let test = ["test", "-p", "sightlines-tests", "--test", "workspace", "web_module::"];
    step::run(cargo().args(test).env("SIGHTLINES_WASM", build(&toolchain)?))
}
