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
    #[serde(flatten)]
    did: WorldReport,
    /// Seconds in all.
    seconds: f64,
}

impl Outcome {
    pub(super) fn new(world: &Path, out: &Path, did: WorldReport, time: Duration) -> Self {
        let [world, out] = [world, out].map(|path| path.display().to_string());
        Self { world, out, did, seconds: time.as_secs_f64() }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let WorldReport { n_tiles, n_baked, n_far_only, n_kept, n_removed, n_cells, n_objects, n_bytes } = self.did;
        let [tiles, cells, objects] =
            [(n_tiles, "tile"), (n_cells, "cell"), (n_objects, "object")].map(|(n, noun)| count(n as u64, noun));
        writeln!(f, "wrote {}: {tiles} with {cells} and {objects}, {}", self.out, bytes(n_bytes))?;
        writeln!(f, "baked          {n_baked}; {n_far_only} only for what is far away; {n_kept} kept as they were")?;
        if n_removed > 0 {
            writeln!(f, "removed        {} of an earlier bake", count(n_removed as u64, "table"))?;
        }
        writeln!(f, "time           {}", seconds_of(self.seconds))
    }
}
