//! Charts of speed against accuracy.
//! `cargo xtask chart`.

use clap::Parser;
use sightlines_lab::charts::{Settings, Task, growth, run};
use std::path::PathBuf;
use std::process::ExitCode;

/// Measures methods against each other, and draws what was measured.
#[derive(Debug, Clone, Parser)]
struct Args {
    /// Small generated scenes and few repeats, for CI.
    #[arg(long)]
    quick: bool,
    /// Measures nothing; draws what the folder's CSV say.
    #[arg(long, conflicts_with_all = ["quick", "only"])]
    draw: bool,
    /// Measures only this family; draws all.
    #[arg(long, value_name = "FAMILY")]
    only: Option<String>,
    /// The folder of CSV, SVG and the page.
    #[arg(long, value_name = "DIR", default_value = "docs/charts")]
    out: PathBuf,
}

fn main() -> ExitCode {
    // Methods that take what threads there are take one, like the others. No pool can have been started before.
    if let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(1).build_global() {
        eprintln!("{error}");
        return ExitCode::from(2);
    }
    growth::serve();
    let args = Args::parse();
    let data = std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from);
    if !args.quick && !args.draw && data.is_none() {
        eprintln!("!! SIGHTLINES_DATA is not set: real scenes are left out");
    }
    let task = Task { out: args.out, draw_only: args.draw, only: args.only };
    match run(&task, &Settings::here(args.quick, data)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
