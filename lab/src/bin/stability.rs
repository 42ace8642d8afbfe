//! `cargo xtask stability`: pushes methods to where they fail, and draws it.
//!
//! Exit code 0 if all is as it must be, 1 if a shipped method hides something wrongly, a naive one never does, or
//! something could not be read or written, 2 for a wrong command line.

use clap::Parser;
use sightlines_lab::stability::{Options, all, run};
use std::path::PathBuf;
use std::process::ExitCode;

/// Sweeps that push each method to where it fails: CSV, pictures and a page.
#[derive(Debug, Parser)]
struct Arguments {
    /// Fewer levels and cases, for every change; written below target/ unless --out says where.
    #[arg(long)]
    quick: bool,
    /// Only sweeps with this in their name.
    #[arg(long, value_name = "SWEEP")]
    only: Option<String>,
    /// Folder of the page; CSV and pictures go into its folder `stability` [default: docs/charts, with --quick
    /// target/charts].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Measure nothing: draw from the CSV files that are there.
    #[arg(long)]
    draw: bool,
    /// Print the first finding of methods with this in their name at each level, with all coordinates.
    #[arg(long, value_name = "METHOD")]
    show: Option<String>,
}

fn main() -> ExitCode {
    let Arguments { quick, only, out, draw, show } = Arguments::parse();
    let out = out.unwrap_or_else(|| PathBuf::from(if quick && !draw { "target/charts" } else { "docs/charts" }));
    match run(&all(quick), &Options { out, only, draw, show }) {
        Ok((text, complaints)) => {
            print!("{text}");
            complaints.iter().for_each(|complaint| eprintln!("FAILED {complaint}"));
            ExitCode::from(u8::from(!complaints.is_empty()))
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
