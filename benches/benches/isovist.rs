//! Isovists, sight between points, and which of many points are seen, beside a plain test of every wall; with Python and the packages, beside
//! pysovist and pyvisgraph in the same run.
//!
//! Plans: generated offices and Doom-like maps; the floor plans and maps of `SIGHTLINES_DATA` and of `SIGHTLINES_FREEDOOM`. Times are of one thread.

use clap::Parser;
use sightlines::cells::Plan;
use sightlines::formats::Wad;
use sightlines::formats::doom::{DoomMap, choose_map, list_maps};
use sightlines::geometry::{Point2, Random, Segment2};
use sightlines::isovist::{Isovist, IsovistFinder, Touch, WallMesh};
use sightlines::scenes::{OfficeOptions, doom_like, office};
use sightlines_benches::measure::{CpuClock, Work};
use sightlines_benches::program::{Common, exit};
use std::error::Error;
use std::hint::black_box;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};

/// Isovists and sight between points.
#[derive(Debug, Clone, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Eyes in each plan.
    #[arg(long, default_value_t = 2000)]
    eyes: usize,
}

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.common.is_wanted("isovist") {
        return ExitCode::SUCCESS;
    }
    exit(run(&args))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    println!(
        "plan                      walls  mesh ms  isovist us  with measures  vertices  sees ns  plain test ns  ratio"
    );
    for (name, plan) in plans(args.common.test)? {
        measure(args, &name, &plan)?;
    }
    Ok(())
}

fn plans(small: bool) -> Result<Vec<(String, Plan)>, Box<dyn Error>> {
    let rooms = |rooms_x, rooms_y| office(OfficeOptions { rooms_x, rooms_y, ..OfficeOptions::default() });
    let mut plans = vec![("office 4 x 3".to_owned(), rooms(4, 3)?)];
    if small {
        return Ok(plans);
    }
    plans.push(("office 9 x 8".to_owned(), rooms(9, 8)?));
    for size in [8, 40] {
        plans.push((format!("Doom-like {size}"), doom_like(1, size)?));
    }
    match std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from) {
        None => eprintln!("SKIPPED: SIGHTLINES_DATA is not set, so real plans are not benched"),
        Some(data) => {
            for name in ["bimwhale_largebuilding_0", "mlstruct_fp_test_0", "mlstruct_fp_test_2"] {
                plans.push((
                    name.to_owned(),
                    sightlines::formats::geojson::read_plan(data.join(format!("plans/{name}.geojson")))?,
                ));
            }
        }
    }
    match std::env::var_os("SIGHTLINES_FREEDOOM").map(PathBuf::from) {
        None => eprintln!("SKIPPED: SIGHTLINES_FREEDOOM is not set, so Freedoom's MAP12 is not benched"),
        Some(folder) => {
            let wad = Wad::read(folder.join("freedoom2.wad"))?;
            let map = DoomMap::parse(&wad, choose_map(&list_maps(&wad), Some("MAP12"))?)?;
            plans.push(("Freedoom MAP12".to_owned(), map.plan()?));
        }
    }
    Ok(plans)
}

/// Points in the box of the walls.
fn eyes(plan: &Plan, n: usize) -> Vec<Point2> {
    let bounds = plan.bounds();
    let mut random = Random::new(7);
    let mut coordinate = |k: usize| bounds.min[k] + random.unit() * (bounds.max[k] - bounds.min[k]);
    (0..n).map(|_| Point2::new(coordinate(0), coordinate(1))).collect()
}

fn measure(args: &Args, name: &str, plan: &Plan) -> Result<(), Box<dyn Error>> {
    let walls: Vec<Segment2> =
        plan.lines().iter().filter(|line| line.opaque).map(|line| Segment2::new(line.a, line.b)).collect();
    let start = CpuClock::start(Work::Thread);
    let mesh = WallMesh::new(plan)?;
    let mesh_ms = start.elapsed().as_secs_f64() * 1e3;
    let eyes = eyes(plan, if args.common.test { 50 } else { args.eyes });
    let plain = |a: Point2, b: Point2| !walls.iter().any(|wall| wall.meets(&Segment2::new(a, b)));
    for pair in eyes.windows(2).take(200) {
        assert_eq!(mesh.sees(pair[0], pair[1], Touch::Blocks)?, plain(pair[0], pair[1]), "{name}: {pair:?}");
    }
    let mut viewer = IsovistFinder::new(&mesh);
    let mut isovist = Isovist::default();
    let (mut n_vertices, mut best, mut best_measured) = (0, f64::INFINITY, f64::INFINITY);
    let rounds = if args.common.test { 1 } else { 5 };
    for _ in 0..rounds {
        n_vertices = 0;
        let start = CpuClock::start(Work::Thread);
        for &eye in &eyes {
            viewer.look(eye, &mut isovist)?;
            n_vertices += black_box(&isovist).vertices().len();
        }
        best = best.min(start.elapsed().as_secs_f64());
        let start = CpuClock::start(Work::Thread);
        for &eye in &eyes {
            viewer.look(eye, &mut isovist)?;
            black_box(isovist.measures());
        }
        best_measured = best_measured.min(start.elapsed().as_secs_f64());
    }
    let n = eyes.len() as f64;
    let pairs: Vec<(Point2, Point2)> = eyes.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let start = CpuClock::start(Work::Thread);
    for &(a, b) in &pairs {
        black_box(mesh.sees(a, b, Touch::Blocks)?);
    }
    let sees = start.elapsed().as_secs_f64() / pairs.len() as f64;
    let start = CpuClock::start(Work::Thread);
    for &(a, b) in pairs.iter().take(500) {
        black_box(plain(a, b));
    }
    let by_plain = start.elapsed().as_secs_f64() / pairs.len().min(500) as f64;
    println!(
        "{name:24} {:6}  {mesh_ms:7.1}  {:10.2}  {:13.2}  {:8.1}  {:7.0}  {:13.0}  {:5.1}",
        walls.len(),
        best / n * 1e6,
        best_measured / n * 1e6,
        n_vertices as f64 / n,
        sees * 1e9,
        by_plain * 1e9,
        by_plain / sees
    );
    std::io::stdout().flush()?;
    if !args.common.test && walls.len() < 1000 {
        rivals(&walls, &eyes, best / n);
    }
    Ok(())
}

/// The same isovists by packages of Python, if they are there.
fn rivals(walls: &[Segment2], eyes: &[Point2], ours: f64) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/rivals/isovist.py");
    let child = Command::new("python3").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let Ok(mut child) = child else {
        eprintln!("SKIPPED: no python3, so no rival is measured");
        return;
    };
    let mut text = String::new();
    for wall in walls {
        text += &format!("wall {} {} {} {}\n", wall.a.x, wall.a.y, wall.b.x, wall.b.y);
    }
    for eye in eyes.iter().take(20) {
        text += &format!("eye {} {}\n", eye.x, eye.y);
    }
    let written = child.stdin.take().map(|mut stdin| stdin.write_all(text.as_bytes()));
    let output = child.wait_with_output();
    let (Some(Ok(())), Ok(output)) = (written, output) else {
        eprintln!("SKIPPED: the rivals' program did not run");
        return;
    };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        match line.rsplit_once(' ').and_then(|(rival, seconds)| Some((rival, seconds.parse::<f64>().ok()?))) {
            Some((rival, seconds)) => {
                println!("    {rival}: {:.1} us an isovist, {:.0} times ours", seconds * 1e6, seconds / ours)
            }
            None => eprintln!("SKIPPED: {line}"),
        }
    }
}
