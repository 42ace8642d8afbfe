//! `tiles`: a world that is too large for one table.

mod build;
pub(crate) mod check;
pub(crate) mod outcome;
pub(crate) mod query;

pub(crate) use build::{TilesBuildArgs, make};

use crate::command::{Done, Verbosity, commands};
use crate::error::Result;

#[derive(Debug, clap::Args)]
pub(crate) struct TilesArgs {
    #[command(subcommand)]
    pub(crate) what: TilesCommand,
}

commands! {
    enum TilesCommand:
    /// Bake the tiles of a world that are not baked yet, or that something nearby has changed for
    Build(Box<TilesBuildArgs>) => build::run,
    /// List what may be seen from a point of a baked world
    Query(query::TilesQueryArgs) => query::run,
    /// Read all files of a baked world, and check that they belong together
    Check(check::TilesCheckArgs) => check::run,
}

pub(crate) fn run(args: &TilesArgs, verbosity: Verbosity) -> Result<Done> {
    args.what.run(verbosity)
}
