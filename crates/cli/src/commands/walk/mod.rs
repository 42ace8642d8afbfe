//! `walk`: what each method leaves to draw along a walk, and what it costs.

mod levels;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::{ErrorAbout, Result, anyhow, bail};
use crate::output;
use crate::progress::Bar;
use crate::tables::{self, Cells, Opened};
use crate::view::{LensArgs, Methods, method_help};
use crate::walk_path;
use sightlines::eye_to_cell::{CellSource, Method, StepBudget, View};
use sightlines::report::{WalkReport, walk_svg};
use sightlines::walkthrough::{CameraPose, MeasureError, WalkMeasure, WalkOptions, usual_step, wander};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct WalkArgs {
    /// The table, plain or packed; blocks of a packed one are read on demand
    #[arg(value_name = "FILE")]
    table: PathBuf,
    /// The walk as JSON: {"frames": [{"eye": [x, y, z], "dir": [x, y, z]}, ...]}; two coordinates each in the plane
    #[arg(
        long,
        help_heading = "Walk",
        value_name = "FILE.json",
        required_unless_present = "random",
        conflicts_with = "random"
    )]
    path: Option<PathBuf>,
    /// Generate a random walk of this many frames, from cell to cell, with occasional jumps: through portals, or, if the cells have none, where
    /// their boxes touch
    #[arg(long, help_heading = "Walk", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    random: Option<u32>,
    /// Seed of the random walk
    #[arg(long, help_heading = "Walk", value_name = "S", default_value_t = 1, conflicts_with = "path")]
    seed: u64,
    /// Distance from frame to frame of a random walk, in scene units [default: 1/400 of the scene's diagonal]
    #[arg(long, help_heading = "Walk", value_name = "UNITS", value_parser = crate::numbers::above_zero, allow_hyphen_values = true, conflicts_with = "path")]
    step: Option<f64>,
    #[command(flatten)]
    lens: LensArgs,
    #[arg(long, help_heading = "Method", value_name = "NAME", default_value = "all")]
    #[arg(help = method_help("; cell-to-cell always runs for comparison"))]
    method: Methods,
    /// Memory budget for prepared data, in bytes; the blocks of a packed table get the same again
    #[arg(long, help_heading = "Method", value_name = "BYTES", default_value_t = WalkOptions::default().budget)]
    budget: usize,
    /// Work that the queries of a frame may do, in steps of about a test of a box. A frame that would need more counts as coarser: exact is
    /// then exact near the eye only, and farther away shows what incident-portals finds, which is never less. frame is 4096, none is
    /// no bound
    #[arg(long, help_heading = "Method", value_name = "STEPS", default_value = "frame", value_parser = steps)]
    steps: StepBudget,
    /// Also follow reflections in mirrors, up to this many in a row
    #[arg(long, help_heading = "Method", value_name = "N", default_value_t = 0, value_parser = crate::view::bounces)]
    bounces: usize,
    /// Frames per second of the pass that does not wait for prepared data [default: as many as possible]
    #[arg(long, help_heading = "Method", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    fps: Option<u32>,
    /// Also count the triangles drawn with the levels in this folder, which `sightlines levels` wrote for the table
    #[arg(long, help_heading = "Method", value_name = "FOLDER")]
    levels: Option<PathBuf>,
    /// A chart to write
    #[arg(short, long, help_heading = "Output", value_name = "CHART.svg")]
    output: Option<PathBuf>,
    /// The numbers to write as CSV, one line for each method
    #[arg(long, help_heading = "Output", value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArg,
}

fn steps(text: &str) -> Result<StepBudget, String> {
    match text {
        "none" => Ok(StepBudget::UNLIMITED),
        "frame" => Ok(StepBudget::FRAME),
        _ => text.parse().map(StepBudget::steps).map_err(|_| "neither a number of steps, frame, nor none".to_owned()),
    }
}

pub(crate) fn run(args: &WalkArgs, Verbosity { show_progress, .. }: Verbosity) -> Result<Done> {
    let outputs: Vec<&Path> = [&args.output, &args.csv].into_iter().flatten().map(PathBuf::as_path).collect();
    output::check(&[&args.table], &outputs)?;
    match tables::open(&args.table, args.budget)? {
        Opened::Plain(cells) => walk(&cells, args, show_progress),
        Opened::Packed(cells) => walk(&cells, args, show_progress),
    }
}

fn walk<C: Cells>(cells: &C, args: &WalkArgs, show_progress: bool) -> Result<Done> {
    let file = &args.table;
    cells.refuse_without_places(file)?;
    let lens = args.lens.lens(cells, file)?;
    let (stands, step) = match (&args.path, args.random) {
        (Some(path), _) => (walk_path::read(path, cells.n_dimensions())?, None),
        (None, n) => {
            let step = args.step.map_or_else(|| usual_step(cells), Ok).in_file(file)?;
            let stands = wander(cells, n.unwrap_or(0) as usize, step, args.seed).in_file(file)?;
            (stands, Some(step))
        }
    };
    if stands.is_empty() {
        bail!("{}: the table has no cells, so there is nowhere to go", file.display());
    }
    let view = |(k, stand): (usize, &CameraPose)| {
        lens.view(*stand).map_err(|error| refused(args.path.as_deref().unwrap_or(file), k, error))
    };
    let views: Vec<View> = stands.iter().enumerate().map(view).collect::<Result<_, _>>()?;
    let drawn = args.levels.as_ref().map(|folder| levels::drawn(folder, cells, file, &views)).transpose()?;
    let methods = match args.method {
        Methods::One(method) if method != Method::CellToCell => vec![Method::CellToCell, method],
        methods => methods.list(),
    };
    let n_objects = CellSource::n_objects(cells) as u32;
    let polygons = (0..n_objects)
        .map(|o| cells.polygons_of(sightlines::pvs::ObjectId(o)))
        .collect::<Result<Vec<_>, _>>()
        .in_file(file)?;
    let options =
        WalkOptions { budget: args.budget, bounces: args.bounces, steps: args.steps, ..WalkOptions::default() };
    let bar = Bar::new("frames", show_progress);
    let walk = WalkMeasure { cells, views: &views, polygons: &polygons, options, fps: args.fps };
    let measured = walk.run(&methods, &|done, all| bar.set(done, all)).map_err(|error| match error {
        MeasureError::Source(error) => anyhow!("{}: {error}", file.display()),
        error => anyhow!("{}: {error}; this is a defect of the program", file.display()),
    })?;
    drop(bar);
    let outcome = WalkReport::new(file, options, (lens.fov, step), cells, &polygons, &measured, drawn);
    if let Some(out) = &args.output {
        output::save(out, walk_svg(&outcome.title(), &outcome.bars()).as_bytes())?;
    }
    if let Some(out) = &args.csv {
        output::save(out, outcome.csv().as_bytes())?;
    }
    Ok(Done::new(args.json, outcome))
}

/// The error of an invalid view in a frame.
fn refused(path: &Path, frame: usize, source: sightlines::eye_to_cell::ViewError) -> anyhow::Error {
    anyhow!("{}: frame {frame}: {source}", path.display())
}
