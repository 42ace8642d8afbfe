//! Stabbing lines in space: what a push costs while the line of the sequence before passes the new door too,
//! and how often which way of deciding decides.

use clap::Parser;
use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines::cells::{Axial, CellGraph, CellId, Exit};
use sightlines::kdtree::{SceneOptions, subdivide_scene};
use sightlines::scenes::{TowerOptions, tower};
use sightlines::sightline::{AxialCounters, AxialStabber, Stabber};
use sightlines_benches::program::Common;
use std::hint::black_box;
use std::time::Instant;

/// Pushes of the same door that one time is taken of.
const REPEATS: u32 = 256;
/// Doors in a sequence.
const MAX_DEPTH: usize = 16;
/// Pushes tried from each cell that is looked from.
const PER_CELL: u64 = 4_000;

/// Axial pushes: nanoseconds while the parent's witness holds, and what decided.
#[derive(Debug, Parser)]
struct Args {
    #[command(flatten)]
    common: Common,
    /// Floors of the tower.
    #[arg(long, default_value_t = 4)]
    floors: u32,
}

/// What a walk over sequences measured.
#[derive(Default)]
struct Times {
    /// Nanoseconds of a push and its undo, for each place where the witness held.
    witness: Vec<f64>,
    n_pushes: u64,
    n_open: u64,
}

fn main() {
    let args = Args::parse();
    if !args.common.is_wanted("sightline/axial/push") {
        return;
    }
    let options = if args.common.test {
        TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }
    } else {
        TowerOptions { floors: args.floors, ..TowerOptions::default() }
    };
    let scene = tower(options).unwrap_or_else(|e| panic!("{e}"));
    let graph = subdivide_scene(&scene, &SceneOptions::default()).unwrap_or_else(|e| panic!("{e}")).graph;
    let mut stabber = AxialStabber::new();
    let mut times = Times::default();
    let mut reached = Vec::new();
    let stride = (graph.n_cells() / 64).max(1);
    for cell in graph.cell_ids().step_by(stride) {
        let limit = times.n_pushes + PER_CELL;
        for exit in graph.exits(cell) {
            stabber.start(graph.door(exit));
            deeper(&graph, cell, exit, &mut stabber, &mut times, &mut reached, limit);
        }
    }
    if args.common.test {
        check(&scene, &reached);
    }
    report(&mut times, stabber.counters());
}

/// Pushes every door behind `at`, depth first, and takes times.
fn deeper(
    graph: &CellGraph<Axial>,
    from: CellId,
    at: &Exit,
    stabber: &mut AxialStabber,
    times: &mut Times,
    reached: &mut Vec<(CellId, CellId)>,
    limit: u64,
) {
    for exit in graph.exits(at.to).iter().filter(|e| e.side != at.entry_side) {
        if times.n_pushes >= limit {
            return;
        }
        let door = graph.door(exit);
        let before = stabber.counters().n_witness;
        times.n_pushes += 1;
        let Some(undo) = stabber.push(door) else { continue };
        times.n_open += 1;
        reached.push((from, exit.to));
        if stabber.counters().n_witness > before {
            stabber.undo(undo);
            times.witness.push(time(stabber, door));
            let again = stabber.push(door).expect("what was open stays open");
            if stabber.doors().len() < MAX_DEPTH {
                deeper(graph, from, exit, stabber, times, reached, limit);
            }
            stabber.undo(again);
            continue;
        }
        if stabber.doors().len() < MAX_DEPTH {
            deeper(graph, from, exit, stabber, times, reached, limit);
        }
        stabber.undo(undo);
    }
}

/// Nanoseconds of one push with its undo.
fn time(stabber: &mut AxialStabber, door: sightlines::geometry::AxialDoor) -> f64 {
    let start = Instant::now();
    for _ in 0..REPEATS {
        if let Some(undo) = stabber.push(black_box(door)) {
            stabber.undo(black_box(undo));
        }
    }
    start.elapsed().as_nanos() as f64 / f64::from(REPEATS)
}

/// What the search reaches, the table shows.
fn check(scene: &sightlines::cells::Scene, reached: &[(CellId, CellId)]) {
    let options = SceneBakeOptions { portals: PortalMode::Exact, ..SceneBakeOptions::default() };
    let table = bake_scene(scene, &options).unwrap_or_else(|e| panic!("{e}")).table;
    assert!(reached.len() > 100, "{} sequences", reached.len());
    for &(a, b) in reached {
        assert!(table.sees(a, b), "a line leads from cell {a} to cell {b}");
    }
}

fn report(times: &mut Times, counters: AxialCounters) {
    times.witness.sort_unstable_by(f64::total_cmp);
    let n = times.witness.len();
    assert!(n > 20, "the witness held {n} times");
    let at = |share: f64| times.witness[((n - 1) as f64 * share) as usize];
    println!(
        "sightline/axial/push: {:.0} ns in the median while the parent's witness holds, undo included \
         (90 % below {:.0} ns; {n} places)",
        at(0.5),
        at(0.9),
    );
    // Pushes that were timed all held their witness; they are no part of what a search does.
    let repeated = n as u64 * (u64::from(REPEATS) + 1);
    let AxialCounters { n_planar, n_witness, n_float, n_exact, .. } = counters;
    let decided = [
        ("planar funnels", n_planar),
        ("the parent's witness", n_witness - repeated),
        ("the program in doubles", n_float),
        ("the exact fallback", n_exact),
    ];
    let all: u64 = decided.iter().map(|d| d.1).sum();
    println!("sightline/axial/push: {} pushes, {} of them open; decided by", times.n_pushes, times.n_open);
    for (what, count) in decided {
        println!("    {what:<24} {count:>10}  {:>6.2} %", 100.0 * count as f64 / all.max(1) as f64);
    }
}
