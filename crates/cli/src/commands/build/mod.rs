//! `build`: from a plan, a scene in space or a portal file to its table.

pub(crate) mod facts;
mod options;
pub(crate) mod plan;
mod portals;
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
    /// A WAD, a floor plan as GeoJSON, a scene in space as GLB, glTF or OBJ, or a portal file of a Quake map
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

pub(crate) fn run(args: &BuildArgs, show_progress: bool, verbose: bool) -> Result<Answer, CliError> {
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
        Input::Portals(prt) => {
            let baked = portals::bake(path, &prt, bake, show_progress)?;
            let bytes = baked.table.to_bytes();
            output::save(out, &bytes)?;
            output::print(args.json, &portals::Outcome::new(out, &prt, bake, &baked, bytes.len()).verbose(verbose))?;
        }
    }
    Ok(Answer::Yes)
}
