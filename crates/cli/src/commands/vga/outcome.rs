//! What was measured.

use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::visibility_graph::{Measure, UNDEFINED};
use std::fmt;

/// The measures of the points of a plan.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The plan.
    pub(super) plan: String,
    /// Its lines that block sight.
    pub(super) n_walls: usize,
    /// Distance of neighbouring points of the grid; null for points of a file.
    pub(super) spacing: Option<f64>,
    /// Columns and rows of the grid, filled or not; null for points of a file.
    pub(super) grid: Option<[usize; 2]>,
    /// Points.
    pub(super) n_points: usize,
    /// Unordered pairs of different points that see each other.
    pub(super) n_visible_pairs: u64,
    /// Runs of consecutive points in the rows of the graph.
    pub(super) n_runs: usize,
    /// Memory that the graph takes.
    pub(super) n_graph_bytes: usize,
    /// The measures that were computed.
    pub(super) measures: Vec<Range>,
    /// Seconds to build the graph.
    pub(super) graph_seconds: f64,
    /// Seconds to compute the measures.
    pub(super) measure_seconds: f64,
    /// The measure that a picture shows; null for tables.
    pub(super) drawn: Option<&'static str>,
    /// The file that was written.
    pub(super) file: String,
    /// The largest memory in use; null if the system does not report it.
    pub(super) peak_bytes: Option<u64>,
}

/// Values of a measure.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Range {
    /// Its name on command lines and in tables.
    name: &'static str,
    /// Its name for people.
    title: &'static str,
    /// Its unit, `u` being a scene unit; empty if it has none.
    unit: &'static str,
    /// Points that have a value.
    n_values: usize,
    /// Smallest value; null without values.
    minimum: Option<f64>,
    /// Mean of all values.
    mean: Option<f64>,
    /// Largest value.
    maximum: Option<f64>,
}

impl Range {
    pub(super) fn of(measure: Measure, values: &[f64]) -> Self {
        let known: Vec<f64> = values.iter().copied().filter(|&x| x != UNDEFINED).collect();
        let some = |x: f64| (!known.is_empty()).then_some(x);
        Self {
            name: measure.name(),
            title: measure.title(),
            unit: measure.unit(),
            n_values: known.len(),
            minimum: some(known.iter().copied().fold(f64::INFINITY, f64::min)),
            mean: some(known.iter().sum::<f64>() / known.len() as f64),
            maximum: some(known.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points = count(self.n_points as u64, "point");
        write!(f, "{}: {}, {points}", self.plan, count(self.n_walls as u64, "wall"))?;
        match (self.grid, self.spacing) {
            (Some([columns, rows]), Some(spacing)) => writeln!(f, " of a grid of {columns} x {rows}, {spacing} apart")?,
            _ => writeln!(f)?,
        }
        let pairs = count(self.n_visible_pairs, "pair");
        writeln!(f, "graph          {pairs} that see each other, {}", bytes(self.n_graph_bytes as u64))?;
        let [graph, measures] = [self.graph_seconds, self.measure_seconds].map(seconds_of);
        writeln!(f, "time           {graph} for the graph, {measures} for measures")?;
        for Range { title, unit, n_values, minimum, mean, maximum, .. } in &self.measures {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            match (minimum, mean, maximum) {
                (Some(low), Some(mean), Some(high)) => {
                    write!(f, "{title}: {low:.4} to {high:.4}, mean {mean:.4}{unit}")?;
                }
                _ => write!(f, "{title}: no values")?,
            }
            match self.n_points - n_values {
                0 => writeln!(f)?,
                n => writeln!(f, " (none at {})", count(n as u64, "point"))?,
            }
        }
        writeln!(f, "wrote          {}", self.file)
    }
}
