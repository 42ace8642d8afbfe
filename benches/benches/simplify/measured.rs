//! What is measured of a scene, a place, a budget and a metric.

use crate::cases::Case;
use sightlines::simplify::{
    MeasureOptions, PreparedScene, Simplified, SimplifyOptions, estimate, geometric, measure, measure_aimed,
};
use sightlines_benches::csv_row;
use std::error::Error;
use std::time::Instant;

csv_row! {
    /// One metric at one budget.
    #[derive(Debug, Clone, PartialEq)]
    pub(crate) struct Row {
        pub(crate) scene: String,
        pub(crate) view: usize,
        pub(crate) budget: f64,
        /// Share of the budget that is kept for collapsing.
        pub(crate) collapse: f64,
        /// Whether faces in one plane are merged.
        pub(crate) flat: bool,
        /// `intercepts` is ours, `shape` the quadrics of the geometry alone at the same count, `meshopt` another one's.
        pub(crate) metric: String,
        pub(crate) before: usize,
        pub(crate) hidden: usize,
        pub(crate) left: usize,
        pub(crate) new: usize,
        /// Promised; infinite if nothing is.
        pub(crate) bound: f64,
        /// Measured, of all rays and for the worst eye.
        pub(crate) changed: f64,
        pub(crate) worst: f64,
        /// By rays that are aimed at what has changed, of the worst eye, and its standard error; for ours only.
        pub(crate) aimed: f64,
        pub(crate) aimed_error: f64,
        pub(crate) other_object: f64,
        pub(crate) moved: f64,
        pub(crate) rays_per_eye: u64,
        pub(crate) n_eyes: usize,
        /// Without finding what is hidden, which is done once for all budgets.
        pub(crate) seconds: f64,
    }
}

impl Row {
    /// Whether more was changed than was promised, and not by chance: the chance is below one in a million.
    pub(crate) fn breaks_its_promise(&self) -> bool {
        if self.metric != "intercepts" {
            return false;
        }
        let hits = (self.worst * self.rays_per_eye as f64).round() as u64;
        let confidence = 1.0 - 1e-6 / self.n_eyes.max(1) as f64;
        let surely = estimate::interval(hits, self.rays_per_eye, confidence).ends[0];
        self.bound > self.budget
            || surely > self.bound
            || self.aimed - 6.0 * self.aimed_error > self.bound
            || (self.budget == 0.0 && self.changed > 0.0)
    }
}

/// Ours, and the others at the same count.
pub(crate) fn all(
    case: &Case,
    prepared: &PreparedScene<'_>,
    budget: f64,
    (collapse, flat): (f64, bool),
    n_eyes: usize,
    n_rays: u64,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let options = SimplifyOptions { budget, collapse, flat, ..SimplifyOptions::default() };
    let start = Instant::now();
    let ours = prepared.simplify(&options)?;
    let seconds = start.elapsed().as_secs_f64();
    let rays = if budget > 0.0 { ((5.0 / budget) as u64).clamp(n_rays, 50_000.max(n_rays)) } else { n_rays };
    let row = |metric: &str, of: &Simplified, seconds: f64, rays: u64| -> Result<Row, Box<dyn Error>> {
        let options = MeasureOptions { n_eyes, n_rays: rays, ..MeasureOptions::default() };
        let m = measure(&case.scene, of, &case.views, &options)?;
        let [aimed, aimed_error] = if metric == "intercepts" {
            let aimed = measure_aimed(&case.scene, of, &case.views, &options)?;
            [aimed.worst, aimed.worst_error]
        } else {
            [m.worst, f64::NAN]
        };
        let row = Row {
            scene: case.name.clone(),
            view: case.view,
            budget,
            collapse,
            flat,
            metric: metric.to_owned(),
            before: of.counts.before,
            hidden: of.counts.hidden,
            left: of.counts.left,
            new: of.counts.new,
            bound: of.bound,
            changed: m.changed,
            worst: m.worst,
            aimed,
            aimed_error,
            other_object: m.other_object,
            moved: m.moved,
            rays_per_eye: rays,
            n_eyes,
            seconds,
        };
        eprintln!("{row:?}");
        Ok(row)
    };
    let mut rows = vec![row("intercepts", &ours, seconds, rays)?];
    let start = Instant::now();
    let shape = geometric(&case.scene, ours.counts.left)?;
    rows.push(row("shape", &shape, start.elapsed().as_secs_f64(), n_rays)?);
    #[cfg(feature = "meshopt")]
    {
        let start = Instant::now();
        let theirs = crate::meshopt::simplified(&case.scene, ours.counts.left);
        rows.push(row("meshopt", &theirs, start.elapsed().as_secs_f64(), n_rays)?);
    }
    Ok(rows)
}

pub(crate) fn print(rows: &[Row]) {
    println!(
        "| scene | view | budget | collapse | flat | metric | triangles | left | new | promised | changed | worst eye | aimed, worst eye | other object | moved | rays | s |"
    );
    println!("| --- | --: | --: | --: | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for r in rows {
        let bound = if r.bound.is_finite() { format!("{:.2e}", r.bound) } else { "-".to_owned() };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {:.2} % | {} | {bound} | {:.2e} | {:.2e} | {:.2e} | {:.2e} | {:.2e} | {} | {:.1} |",
            r.scene,
            r.view,
            r.budget,
            r.collapse,
            r.flat,
            r.metric,
            r.before,
            100.0 * r.left as f64 / r.before as f64,
            r.new,
            r.changed,
            r.worst,
            r.aimed,
            r.other_object,
            r.moved,
            r.rays_per_eye * r.n_eyes as u64,
            r.seconds
        );
    }
}
