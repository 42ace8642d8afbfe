//! What the eye-to-cell methods cost, and what they leave: queries on walks through a tower and a Quake map; and that
//! no frame waits for a source that is slow.
//!
//! Each query is run three times in a row, and the least time counts: the extra time of the first comes from the
//! machine's caches and other load. Beside it stands the time of the first. The bars are those that a frame can spare:
//! 5 µs for the disjoint cell, 50 µs in the median and 500 µs at the 99th percentile for the exact method.

use clap::Parser;
use sightlines::bake::quake::bake_map;
use sightlines::bake::{PrtOptions, SceneBakeOptions, StabOptions, bake_scene, from_table, with_stab_trees};
use sightlines::eye_to_cell::{Doors, Method, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::quake::{read_bsp, read_prt};
use sightlines::geometry::Aabb;
use sightlines::kdtree::SceneOptions;
use sightlines::packed::{ByteSource, PackOptions, Packed, pack};
use sightlines::pvs::{CellId, ObjectId, Table};
use sightlines::scenes::{TowerOptions, tower};
use sightlines::walkthrough::{AnswerKind, CameraPose, PackedCells, WalkOptions, Walkthrough, wander};
use sightlines_benches::program::{Common, exit};
use sightlines_tests::data_folder;
use std::convert::Infallible;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Eye-to-cell queries.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the tower; 10 have 274,000 triangles.
    #[arg(long, default_value_t = 10)]
    floors: u32,
    /// A Quake map with its portal file beside it; e1m1 of $SIGHTLINES_DATA if not given, and none without that.
    #[arg(long, value_name = "MAP.bsp")]
    map: Option<PathBuf>,
    /// Frames of each walk.
    #[arg(long, default_value_t = 10_000)]
    frames: usize,
    /// Width of the view, in degrees.
    #[arg(long, default_value_t = 75.0)]
    fov: f64,
    /// Measures again with stab trees of at most so many nodes a cell; 0 for what `build --stab-trees` takes.
    #[arg(long, value_name = "N")]
    stab_trees: Option<usize>,
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("eye_to_cell") {
        return ExitCode::SUCCESS;
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let mut options = TowerOptions { floors: args.floors, ..TowerOptions::default() };
    let mut n_frames = args.frames;
    if args.common.test {
        options = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 2, ..options };
        n_frames = 300;
    }
    let scene = tower(options)?;
    let cut = SceneOptions { tau: 0.0, ..SceneOptions::default() };
    let table = bake_scene(&scene, &SceneBakeOptions { cut, ..SceneBakeOptions::default() })?.table;
    println!("tower of {} floors, {} triangles", options.floors, scene.n_triangles());
    let stands = measure(&table, [0.0, 1.0, 0.0], n_frames, args.fov)?;
    measure_with_trees(&table, [0.0, 1.0, 0.0], n_frames, args)?;
    slow_source(&table, &stands[..n_frames.min(1000)], args.fov)?;
    let map = args
        .map
        .clone()
        .or_else(|| Some(data_folder("SIGHTLINES_DATA")?.join("quake/e1m1.bsp")))
        .filter(|_| !args.common.test);
    if let Some(path) = map {
        println!("{}", path.display());
        let table = table_of_map(&path)?;
        measure(&table, [0.0, 0.0, 1.0], n_frames, args.fov)?;
        measure_with_trees(&table, [0.0, 0.0, 1.0], n_frames, args)?;
    }
    Ok(())
}

fn measure_with_trees(table: &Table, up: [f64; 3], n_frames: usize, args: &Args) -> Result<(), Box<dyn Error>> {
    let Some(most) = args.stab_trees else { return Ok(()) };
    let options = StabOptions { max_nodes: Some(most).filter(|&most| most > 0), ..StabOptions::default() };
    let graph = from_table::graph(table).ok_or("a table without portals")?;
    let baked = with_stab_trees(table.clone(), &graph, &options)?;
    println!(
        "with stab trees of at most {} nodes, made in {:.1} s",
        baked.report.max_nodes,
        baked.report.time.as_secs_f64()
    );
    measure(&baked.table, up, n_frames, args.fov)?;
    Ok(())
}

fn table_of_map(path: &Path) -> Result<Table, Box<dyn Error>> {
    let (bsp, prt) = (read_bsp(path)?, read_prt(path.with_extension("prt"))?);
    Ok(bake_map(&bsp, &prt, PrtOptions::default())?.table)
}

fn diagonal(table: &Table) -> f64 {
    let around = Aabb::around(table.cells().iter().flat_map(|cell| [cell.min, cell.max]));
    (0..3).map(|k| (around.max[k] - around.min[k]).powi(2)).sum::<f64>().sqrt()
}

fn view(stand: &CameraPose, up: [f64; 3], fov: f64) -> Result<View, Box<dyn Error>> {
    Ok(View::perspective_horizontal(stand.eye, stand.dir, up, fov.to_radians(), 4.0 / 3.0)?)
}

/// The time of one query, the first time and the least.
#[derive(Debug, Clone, Copy)]
struct Times([Duration; 2]);

/// What a method took and left, over a walk.
struct Measured {
    method: Method,
    times: Vec<Times>,
    n_cells: usize,
    n_objects: usize,
    n_polygons: u64,
}

fn measure(table: &Table, up: [f64; 3], n_frames: usize, fov: f64) -> Result<Vec<CameraPose>, Box<dyn Error>> {
    let cells = TableCells::new(table);
    let start = Instant::now();
    let all: Result<Vec<VisibleSubgraph>, Infallible> =
        (0..table.n_cells() as u32).map(|cell| VisibleSubgraph::prepare(&cells, CellId(cell))).collect();
    let (all, time) = (all?, start.elapsed());
    let bytes: usize = all.iter().map(VisibleSubgraph::n_bytes).sum();
    println!(
        "{} cells, {} objects; an subgraph takes {:.0} us and {:.1} KiB on average",
        table.n_cells(),
        table.objects().len(),
        time.as_secs_f64() * 1e6 / all.len().max(1) as f64,
        bytes as f64 / 1024.0 / all.len().max(1) as f64
    );
    let stands = wander(&cells, n_frames, diagonal(table) / 400.0, 1)?;
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    let mut measured = Vec::new();
    for method in Method::ALL {
        let mut m = Measured { method, times: Vec::new(), n_cells: 0, n_objects: 0, n_polygons: 0 };
        // The first walk makes room in memory.
        for warm in [false, true] {
            for stand in &stands {
                let view = view(stand, up, fov)?;
                let at = table.in_dimension().expect("it is of space").at(stand.eye).cells().to_vec();
                let times = [0; 3].map(|_| {
                    let start = Instant::now();
                    seen.clear(table.n_cells(), table.objects().len());
                    for cell in &at {
                        method.look(&all[cell.idx()], &view, &Doors::all_open(), &mut scratch, &mut seen);
                    }
                    start.elapsed()
                });
                if warm {
                    m.times.push(Times([times[0], times.into_iter().min().unwrap_or_default()]));
                    m.n_cells += seen.cells().len();
                    m.n_objects += seen.objects().len();
                    m.n_polygons += seen.objects().iter().map(|&o| u64::from(table.polygons_of(o))).sum::<u64>();
                }
            }
        }
        measured.push(m);
    }
    report(table, &mut measured);
    let kept: Vec<usize> = measured.iter().map(|m| m.n_cells).collect();
    assert!(kept.is_sorted_by(|a, b| a >= b) && kept[4] < kept[0], "each method leaves no more than the one before");
    Ok(stands)
}

fn report(table: &Table, measured: &mut [Measured]) {
    println!("| method | cells | objects | polygons | median, us | p99, us | first time: median | p99 |");
    println!("| --- | --: | --: | --: | --: | --: | --: | --: |");
    let all_polygons: u64 = (0..table.objects().len() as u32).map(|o| u64::from(table.polygons_of(ObjectId(o)))).sum();
    for m in &mut *measured {
        let n = m.times.len().max(1);
        let share = |kept: f64, all: f64| 100.0 * kept / (n as f64 * all.max(1.0));
        let at = |m: &Measured, k: usize, q: f64| quantile(m.times.iter().map(|t| t.0[k]).collect(), q);
        println!(
            "| {} | {:.2} % | {:.2} % | {:.2} % | {:.2} | {:.1} | {:.2} | {:.1} |",
            m.method,
            share(m.n_cells as f64, table.n_cells() as f64),
            share(m.n_objects as f64, table.objects().len() as f64),
            share(m.n_polygons as f64, all_polygons as f64),
            at(m, 1, 0.5),
            at(m, 1, 0.99),
            at(m, 0, 0.5),
            at(m, 0, 0.99),
        );
    }
    for (method, q, bar) in [(Method::DisjointCell, 0.5, 5.0), (Method::Exact, 0.5, 50.0), (Method::Exact, 0.99, 500.0)]
    {
        let Some(m) = measured.iter().find(|m| m.method == method) else { continue };
        let us = quantile(m.times.iter().map(|t| t.0[1]).collect(), q);
        let kept = if us <= bar { "kept" } else { "NOT KEPT" };
        println!("{method}, {:.0} % of the queries: {us:.2} us, bar {bar} us: {kept}", 100.0 * q);
    }
}

/// In microseconds.
fn quantile(mut times: Vec<Duration>, q: f64) -> f64 {
    times.sort_unstable();
    times.get((times.len().saturating_sub(1) as f64 * q) as usize).map_or(0.0, |t| t.as_secs_f64() * 1e6)
}

/// A file that takes its time for each block.
struct Slow(Vec<u8>, Duration);

impl ByteSource for Slow {
    fn len(&self) -> io::Result<u64> {
        ByteSource::len(&self.0)
    }

    fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
        std::thread::sleep(self.1);
        self.0.read_at(offset, buf)
    }
}

/// Walks with a packed table in a file that takes 20 ms for each block, and keeps hardly any: at full speed, and with time between the
/// frames.
fn slow_source(table: &Table, stands: &[CameraPose], fov: f64) -> Result<(), Box<dyn Error>> {
    let bytes = pack(table, &PackOptions::default())?;
    for pause in [Duration::ZERO, Duration::from_millis(2)] {
        let packed = Packed::open(Slow(bytes.clone(), Duration::from_millis(20)), 1 << 16)?;
        let cells = PackedCells::new(packed);
        let mut walk = Walkthrough::new(
            cells.clone(),
            cells,
            WalkOptions { steps: StepBudget::UNLIMITED, ..WalkOptions::default() },
        );
        let mut times = Vec::new();
        let mut late = 0;
        for stand in stands {
            let view = view(stand, [0.0, 1.0, 0.0], fov)?;
            let start = Instant::now();
            late += usize::from(walk.frame(&view, Method::Exact).answer == AnswerKind::Late);
            times.push(start.elapsed());
            std::thread::sleep(pause);
        }
        println!(
            "a file that takes 20 ms a block, {} ms between frames: frames take {:.1} us in the median, {:.1} us at p99, \
             {:.1} us at most; {:.1} % were late",
            pause.as_millis(),
            quantile(times.clone(), 0.5),
            quantile(times.clone(), 0.99),
            quantile(times.clone(), 1.0),
            100.0 * late as f64 / stands.len().max(1) as f64
        );
    }
    Ok(())
}
