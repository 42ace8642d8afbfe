//! The frame loop on one thread: a walk through a tower in which each frame prepares what it requests. Every run of the
//! same walk executes the same instructions, so that they can be counted.
//!
//! Each answer is checked against the method itself.

use clap::Parser;
use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::eye_to_cell::{Doors, Method, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::pvs::Table;
use sightlines::scenes::{TowerOptions, tower};
use sightlines::walkthrough::{AnswerKind, WalkOptions, Walkthrough, wander};
use sightlines_benches::program::{Common, exit};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Frames per second, and scene units per second.
const RATE: f64 = 60.0;
const SPEED: f64 = 1.5;

/// The frame loop on one thread.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the tower.
    #[arg(long, default_value_t = 6)]
    floors: u32,
    /// Frames of the walk.
    #[arg(long, default_value_t = 3000)]
    frames: usize,
    /// Reads the table from this file if it exists, or else bakes it and writes it there.
    #[arg(long)]
    table: Option<PathBuf>,
    /// Leaves out the check of the answers.
    #[arg(long)]
    no_check: bool,
}

type Cells = TableCells<Arc<Table>>;

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("walkthrough/frame_loop") {
        return ExitCode::SUCCESS;
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let (floors, n_frames) = if args.common.test { (1, 200) } else { (args.floors, args.frames) };
    let cells = TableCells::new(Arc::new(table(args, floors)?));
    let views = wander(&cells, n_frames, SPEED / RATE, 3)?
        .iter()
        .map(|pose| View::perspective_horizontal(pose.eye, pose.dir, [0.0, 1.0, 0.0], 1.2, 1.6))
        .collect::<Result<Vec<_>, _>>()?;
    let options = WalkOptions { has_thread: false, steps: StepBudget::UNLIMITED, ..WalkOptions::default() };
    let mut walk = Walkthrough::new(cells.clone(), cells.clone(), options);
    let start = Instant::now();
    let n_seen = walk_frames(&mut walk, &views);
    let seconds = start.elapsed().as_secs_f64();
    let counters = walk.counters();
    println!("{} frames, {} late, {n_seen} cells seen in all", counters.frames, counters.late);
    println!("{:.2} us a frame", 1e6 * seconds / n_frames as f64);
    if !args.no_check {
        let n_checked = check(&cells, &views)?;
        println!("{n_checked} answers are those of the method");
    }
    Ok(())
}

/// The part to count: all frames, and nothing else. Returns the number of cells seen.
#[inline(never)]
fn walk_frames(walk: &mut Walkthrough<Cells, Cells>, views: &[View]) -> usize {
    views.iter().map(|view| walk.frame(view, Method::Exact).seen.cells().len()).sum()
}

/// Walks again and compares each answer that is not late with the method. Returns how many those are.
fn check(cells: &Cells, views: &[View]) -> Result<usize, Box<dyn Error>> {
    let options = WalkOptions { has_thread: false, steps: StepBudget::UNLIMITED, ..WalkOptions::default() };
    let mut walk = Walkthrough::new(cells.clone(), cells.clone(), options);
    let (mut scratch, mut expected, doors) = (Scratch::new(), VisibleSet::new(), Doors::all_open());
    let (n_cells, n_objects) = (cells.table().n_cells(), cells.table().objects().len());
    let mut n_checked = 0;
    for (k, view) in views.iter().enumerate() {
        let frame = walk.frame(view, Method::Exact);
        if frame.answer != AnswerKind::Full {
            continue;
        }
        expected.clear(n_cells, n_objects);
        for &cell in frame.at {
            let subgraph = VisibleSubgraph::prepare(cells, cell)?;
            Method::Exact.look(&subgraph, view, &doors, &mut scratch, &mut expected);
        }
        if frame.seen.cells() != expected.cells() || frame.seen.objects() != expected.objects() {
            return Err(format!("frame {k}: not what the method sees").into());
        }
        n_checked += 1;
    }
    if n_checked * 10 < views.len() * 9 {
        return Err(format!("only {n_checked} of {} frames are not late", views.len()).into());
    }
    Ok(n_checked)
}

fn table(args: &Args, floors: u32) -> Result<Table, Box<dyn Error>> {
    if let Some(path) = args.table.as_ref().filter(|path| path.exists()) {
        return Ok(Table::from_bytes(&std::fs::read(path)?)?);
    }
    let options = TowerOptions { floors, furniture: 0, ..TowerOptions::default() };
    let table = bake_scene(&tower(options)?, &SceneBakeOptions::default())?.table;
    if let Some(path) = &args.table {
        std::fs::write(path, table.to_bytes())?;
    }
    Ok(table)
}
