//! `tiles query`: what may be seen from a point of a baked world.

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::output::{JsonSchema, Serialize, count};
use crate::place::Point;
use sightlines::tiles::{Seen, TileId, TileScratch, TileTables, TiledWorld};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Bytes of blocks of a table that a query keeps.
const CACHE: usize = 16 << 20;

#[derive(Debug, clap::Args)]
pub(crate) struct TilesQueryArgs {
    /// The folder of the world
    #[arg(value_name = "FOLDER")]
    world: PathBuf,
    /// The eye, in scene units; exit code 1 outside every cell, where everything may be visible
    #[arg(long, help_heading = "Viewer", value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Point,
    #[command(flatten)]
    json: JsonArg,
}

/// What is seen of a tile.
#[derive(Debug, Default, Serialize, JsonSchema)]
struct OfTile {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cells: Vec<u32>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    objects: Vec<u32>,
    /// Whether anything of it may be seen, and no more is known.
    whole: bool,
}

/// Exit code 1 if the eye is outside every cell.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Found {
    /// The eye.
    eye: [f64; 3],
    /// The tiles in which the eye is in a cell.
    tiles: Vec<String>,
    /// What may be seen, by the names of tiles; empty outside every cell.
    seen: BTreeMap<String, OfTile>,
    /// Tiles of the world.
    n_tiles: usize,
}

pub(super) fn run(args: &TilesQueryArgs, _: Verbosity) -> Result<Done> {
    let world = TiledWorld::open(&args.world)?;
    let eye = args.eye.spatial(&args.world)?;
    let (mut at, mut inside, mut seen, mut scratch) = (Vec::new(), Vec::new(), Seen::default(), TileScratch::default());
    world.tiles_at(eye, &mut at);
    for &tile in &at {
        let tables = TileTables::load(&world, tile, CACHE)?;
        if tables.see(eye, &mut seen, &mut scratch)? {
            inside.push(tile);
        }
    }
    seen.sort();
    let name = |tile: TileId| world.tile(tile).map(|entry| entry.name.clone()).unwrap_or_default();
    let mut of: BTreeMap<String, OfTile> = BTreeMap::new();
    seen.cells.iter().for_each(|&(tile, cell)| of.entry(name(tile)).or_default().cells.push(cell.0));
    seen.objects.iter().for_each(|&(tile, object)| of.entry(name(tile)).or_default().objects.push(object.0));
    seen.tiles.iter().for_each(|&tile| of.entry(name(tile)).or_default().whole = true);
    let found =
        Found { eye, tiles: inside.into_iter().map(name).collect(), seen: of, n_tiles: world.index().tiles.len() };
    let is_inside = !found.tiles.is_empty();
    Ok(Done::new(args.json, found).answering_whether(is_inside))
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.eye;
        if self.tiles.is_empty() {
            return writeln!(f, "{x},{y},{z} is outside every cell: everything may be visible");
        }
        writeln!(f, "{x},{y},{z} is in {}", self.tiles.join(", "))?;
        let (whole, parts): (Vec<_>, Vec<_>) = self.seen.iter().partition(|(_, of)| of.whole);
        for (tile, of) in parts {
            let [cells, objects] =
                [(of.cells.len(), "cell"), (of.objects.len(), "object")].map(|(n, noun)| count(n as u64, noun));
            writeln!(f, "{tile:<14} {cells}, {objects}")?;
        }
        let names: Vec<&str> = whole.into_iter().map(|(tile, _)| &**tile).collect();
        writeln!(f, "far away       something of {} of {} tiles: {}", names.len(), self.n_tiles, names.join(", "))
    }
}
