//! `export`: a table as JSON.

use crate::command::{Done, Verbosity};
use crate::error::Result;
use crate::{input, output};
use sightlines::report::{export_json, write_json};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct ExportArgs {
    /// The table
    #[arg(value_name = "FILE.pvs")]
    table: PathBuf,
    /// The file to write [default: standard output]
    #[arg(short, long, help_heading = "Output", value_name = "OUT.json")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &ExportArgs, _: Verbosity) -> Result<Done> {
    if let Some(path) = &args.output {
        output::check(&[&args.table], &[path])?;
    }
    let table = input::table(&args.table)?;
    match &args.output {
        None => output::stdout(|out| {
            write_json(&table, &mut *out)?;
            writeln!(out)
        })?,
        Some(path) => output::save(path, (export_json(&table) + "\n").as_bytes())?,
    }
    Ok(Done::silently())
}
