//! What became of the tiles of a world.

use crate::output::{bytes, count, seconds};
use schemars::JsonSchema;
use serde::Serialize;
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
    pub(super) n_removed: usize,
    /// Cells of all tiles.
    n_cells: usize,
    /// Objects of all tiles.
    n_objects: usize,
    /// Bytes of all files of tiles.
    pub(super) n_bytes: u64,
    /// Seconds in all.
    pub(super) seconds: f64,
}

impl Outcome {
    pub(super) fn new(world: &Path, out: &Path) -> Self {
        Self {
            world: world.display().to_string(),
            out: out.display().to_string(),
            n_tiles: 0,
            n_baked: 0,
            n_far_only: 0,
            n_kept: 0,
            n_removed: 0,
            n_cells: 0,
            n_objects: 0,
            n_bytes: 0,
            seconds: 0.0,
        }
    }

    /// Counts a tile.
    ///
    /// * `made`: whether all of it was made; `None` if nothing was
    pub(super) fn count(&mut self, made: Option<bool>, (n_cells, n_objects): (usize, usize)) {
        self.n_tiles += 1;
        self.n_cells += n_cells;
        self.n_objects += n_objects;
        match made {
            Some(true) => self.n_baked += 1,
            Some(false) => self.n_far_only += 1,
            None => self.n_kept += 1,
        }
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
        writeln!(f, "time           {}", seconds(Duration::from_secs_f64(self.seconds)))
    }
}
