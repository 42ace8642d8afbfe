//! What was simplified, in numbers.

use super::SimplifyArgs;
use crate::error::Result;
use crate::output::{JsonSchema, Serialize, bytes, count, percent, seconds_of, share};
use crate::simplification::{Rounded, SingleSided, Written};
use sightlines::cells::Scene;
use sightlines::geometry::Point3;
use sightlines::simplify::estimate::interval;
use sightlines::simplify::{HitEstimate, Measured, Simplified, SimplifyError, SimplifyOptions, Views};
use sightlines::visible_surface::Faces;
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
    /// Triangles before.
    n_before: usize,
    /// Triangles without area, which were removed.
    n_without_area: usize,
    /// Triangles removed because no eye sees them.
    n_hidden: usize,
    /// Triangles removed for the budget.
    n_deleted: usize,
    /// Triangles removed or replaced by collapsing edges.
    n_collapsed: usize,
    /// Triangles that replace collapsed ones.
    n_new: usize,
    /// Triangles saved by merging coplanar ones.
    n_merged_away: usize,
    /// Triangles that are the result of merging.
    n_merged: usize,
    /// Triangles after.
    n_left: usize,
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
    report: Option<Report>,
    /// Seconds in all.
    seconds: f64,
}

/// What rays say.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Report {
    /// Rays.
    n_rays: u64,
    /// Share of the rays that meet another face first, of all eyes.
    changed: f64,
    /// The same for the worst eye.
    worst: f64,
    /// This eye.
    worst_eye: Point3,
    /// Share of the rays that meet another object.
    other_object: f64,
    /// Share of the rays that meet a place whose depth differs by more than a hundredth.
    moved: f64,
    /// Share of other rays that met, before, what was removed or merged.
    estimate: f64,
    /// An interval that contains the true share with a probability of 99 %.
    estimate_interval: [f64; 2],
    /// Rays of this estimate.
    n_estimate_rays: u64,
}

impl Report {
    pub(super) fn new(
        scene: &Scene,
        views: &Views,
        simplified: &Simplified,
        measured: &Measured,
        options: &SimplifyOptions,
    ) -> Result<Self, SimplifyError> {
        let faces = Faces::of_scene(scene)?;
        let estimate = HitEstimate::new(&faces, views, options.n_rays);
        let (mut first, mut hits) = (0, 0);
        for (o, origin) in scene.objects().iter().zip(&simplified.origin) {
            let mut kept = vec![false; o.triangles.len()];
            origin.iter().flatten().for_each(|&k| kept[k as usize] = true);
            let gone = (first..).zip(&kept).filter(|(_, kept)| !**kept);
            hits += gone.map(|(face, _)| estimate.hits(face)).sum::<u64>();
            first += o.triangles.len() as u32;
        }
        let found = interval(hits, estimate.n_rays(), 0.99);
        Ok(Self {
            n_rays: measured.n_rays,
            changed: measured.changed,
            worst: measured.worst,
            worst_eye: measured.worst_eye,
            other_object: measured.other_object,
            moved: measured.moved,
            estimate: found.share,
            estimate_interval: found.ends,
            n_estimate_rays: estimate.n_rays(),
        })
    }
}

impl Outcome {
    pub(super) fn new(
        args: &SimplifyArgs,
        method: &'static str,
        (scene, simplified): (&Scene, &Simplified),
        n_volumes: usize,
        file: &Written,
        report: Option<Report>,
        time: Duration,
    ) -> Self {
        let counts = &simplified.counts;
        Self {
            scene: args.scene.display().to_string(),
            out: args.output.display().to_string(),
            n_bytes: file.bytes.len(),
            n_volumes,
            method,
            table: args.eyes.table.as_ref().map(|table| table.display().to_string()),
            budget: args.how.budget(),
            n_before: counts.before,
            n_without_area: counts.without_area,
            n_hidden: counts.hidden,
            n_deleted: counts.deleted,
            n_collapsed: counts.collapsed,
            n_new: counts.new,
            n_merged_away: counts.merged_away,
            n_merged: counts.merged,
            n_left: counts.left,
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
        let share = |n: usize| percent(share(n as f64, self.n_before as f64));
        writeln!(f, "before         {}", count(self.n_before as u64, "triangle"))?;
        if self.n_without_area > 0 {
            writeln!(f, "without area   {}", self.n_without_area)?;
        }
        writeln!(f, "hidden         {}, {}, which is proven", self.n_hidden, share(self.n_hidden))?;
        writeln!(f, "left out       {}, {}, within the budget", self.n_deleted, share(self.n_deleted))?;
        let moved = if self.n_new > 0 { format!(", by at most {} units", self.deviation) } else { String::new() };
        writeln!(f, "collapsed      {} to {}{moved}", self.n_collapsed, self.n_new)?;
        if self.n_merged > 0 {
            writeln!(f, "merged         {} more into {}", self.n_merged_away, self.n_merged)?;
        }
        writeln!(f, "left           {}, {}", self.n_left, share(self.n_left))?;
        let ([bound, budget], eye) = ([self.bound, self.budget].map(parts), self.single_sided);
        writeln!(f, "promised       {bound} of the view changes at most, for every eye{eye}; {budget} were allowed")?;
        if let Some(report) = &self.report {
            let [x, y, z] = report.worst_eye;
            writeln!(f, "measured       {} of {} rays meet another face", parts(report.changed), report.n_rays)?;
            writeln!(f, "               {} at the worst eye, {x},{y},{z}", parts(report.worst))?;
            let [object, moved] = [report.other_object, report.moved].map(parts);
            writeln!(f, "               {object} another object, {moved} another object or depth")?;
            let [low, high] = report.estimate_interval.map(parts);
            writeln!(
                f,
                "estimate       {} was seen of what is gone{}, from {low} to {high} (99 %), by {} rays",
                parts(report.estimate),
                if self.n_merged > 0 { " or merged" } else { "" },
                report.n_estimate_rays
            )?;
        }
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

/// A share that may be very small.
pub(crate) fn parts(share: f64) -> String {
    if share == 0.0 || share >= 0.01 { percent(share) } else { format!("{:.3e}", share) }
}

fn boxes(n: usize) -> String {
    if n == 1 { "a box".to_owned() } else { format!("{n} boxes") }
}
