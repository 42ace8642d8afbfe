//! `tiles`: a world that is too large for one table.

mod build;
pub(crate) mod check;
pub(crate) mod outcome;
pub(crate) mod query;

pub(crate) use build::{TilesBuildArgs, make};
pub(crate) use outcome::Outcome;

use crate::command::{Done, Verbosity};
use crate::error::Result;
use clap::Subcommand;

/// Arguments of `tiles`.
#[derive(Debug, clap::Args)]
pub(crate) struct TilesArgs {
    #[command(subcommand)]
    pub(crate) what: TilesCommand,
}

/// What to do with a world.
#[derive(Debug, Subcommand)]
pub(crate) enum TilesCommand {
    /// Bake the tiles of a world that are not baked yet, or that something nearby has changed for
    Build(Box<TilesBuildArgs>),
    /// List what may be seen from a point of a baked world
    Query(query::TilesQueryArgs),
    /// Read all files of a baked world, and check that they belong together
    Check(check::TilesCheckArgs),
}

pub(crate) fn run(args: &TilesArgs, verbosity: Verbosity) -> Result<Done> {
    match &args.what {
        TilesCommand::Build(args) => build::run(args, verbosity),
        TilesCommand::Query(args) => query::run(args, verbosity),
        TilesCommand::Check(args) => check::run(args, verbosity),
    }
}
