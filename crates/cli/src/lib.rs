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
mod commands;
mod doors;
mod error;
mod eye;
mod facts;
mod glb;
mod input;
mod interrupt;
mod kept;
mod map_portals;
mod memory;
mod named;
mod numbers;
mod output;
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
mod unproven;
mod view;
mod vis_program;
mod walk_path;

use args::{Arguments, Command};
use clap::{CommandFactory, Parser};
use error::{Result, StdoutError};
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;
use tracing_subscriber::filter::LevelFilter;

/// What a command found, as the program's exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    /// Done; exit code 0.
    Yes,
    /// Done, and the answer is no, such as for a point outside every cell; exit code 1.
    No,
    /// A job is not complete: some of its shards are to be done; exit code 3.
    Incomplete,
}

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

/// Runs a command.
fn run(arguments: &Arguments) -> Result<Answer> {
    let show_progress = !arguments.quiet;
    Ok(match &arguments.command {
        Command::Build(args) => commands::build::run(args, show_progress, arguments.verbose > 0)?,
        Command::Reject(args) => commands::reject::run(args, show_progress)?,
        Command::Job(args) => commands::job::run(args, show_progress, arguments.verbose > 0)?,
        Command::Vis(args) => commands::vis::run(args, show_progress, arguments.verbose > 0)?,
        Command::Tiles(args) => commands::tiles::run(args, show_progress)?,
        Command::Verify(args) => commands::verify::run(args, show_progress)?,
        Command::Plan(args) => commands::plan::run(args)?,
        Command::Portals(args) => commands::portals::run(args)?,
        Command::Isovist(args) => commands::isovist::run(args)?,
        Command::Query(args) => commands::query::run(args)?,
        Command::Walk(args) => commands::walk::run(args, show_progress)?,
        Command::Pack(args) => commands::pack::pack(args)?,
        Command::Unpack(args) => commands::pack::unpack(args)?,
        Command::Export(args) => commands::export::run(args)?,
        Command::Explain(args) => commands::explain::run(args)?,
        Command::Draw(args) => commands::draw::run(args)?,
        Command::View(args) => commands::view::run(args, show_progress)?,
        Command::Multifocal(args) => commands::multifocal::run(args)?,
        Command::Render(args) => commands::render::run(args, show_progress)?,
        Command::Vga(args) => commands::vga::run(args, show_progress)?,
        Command::Light(args) => commands::light::run(args)?,
        Command::Simplify(args) => commands::simplify::run(args, show_progress)?,
        Command::Levels(args) => commands::levels::run(args, show_progress)?,
        Command::Info(args) => commands::info::run(args)?,
        Command::Generate(args) => commands::generate::run(args)?,
        Command::Demo(args) => commands::demo::run(args, show_progress)?,
    })
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
