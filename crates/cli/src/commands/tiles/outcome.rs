//! What became of the tiles of a world.

use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::bake::world::WorldReport;
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// The result.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The plan of the world.
    world: String,
    /// The folder that was written.
    out: String,
    /// Tiles.
    n_tiles: usize,
    /// Tiles that were baked.
    n_baked: usize,
    /// Tiles of which only was decided what they see of those farther away.
    n_far_only: usize,
    /// Tiles that were kept from an earlier bake.
    n_kept: usize,
    /// Tables of earlier bakes that were removed.
    n_removed: usize,
    /// Cells of all tiles.
    n_cells: usize,
    /// Objects of all tiles.
    n_objects: usize,
    /// Bytes of all files of tiles.
    n_bytes: u64,
    /// Seconds in all.
    seconds: f64,
}

impl Outcome {
    pub(super) fn new(world: &Path, out: &Path, report: WorldReport, time: Duration) -> Self {
        let WorldReport { n_tiles, n_baked, n_far_only, n_kept, n_removed, n_cells, n_objects, n_bytes } = report;
        let [world, out] = [world, out].map(|path| path.display().to_string());
        let seconds = time.as_secs_f64();
        Self { world, out, n_tiles, n_baked, n_far_only, n_kept, n_removed, n_cells, n_objects, n_bytes, seconds }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [tiles, cells, objects] = [(self.n_tiles, "tile"), (self.n_cells, "cell"), (self.n_objects, "object")]
            .map(|(n, noun)| count(n as u64, noun));
        writeln!(f, "wrote {}: {tiles} with {cells} and {objects}, {}", self.out, bytes(self.n_bytes))?;
        let Self { n_baked, n_far_only, n_kept, n_removed, .. } = self;
        writeln!(f, "baked          {n_baked}; {n_far_only} only for what is far away; {n_kept} kept as they were")?;
        if *n_removed > 0 {
            writeln!(f, "removed        {} of an earlier bake", count(*n_removed as u64, "table"))?;
        }
        writeln!(f, "time           {}", seconds_of(self.seconds))
    }
}
