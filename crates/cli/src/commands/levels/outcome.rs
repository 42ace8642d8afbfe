//! What levels were made, in numbers.

use super::LevelsArgs;
use crate::output::{bytes, count, percent, seconds};
use crate::simplification::{Rounded, SingleSided};
use serde::Serialize;
use sightlines::cells::Scene;
use sightlines::formats::LevelsIndex;
use sightlines::formats::scene::Rounding;
use sightlines::progress::memory;
use std::fmt;
use std::time::Duration;

/// The result.
#[derive(Debug, Serialize)]
pub(super) struct Outcome {
    scene: String,
    table: String,
    out: String,
    method: &'static str,
    budget: f64,
    memory: u64,
    n_cells: usize,
    n_levels: usize,
    n_triangles: u64,
    /// What levels take by the measure of the memory, and as files.
    n_bytes: u64,
    n_file_bytes: u64,
    /// Triangles of the levels, each cell of the same weight, and of the largest one.
    mean_triangles: f64,
    most_triangles: u64,
    /// The largest share that changes, of all levels.
    bound: f64,
    single_sided: SingleSided,
    /// What the files do not hold exactly, of all levels.
    #[serde(skip_serializing_if = "Option::is_none")]
    rounded: Option<Rounded>,
    seconds: f64,
    /// The most memory that was in use at once; null where the system does not report it.
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
        writeln!(
            f,
            "left           {mean:.1} for a cell on average, {}; at most {most}, {}",
            share(mean),
            share(most)
        )?;
        writeln!(
            f,
            "promised       {:.3e} of the view changes at most, for every eye{}; {:.3e} were allowed",
            self.bound, self.single_sided, self.budget
        )?;
        if let Some(rounded) = self.rounded {
            writeln!(f, "rounded        {rounded}")?;
        }
        writeln!(f, "time           {}", seconds(Duration::from_secs_f64(self.seconds)))
    }
}
