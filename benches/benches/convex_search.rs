//! The search through convex portals in generated levels: stage by stage, and as a whole.

use divan::Bencher;
use divan::counter::ItemsCount;
use sightlines::cells::{CellGraph, Convex};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::stabtree::{ConvexOptions, ConvexSearch};
use sightlines_testkit::convex::{ClassicalLevel, ClassicalOptions, classical};

fn main() {
    divan::main();
}

/// Rooms each way of a level with two floors.
const SIZES: [u32; 3] = [1, 2, 4];

fn level(rooms: u32) -> CellGraph<Convex> {
    let options = QuakeLikeOptions { seed: 1, rooms_x: rooms, rooms_y: rooms, floors: 2 };
    quake_like(options).expect("few rooms").graph
}

/// A search on one thread that is about to begin a stage, or at its end.
fn at_stage(graph: &CellGraph<Convex>, fast: bool, stage: u32) -> ConvexSearch {
    let mut search = ConvexSearch::new(graph, ConvexOptions { fast, threads: 1 });
    while search.state().stage < stage && search.advance() {}
    search
}

/// Goes on to the end of a stage; the number of pairs known to be visible by then.
fn to_stage(mut search: ConvexSearch, stage: u32) -> u64 {
    while search.state().stage < stage && search.advance() {}
    search.state().visible.count_ones()
}

/// One stage; the counter is in portals.
fn stage(bencher: Bencher<'_, '_>, rooms: u32, stage: u32) {
    let graph = level(rooms);
    let n_portals = graph.portals().len();
    let before = at_stage(&graph, false, stage).state().visible.count_ones();
    assert!(to_stage(at_stage(&graph, false, stage), stage + 1) >= before, "what is visible stays so");
    bencher
        .counter(ItemsCount::new(n_portals))
        .with_inputs(|| at_stage(&graph, false, stage))
        .bench_local_values(|search| to_stage(search, stage + 1));
}

/// The first bound.
#[divan::bench(args = SIZES, name = "stabtree/convex/bound", sample_count = 20)]
fn bound(bencher: Bencher<'_, '_>, rooms: u32) {
    stage(bencher, rooms, 0);
}

/// The lines that come first.
#[divan::bench(args = SIZES, name = "stabtree/convex/lines", sample_count = 20)]
fn lines(bencher: Bencher<'_, '_>, rooms: u32) {
    stage(bencher, rooms, 1);
}

/// Beams.
#[divan::bench(args = SIZES, name = "stabtree/convex/beams", sample_count = 10)]
fn beams(bencher: Bencher<'_, '_>, rooms: u32) {
    stage(bencher, rooms, 2);
}

/// Pairs that beams leave.
#[divan::bench(args = SIZES, name = "stabtree/convex/pairs", sample_count = 10)]
fn pairs(bencher: Bencher<'_, '_>, rooms: u32) {
    stage(bencher, rooms, 3);
}

/// From the graph to the answer; the counter is in ordered pairs of cells.
#[divan::bench(args = SIZES, name = "stabtree/convex/search", sample_count = 10)]
fn search(bencher: Bencher<'_, '_>, rooms: u32) {
    let graph = level(rooms);
    let exact = at_stage(&graph, false, 4).finish();
    let bound = at_stage(&graph, true, 4).finish();
    assert!(exact.cells.is_symmetric() && exact.cells.count_ones() < bound.cells.count_ones(), "{rooms}");
    bencher
        .counter(ItemsCount::new(graph.n_cells() * graph.n_cells()))
        .bench_local(|| at_stage(&graph, false, 4).finish().cells.count_ones());
}

/// The method of other programs on the same levels.
#[divan::bench(args = SIZES, name = "testkit/convex/classical", sample_count = 10)]
fn planes_alone(bencher: Bencher<'_, '_>, rooms: u32) {
    let graph = level(rooms);
    let options = ClassicalOptions { level: ClassicalLevel::Symmetric, ..ClassicalOptions::default() };
    let seen = classical(&graph, options, || false);
    assert_eq!(seen.n_finished, seen.n_gates);
    bencher
        .counter(ItemsCount::new(graph.n_cells() * graph.n_cells()))
        .bench_local(|| classical(&graph, options, || false).steps);
}
