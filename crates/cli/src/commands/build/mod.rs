//! `build`: from a plan or a scene in space to its table.

pub(crate) mod facts;
mod options;
pub(crate) mod plan;
pub(crate) mod space;

pub(crate) use options::{BakeArgs, refuse};

use crate::Answer;
use crate::error::CliError;
use crate::input::{self, Input};
use crate::output;
use std::path::PathBuf;

/// Arguments of `build`.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// A WAD, a floor plan as GeoJSON, or a scene in space as GLB, glTF or OBJ
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The table to write
    #[arg(short, long, value_name = "OUT.pvs")]
    output: PathBuf,
    /// Which map of the WAD; not needed if there is only one
    #[arg(long, value_name = "NAME")]
    map: Option<String>,
    #[command(flatten)]
    bake: BakeArgs,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &BuildArgs, show_progress: bool) -> Result<Answer, CliError> {
    let BuildArgs { input: path, output: out, bake, .. } = args;
    output::refuse_same(path, out)?;
    match input::read(path, args.map.as_deref())? {
        Input::Plan(file) => {
            let baked = plan::bake(path, &file, bake, show_progress)?;
            output::save(out, &baked.table.to_bytes())?;
            output::print(args.json, &plan::Outcome::new(out, file.map, &baked))?;
        }
        Input::Scene(file) => {
            let baked = space::bake(path, &file, bake, show_progress)?;
            output::save(out, &baked.table.to_bytes())?;
            output::print(args.json, &space::Outcome::new(out, &file, bake, &baked))?;
        }
    }
    Ok(Answer::Yes)
}
