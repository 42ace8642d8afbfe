//! Visibility graph analysis: the graph and its measures, beside a plain test of all pairs of points against all walls.

use clap::Parser;
use sightlines::cells::Plan;
use sightlines::geometry::Segment2;
use sightlines::isovist::{Touch, WallMesh};
use sightlines::scenes::{OfficeOptions, office};
use sightlines::visibility_graph::{
    AngularMeasures, GlobalMeasures, LocalMeasures, MetricMeasures, PixelGrid, Points, Turns, VisibilityGraph,
    WorkOptions,
};
use sightlines_benches::program::Common;
use std::hint::black_box;
use std::time::Instant;

/// Seconds on one thread for an office floor of some thousand points, as shares of the plain test; with --large also for 100,000 points on
/// all threads.
#[derive(Debug, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Points of the small run, about.
    #[arg(long, default_value_t = 4332)]
    points: usize,
    /// Points of the large run, about; 0 for none.
    #[arg(long, default_value_t = 100_000)]
    large: usize,
    /// Leave out metric and angular measures.
    #[arg(long)]
    no_paths: bool,
}

fn main() {
    let args = Args::parse();
    if !args.common.is_wanted("vga") {
        return;
    }
    let options = OfficeOptions { rooms_x: 18, rooms_y: 6, furniture: false, ..OfficeOptions::default() };
    let plan = office(options).unwrap_or_else(|e| panic!("{e}"));
    let n = if args.common.test { 600 } else { args.points };
    small(&plan, &grid(&plan, n), &args);
    if !args.common.test && args.large > 0 {
        large(&plan, &grid(&plan, args.large));
    }
}

/// About so many points: all pixels that walls enclose, of a spacing that divides the area among them.
fn grid(plan: &Plan, n: usize) -> Points {
    let bounds = plan.bounds();
    let area = (bounds.max[0] - bounds.min[0]) * (bounds.max[1] - bounds.min[1]);
    // Centres on walls would be left out; few multiples of this spacing are.
    let spacing = (area / n as f64).sqrt() * 0.999;
    let grid = PixelGrid::over(plan, spacing).unwrap_or_else(|e| panic!("{e}"));
    grid.enclosed().unwrap_or_else(|e| panic!("{e}"))
}

fn timed<T>(what: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = what();
    (start.elapsed().as_secs_f64(), result)
}

fn graph(plan: &Plan, points: &Points, effort: &WorkOptions<'_>) -> VisibilityGraph {
    let mesh = WallMesh::new(plan).unwrap_or_else(|e| panic!("{e}"));
    let index = mesh.index(points.coordinates()).unwrap_or_else(|e| panic!("{e}"));
    let seen = |eye: u32, list: &mut Vec<u32>| mesh.points_seen(eye, &index, Touch::Blocks, list);
    VisibilityGraph::build(points.len() as u32, seen, effort).unwrap_or_else(|e| panic!("{e}"))
}

fn small(plan: &Plan, points: &Points, args: &Args) {
    let effort = WorkOptions { threads: 1, ..WorkOptions::default() };
    let walls: Vec<Segment2> = plan.lines().iter().filter(|l| l.opaque).map(|l| Segment2::new(l.a, l.b)).collect();
    let at = points.coordinates();
    let (plain, pairs) = timed(|| {
        let mut pairs = Vec::new();
        for (i, &a) in (0u32..).zip(at) {
            for (j, &b) in (0..i).zip(at) {
                let line = Segment2::new(a, b);
                if !walls.iter().any(|wall| wall.meets(&line)) {
                    pairs.push((i, j));
                }
            }
        }
        pairs
    });
    let (building, graph) = timed(|| graph(plan, points, &effort));
    // The same pairs, and no others.
    let n_pairs: u64 = (0..at.len() as u32).map(|p| u64::from(graph.n_seen(p))).sum();
    assert!(pairs.iter().all(|&(i, j)| graph.sees(i, j) && graph.sees(j, i)), "a pair is missing");
    assert_eq!(n_pairs, 2 * pairs.len() as u64);
    let (local, _) = timed(|| black_box(LocalMeasures::of(&graph, points, &effort)));
    let (global, found) = timed(|| GlobalMeasures::of(&graph, None, &effort).unwrap_or_else(|e| panic!("{e}")));
    assert!(found.node_count.iter().all(|&n| n as usize <= at.len()));
    println!("vga: {} points, {} walls, {} pairs see each other", at.len(), walls.len(), pairs.len());
    let row = |what: &str, seconds: f64| {
        println!("    {what:<28} {seconds:>9.3} s  {:>8.5} of the plain test", seconds / plain)
    };
    row("plain test of all pairs", plain);
    row("graph", building);
    row("local measures", local);
    row("graph and local measures", building + local);
    row("global measures", global);
    if !args.no_paths {
        let (metric, found) = timed(|| {
            MetricMeasures::of(&graph, points, Turns::NearWalls, None, &effort).unwrap_or_else(|e| panic!("{e}"))
        });
        assert!(
            found
                .mean_path_length
                .iter()
                .zip(&found.mean_straight_distance)
                .all(|(path, line)| *path >= line * (1.0 - 1e-12))
        );
        row("metric measures", metric);
        let (angular, _) = timed(|| black_box(AngularMeasures::of(&graph, points, Turns::NearWalls, None, &effort)));
        row("angular measures", angular);
    }
    println!("    {} runs, {} bytes", graph.n_runs(), graph.n_bytes());
}

fn large(plan: &Plan, points: &Points) {
    let effort = WorkOptions::default();
    println!("vga: {} points on all threads", points.len());
    let row = |what: &str, seconds: f64| println!("    {what:<28} {seconds:>9.1} s");
    let (building, graph) = timed(|| graph(plan, points, &effort));
    row("graph", building);
    println!("    {} runs, {} bytes", graph.n_runs(), graph.n_bytes());
    row("local measures", timed(|| black_box(LocalMeasures::of(&graph, points, &effort))).0);
    row("global measures", timed(|| black_box(GlobalMeasures::of(&graph, None, &effort))).0);
}
