//! The program `sightlines-vis`: what a map editor calls in the place of its `vis`.

mod arguments;

use crate::Answer;
use crate::commands::vis::{self, VisArgs};
use arguments::VisProgramArgs;
use clap::CommandFactory;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The options, as long ones.
pub(crate) fn command() -> clap::Command {
    VisProgramArgs::command()
}

/// Does what a command line asks for, which begins with the name of the program.
pub(crate) fn main(line: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args = VisProgramArgs::parse(line).unwrap_or_else(|error| error.exit());
    let vis = VisArgs::of_map(map_path(&args.map), args.fast, args.threads);
    match vis::run(&vis, !args.quiet, args.verbose) {
        Ok(Answer::Yes | Answer::No) => ExitCode::SUCCESS,
        Err(error) => {
            // Nothing is left to do if standard error is closed too.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

/// The map that a name stands for: editors name the source of the map, or leave the extension out.
fn map_path(name: &Path) -> PathBuf {
    let is_of_map = |extension: &str| ["map", "prt"].iter().any(|e| extension.eq_ignore_ascii_case(e));
    match name.extension().map(|extension| extension.to_string_lossy()) {
        Some(extension) if is_of_map(&extension) => name.with_extension("bsp"),
        Some(extension) if extension.eq_ignore_ascii_case("bsp") || name.is_file() => name.to_owned(),
        // A name with a dot in it, such as map.v2, is no extension.
        _ => {
            let mut longer = name.as_os_str().to_owned();
            longer.push(".bsp");
            longer.into()
        }
    }
}
