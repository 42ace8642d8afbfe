//! What was simplified, in numbers.

use super::SimplifyArgs;
use crate::output::{JsonSchema, Serialize, bytes, count, percent, seconds_of, share};
use crate::simplification::{Rounded, SingleSided, Written};
use sightlines::cells::Scene;
use sightlines::progress::words::parts;
use sightlines::simplify::report::RayReport;
use sightlines::simplify::{Counts, Simplified};
use std::fmt;
use std::time::Duration;

/// The scene that is left.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The scene.
    scene: String,
    /// The scene that was written.
    out: String,
    /// Size of the scene that was written.
    n_bytes: usize,
    /// View volumes: boxes where eyes may be.
    n_volumes: usize,
    /// The method that proved triangles hidden, or `none`.
    method: &'static str,
    /// The table that was used; null without.
    table: Option<String>,
    /// Share of the sphere of directions that was allowed to change.
    budget: f64,
    #[serde(flatten)]
    counts: Counts,
    /// Proven: the share of the sphere of directions that changes at most, for every eye; with `single_sided`, for every eye that sees the back of
    /// no such face.
    bound: f64,
    /// Whether the scene has faces of which engines draw the fronts only.
    single_sided: SingleSided,
    /// The greatest distance that a surface was moved, before rounding.
    deviation: f64,
    /// If coordinates were rounded to single precision, which moves surfaces beside what `bound` allows.
    #[serde(skip_serializing_if = "Option::is_none")]
    rounded: Option<Rounded>,
    /// Whether the result may be used as an occluder.
    occluder: bool,
    /// With `--report`: what fresh rays measured; null without.
    report: Option<RayReport>,
    /// Seconds in all.
    seconds: f64,
}

impl Outcome {
    pub(super) fn new(
        args: &SimplifyArgs,
        method: &'static str,
        (scene, simplified): (&Scene, &Simplified),
        n_volumes: usize,
        file: &Written,
        report: Option<RayReport>,
        time: Duration,
    ) -> Self {
        Self {
            scene: args.scene.display().to_string(),
            out: args.output.display().to_string(),
            n_bytes: file.bytes.len(),
            n_volumes,
            method,
            table: args.eyes.table.as_ref().map(|table| table.display().to_string()),
            budget: args.how.budget(),
            counts: simplified.counts,
            bound: simplified.bound,
            single_sided: SingleSided::of(scene),
            deviation: simplified.deviation,
            rounded: Rounded::of([file.rounding]),
            occluder: file.occluder,
            report,
            seconds: time.as_secs_f64(),
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.n_bytes as u64))?;
        let table = self.table.as_ref().map_or(String::new(), |table| format!(", and the table {table}"));
        let method = if self.method == "none" { "no method" } else { self.method };
        writeln!(f, "eyes           in {}; hidden by {method}{table}", boxes(self.n_volumes))?;
        let counts = &self.counts;
        let share = |n: usize| percent(share(n as f64, counts.before as f64));
        writeln!(f, "before         {}", count(counts.before as u64, "triangle"))?;
        if counts.without_area > 0 {
            writeln!(f, "without area   {}", counts.without_area)?;
        }
        writeln!(f, "hidden         {}, {}, which is proven", counts.hidden, share(counts.hidden))?;
        writeln!(f, "left out       {}, {}, within the budget", counts.deleted, share(counts.deleted))?;
        let moved = if counts.new > 0 { format!(", by at most {} units", self.deviation) } else { String::new() };
        writeln!(f, "collapsed      {} to {}{moved}", counts.collapsed, counts.new)?;
        if counts.merged > 0 {
            writeln!(f, "merged         {} more into {}", counts.merged_away, counts.merged)?;
        }
        writeln!(f, "left           {}, {}", counts.left, share(counts.left))?;
        let ([bound, budget], eye) = ([self.bound, self.budget].map(parts), self.single_sided);
        writeln!(f, "promised       {bound} of the view changes at most, for every eye{eye}; {budget} were allowed")?;
        self.report.iter().try_for_each(|report| write!(f, "{report}"))?;
        let may = if self.occluder {
            "lies inside of the original, and may hide"
        } else {
            "has moved triangles, and must not be used to hide"
        };
        writeln!(f, "the result     {may}")?;
        if let Some(rounded) = self.rounded {
            writeln!(f, "rounded        {rounded}")?;
        }
        writeln!(f, "time           {}", seconds_of(self.seconds))
    }
}

fn boxes(n: usize) -> String {
    if n == 1 { "a box".to_owned() } else { format!("{n} boxes") }
}
