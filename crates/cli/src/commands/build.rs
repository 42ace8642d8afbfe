//! `build`: from a plan to its table.

use crate::Answer;
use crate::error::CliError;
use crate::input::{self, Scene};
use crate::output::{self, bytes, count, percent, seconds};
use crate::progress::Bar;
use serde::Serialize;
use sightlines::bake::{BakeOptions, BakeSummary, Baked, Subdivide, bake_plan};
use sightlines::report::Summary;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `build`.
#[derive(Debug, clap::Args)]
pub(crate) struct BuildArgs {
    /// A WAD, or a floor plan as GeoJSON
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The table to write
    #[arg(short, long, value_name = "OUT.pvs")]
    output: PathBuf,
    /// Which map of the WAD; not needed if there is only one
    #[arg(long, value_name = "NAME")]
    map: Option<String>,
    #[command(flatten)]
    bake: BakeArgs,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// How to bake.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct BakeArgs {
    /// How to cut the plan into cells: kd (walls along the axes only), triangulation, or auto
    #[arg(long, value_name = "HOW", default_value_t = Subdivide::Auto)]
    subdivide: Subdivide,
    /// For kd: split along walls only where they cover at least this share of a cell, 0 to 1; with 0 no
    /// wall is left out
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = share, allow_hyphen_values = true)]
    tau: f64,
    /// Number of threads; 0 for one for each core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = crate::args::threads)]
    threads: usize,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("not a number from 0 to 1".to_owned()),
    }
}

/// Builds the table of a plan that came from `path`.
pub(crate) fn bake(path: &Path, scene: &Scene, args: &BakeArgs, show_progress: bool) -> Result<Baked, CliError> {
    let bar = Bar::new("who sees whom", show_progress);
    let progress = |done, all| bar.set(done, all);
    let options = BakeOptions {
        subdivide: args.subdivide,
        tau: args.tau,
        threads: args.threads,
        progress: Some(&progress),
        ..BakeOptions::default()
    };
    let baked = bake_plan(&scene.plan, &options);
    drop(bar);
    let baked = baked.map_err(|source| CliError::Bake { path: path.to_owned(), map: scene.map.clone(), source })?;
    warn(path, &baked.summary);
    Ok(baked)
}

impl BakeArgs {
    /// What the options are by default.
    pub(crate) fn standard() -> Self {
        Self { subdivide: Subdivide::Auto, tau: 0.0, threads: 0 }
    }
}

/// Says on standard error what is only approximately so.
fn warn(path: &Path, summary: &BakeSummary) {
    let say = |n: usize, noun: &str, what: &str| {
        if n > 0 {
            tracing::warn!("{}: {} {what}", path.display(), count(n as u64, noun));
        }
    };
    say(summary.n_ignored_walls, "wall", "do not block sight: the k-d tree does not follow them");
    say(summary.n_dropped_pieces, "piece", "of walls do not block sight: rounding could have closed a gap beside them");
    if summary.n_rounded_crossings > 0 {
        let n = count(summary.n_rounded_crossings as u64, "crossing");
        tracing::info!("{}: {n} of lines had to be rounded, towards visible", path.display());
    }
    if summary.n_disputed_cells > 0 {
        let n = count(summary.n_disputed_cells as u64, "cell");
        tracing::info!("{}: {n} where lines disagree about the group", path.display());
    }
}

pub(crate) fn run(args: &BuildArgs, show_progress: bool) -> Result<Answer, CliError> {
    output::refuse_same(&args.input, &args.output)?;
    let scene = input::scene(&args.input, args.map.as_deref())?;
    let baked = bake(&args.input, &scene, &args.bake, show_progress)?;
    output::save(&args.output, &baked.table.to_bytes())?;
    let outcome = Outcome::new(&args.output, scene.map, &baked);
    output::print(args.json, &outcome)?;
    Ok(Answer::Yes)
}

/// What was built.
#[derive(Debug, Serialize)]
pub(crate) struct Outcome {
    out: String,
    map: Option<String>,
    subdivide: String,
    #[serde(flatten)]
    pub(crate) table: Summary,
    n_ignored_walls: usize,
    n_rounded_crossings: usize,
    n_dropped_pieces: usize,
    n_disputed_cells: usize,
    cut_seconds: f64,
    see_seconds: f64,
}

impl Outcome {
    pub(crate) fn new(out: &Path, map: Option<String>, baked: &Baked) -> Self {
        let did = &baked.summary;
        Self {
            out: out.display().to_string(),
            map,
            subdivide: did.subdivide.to_string(),
            table: Summary::of(&baked.table),
            n_ignored_walls: did.n_ignored_walls,
            n_rounded_crossings: did.n_rounded_crossings,
            n_dropped_pieces: did.n_dropped_pieces,
            n_disputed_cells: did.n_disputed_cells,
            cut_seconds: did.cut_time.as_secs_f64(),
            see_seconds: did.see_time.as_secs_f64(),
        }
    }

    /// Cells, portals, visible pairs, and what has to be drawn.
    pub(crate) fn facts(&self) -> impl fmt::Display + '_ {
        Facts(&self.table)
    }

    /// The name of the subdivision that was used.
    pub(crate) fn method(&self) -> &str {
        if self.subdivide == "kd" { "a k-d tree" } else { "a constrained triangulation" }
    }

    /// Time to cut and to see.
    pub(crate) fn times(&self) -> String {
        let [cut, see] = [self.cut_seconds, self.see_seconds].map(|s| seconds(Duration::from_secs_f64(s)));
        format!("{cut} to cut the plan, {see} to find out who sees whom")
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let map = self.map.as_ref().map_or(String::new(), |name| format!(" of map {name}"));
        writeln!(f, "wrote {}{map}, {}", self.out, bytes(self.table.n_bytes as u64))?;
        write!(f, "{}", self.facts())?;
        writeln!(f, "time           {}", self.times())
    }
}

/// The lines about a table that several commands print.
pub(crate) struct Facts<'a>(pub(crate) &'a Summary);

impl fmt::Display for Facts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = self.0;
        let groups = if s.n_groups > 0 { format!(", in {}", count(s.n_groups as u64, "group")) } else { String::new() };
        writeln!(f, "cells          {}{groups}", s.n_cells)?;
        writeln!(f, "portals        {}", s.n_portals)?;
        if s.n_objects > 0 {
            writeln!(f, "objects        {}", s.n_objects)?;
        }
        let all = s.n_cells as u64 * (s.n_cells as u64).saturating_sub(1) / 2;
        writeln!(f, "visible pairs  {} of {all}", s.n_visible_pairs)?;
        let [cells, floor] = [s.mean_cell_share, s.mean_floor_share].map(percent);
        let what = if s.dimension == 2 { "floor" } else { "volume" };
        writeln!(f, "to draw        {floor} of the {what} on average ({cells} of the cells)")
    }
}
