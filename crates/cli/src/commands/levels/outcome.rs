//! What levels were made, in numbers.

use super::LevelsArgs;
use crate::output::{JsonSchema, Serialize, bytes, count, percent, seconds_of};
use crate::simplification::{Rounded, SingleSided};
use sightlines::cells::Scene;
use sightlines::formats::LevelsIndex;
use sightlines::formats::scene::Rounding;
use sightlines::progress::memory;
use std::fmt;
use std::time::Duration;

/// The levels that were written.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    scene: String,
    /// The table.
    table: String,
    /// The folder that was written.
    out: String,
    /// The method that proved triangles hidden, or `none`.
    method: &'static str,
    /// Share of the sphere of directions that was allowed to change.
    budget: f64,
    /// Bytes allowed for the triangles of all levels.
    memory: u64,
    /// Cells of the table.
    n_cells: usize,
    /// Levels.
    n_levels: usize,
    /// Triangles of the scene.
    n_triangles: u64,
    /// Bytes of the triangles of all levels, measured as `memory` is.
    n_bytes: u64,
    /// Bytes of the files of all levels.
    n_file_bytes: u64,
    /// Triangles of a cell's level, averaged over cells.
    mean_triangles: f64,
    /// Triangles of the largest level.
    most_triangles: u64,
    /// Proven: the largest share of the sphere of directions that changes, of all levels; with `single_sided`, for every eye that sees the back of
    /// no such face.
    bound: f64,
    /// Whether the scene has faces of which engines draw the fronts only.
    single_sided: SingleSided,
    /// As in [`simplify`](#simplify), of all levels.
    #[serde(skip_serializing_if = "Option::is_none")]
    rounded: Option<Rounded>,
    /// Seconds in all.
    seconds: f64,
    /// The largest memory in use; null if the system does not report it.
    peak_bytes: Option<u64>,
}

impl Outcome {
    pub(super) fn new(
        args: &LevelsArgs,
        (scene, method): (&Scene, &'static str),
        index: &LevelsIndex,
        (n_file_bytes, roundings): (u64, Vec<Rounding>),
        time: Duration,
    ) -> Self {
        let of_cells = || index.cells.iter().flatten().map(|&level| index.levels[level as usize].n_triangles);
        Self {
            scene: args.scene.display().to_string(),
            table: args.table.display().to_string(),
            out: args.output.display().to_string(),
            method,
            budget: index.budget,
            memory: args.memory,
            n_cells: index.cells.len(),
            n_levels: index.levels.len(),
            n_triangles: index.n_triangles,
            n_bytes: index.levels.iter().map(|level| level.n_bytes).sum(),
            n_file_bytes,
            mean_triangles: of_cells().sum::<u64>() as f64 / index.cells.len().max(1) as f64,
            most_triangles: of_cells().max().unwrap_or(0),
            single_sided: SingleSided::of(scene),
            rounded: Rounded::of(roundings),
            bound: index.levels.iter().map(|level| level.bound).fold(0.0, f64::max),
            seconds: time.as_secs_f64(),
            peak_bytes: memory::peak_bytes(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [levels, cells] = [(self.n_levels, "level"), (self.n_cells, "cell")].map(|(n, noun)| count(n as u64, noun));
        writeln!(f, "wrote {}: {levels} for {cells}, {}", self.out, bytes(self.n_file_bytes))?;
        let method = if self.method == "none" { String::new() } else { format!(", and {}", self.method) };
        writeln!(f, "hidden by      the table {}{method}", self.table)?;
        writeln!(f, "memory         {} of {}", bytes(self.n_bytes), bytes(self.memory))?;
        let share = |n: f64| percent(if self.n_triangles > 0 { n / self.n_triangles as f64 } else { 0.0 });
        let [mean, most] = [self.mean_triangles, self.most_triangles as f64];
        writeln!(f, "before         {}", count(self.n_triangles, "triangle"))?;
        let [of_mean, of_most] = [mean, most].map(share);
        writeln!(f, "left           {mean:.1} for a cell on average, {of_mean}; at most {most}, {of_most}")?;
        writeln!(
            f,
            "promised       {:.3e} of the view changes at most, for every eye{}; {:.3e} were allowed",
            self.bound, self.single_sided, self.budget
        )?;
        if let Some(rounded) = self.rounded {
            writeln!(f, "rounded        {rounded}")?;
        }
        writeln!(f, "time           {}", seconds_of(self.seconds))
    }
}
