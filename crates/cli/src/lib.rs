#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: arguments, files by name, what is printed where, exit codes. The two programs are a line each: [`sightlines()`] and
//!   [`sightlines_vis`]. Their options, for manuals and shells: [`command`], [`vis_command`].
//! - **Out of scope**: how anything is computed; every command is a few calls of the library.
//! - **Invariants**: results go to standard output, everything else to standard error; an output file appears
//!   whole or not at all, and not if anything failed; a closed pipe is no error.

mod args;
mod buffers;
mod clusters;
mod command;
mod commands;
mod doors;
mod error;
mod eye;
mod facts;
mod foreign;
mod glb;
mod input;
mod interrupt;
mod json;
mod kept;
mod map_portals;
mod memory;
mod named;
mod numbers;
mod output;
mod output_kind;
mod picture;
mod place;
mod plain;
mod plans;
mod progress;
mod reasons;
mod refuse;
mod region;
mod same_scene;
mod sight;
mod simplification;
mod surfaces;
mod tables;
mod threads;
mod up;
mod view;
mod vis_program;
mod walk_path;

use args::Arguments;
use clap::{CommandFactory, Parser};
use command::{Answer, Verbosity};
use error::{Result, StdoutError};
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;
use tracing_subscriber::filter::LevelFilter;

/// The program `sightlines`: reads the arguments of the process, does what they ask for, prints, and returns the exit code.
///
/// Ends the process by itself for arguments that are wrong (exit code 2), and after `--help` and `--version`.
pub fn sightlines() -> ExitCode {
    let arguments = Arguments::parse();
    log_to_stderr(&arguments);
    exit_code(run(&arguments))
}

/// The program `sightlines-vis`, which takes the place of a map editor's `vis`; otherwise as [`sightlines()`].
pub fn sightlines_vis() -> ExitCode {
    vis_program::main(std::env::args_os())
}

/// The commands and options of `sightlines`.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// The options of `sightlines-vis`, as long ones. The program takes each with any number of dashes in front, one for example.
pub fn vis_command() -> clap::Command {
    vis_program::command()
}

/// JSON schemas of what `sightlines` prints with `--json`, a type of results each, with the titles of its variants, or the one that it has.
pub fn json_schemas() -> Vec<(&'static [&'static str], serde_json::Value)> {
    json::schemas()
}

/// The exit code of a program, which prints what went wrong.
fn exit_code(result: Result<Answer>) -> ExitCode {
    match result {
        Ok(Answer::Yes) => ExitCode::SUCCESS,
        Ok(Answer::No) => ExitCode::FAILURE,
        Ok(Answer::Incomplete) => ExitCode::from(3),
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) if interrupt::requested() => {
            let _ = writeln!(std::io::stderr(), "{error}");
            ExitCode::from(interrupt::exit_code())
        }
        Err(error) => {
            // Nothing is left to do if standard error is closed too.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Runs a command, and prints its result.
fn run(arguments: &Arguments) -> Result<Answer> {
    let verbosity = Verbosity { show_progress: !arguments.quiet, verbose: arguments.verbose > 0 };
    arguments.command.run(verbosity)?.print()
}

/// Whether standard output was closed by its reader, which has read enough.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let closed = |error: &StdoutError| error.0.kind() == ErrorKind::BrokenPipe;
    error.chain().any(|error| error.downcast_ref().is_some_and(closed))
}

fn log_to_stderr(arguments: &Arguments) {
    let level = match (arguments.quiet, arguments.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, _) => LevelFilter::DEBUG,
    };
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_max_level(level)
        .with_target(false)
        .without_time()
        .init();
}
