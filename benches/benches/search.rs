//! Cell-to-cell visibility and REJECT tables of generated plans.

use divan::Bencher;
use divan::counter::ItemsCount;
use sightlines::bake::see_groups;
use sightlines::cells::Plan;
use sightlines::scenes;
use sightlines::stabtree::{SearchOptions, Zones, planar_visibility};
use sightlines_benches::graph;

fn main() {
    divan::main();
}

const SCENES: [&str; 4] = ["office", "maze", "pillared_hall", "doom_like"];

fn plan(scene: &str) -> Plan {
    let plan = match scene {
        "office" => scenes::office(scenes::OfficeOptions::default()),
        "maze" => scenes::maze(1, 24, 24),
        "pillared_hall" => scenes::turned_pillared_hall(1, 8, 8),
        _ => scenes::doom_like(1, 8),
    };
    plan.expect("valid options")
}

fn one_thread() -> SearchOptions<'static> {
    SearchOptions { threads: 1, ..SearchOptions::default() }
}

/// Which cells see which; the counter is in ordered pairs of cells.
#[divan::bench(args = SCENES, name = "stabtree/cell_to_cell")]
fn cell_to_cell(bencher: Bencher<'_, '_>, scene: &str) {
    let graph = graph(&plan(scene));
    let zones = Zones::cells(&graph);
    let (rows, _) = planar_visibility(&graph, &zones, &one_thread()).expect("nobody cancels");
    assert!(rows.is_symmetric(), "{scene}");
    let pairs = graph.n_cells() * graph.n_cells();
    bencher
        .counter(ItemsCount::new(pairs))
        .bench_local(|| planar_visibility(&graph, &zones, &one_thread()).expect("nobody cancels").0.count_ones());
}

/// The same without chords, to see what they save.
#[divan::bench(args = SCENES, name = "stabtree/cell_to_cell/no_chords")]
fn cell_to_cell_no_chords(bencher: Bencher<'_, '_>, scene: &str) {
    let graph = graph(&plan(scene));
    let zones = Zones::cells(&graph);
    let options = SearchOptions { chords: 0, ..one_thread() };
    bencher.bench_local(|| planar_visibility(&graph, &zones, &options).expect("nobody cancels").0.count_ones());
}

/// Cutting a plan into convex cells.
#[divan::bench(args = SCENES, name = "triangulation/subdivide")]
fn subdivide(bencher: Bencher<'_, '_>, scene: &str) {
    let plan = plan(scene);
    bencher.bench_local(|| graph(&plan).n_cells());
}

/// Sectors of a Doom-like plan, from lines to table.
#[divan::bench(args = [4, 8, 16], name = "bake/reject/doom_like")]
fn reject(bencher: Bencher<'_, '_>, size: u32) {
    let plan = scenes::doom_like(1, size).expect("valid options");
    let (seen, _) = see_groups(&plan, plan.n_groups(), &one_thread()).expect("a plan with regions");
    assert!(seen.is_symmetric());
    bencher.bench_local(|| see_groups(&plan, plan.n_groups(), &one_thread()).map(|(m, _)| m.count_ones()));
}
