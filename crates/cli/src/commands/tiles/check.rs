//! `tiles check`: whether the files of a baked world are whole and belong together.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::output::{JsonSchema, Serialize, bytes, count};
use crate::progress::Bar;
use sightlines::tiles::{TileTables, TiledWorld};
use std::fmt;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub(crate) struct TilesCheckArgs {
    /// The folder of the world
    #[arg(value_name = "FOLDER")]
    world: PathBuf,
    #[command(flatten)]
    json: JsonArg,
}

/// What was read.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Checked {
    /// The folder of the world.
    world: String,
    /// Tiles.
    n_tiles: usize,
    /// Cells of all tiles.
    n_cells: usize,
    /// Objects of all tiles.
    n_objects: usize,
    /// Bytes in memory if all tiles were loaded, without blocks that are kept.
    n_resident_bytes: usize,
}

pub(super) fn run(args: &TilesCheckArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let world = TiledWorld::open(&args.world)?;
    let n_tiles = world.index().tiles.len();
    let mut checked =
        Checked { world: args.world.display().to_string(), n_tiles, n_cells: 0, n_objects: 0, n_resident_bytes: 0 };
    let bar = Bar::new("tiles", show_progress);
    for (k, tile) in world.tiles().enumerate() {
        let tables = TileTables::load(&world, tile, 0)?;
        tables.verify()?;
        checked.n_cells += tables.table().n_cells();
        checked.n_objects += tables.table().n_objects();
        checked.n_resident_bytes += tables.n_bytes();
        bar.set(k + 1, n_tiles);
    }
    drop(bar);
    Ok(Done::new(args.json, checked))
}

impl fmt::Display for Checked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [tiles, cells, objects] = [(self.n_tiles, "tile"), (self.n_cells, "cell"), (self.n_objects, "object")]
            .map(|(n, noun)| count(n as u64, noun));
        writeln!(f, "{}: {tiles} with {cells} and {objects} are whole and of one bake", self.world)?;
        writeln!(f, "in memory      {}, if all were loaded", bytes(self.n_resident_bytes as u64))
    }
}
