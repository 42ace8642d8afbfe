//! Stabbing lines: the funnel beside the linear program, on the same sequences.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use sightlines::cells::Plan;
use sightlines::geometry::{Adaptive, Orient2d, Portal2};
use sightlines::scenes;
use sightlines::sightline::{Funnel, PlanarCertificate};
use sightlines_benches::{corridors, graph};
use sightlines_testkit::lp::{LpAnswer, stab};

fn main() {
    divan::main();
}

const SCENES: [&str; 2] = ["office", "doom_like"];

fn plan(scene: &str) -> Plan {
    match scene {
        "office" => scenes::office(scenes::OfficeOptions::default()).expect("valid options"),
        _ => scenes::doom_like(1, 8).expect("valid options"),
    }
}

fn sequences(scene: &str) -> Vec<Vec<Portal2>> {
    let found = corridors(&graph(&plan(scene)), 4, 400);
    assert!(found.len() >= 100, "{scene} gives {} corridors", found.len());
    found
}

/// Passable so far, portal by portal, and back again.
fn run<O: Orient2d>(
    funnel: &mut Funnel<O>,
    doors: &[Portal2],
    undos: &mut Vec<sightlines::sightline::FunnelUndo>,
) -> bool {
    funnel.start(doors[0]);
    let mut open = true;
    for &door in &doors[1..] {
        match funnel.push(door) {
            Some(undo) => undos.push(undo),
            None => open = false,
        }
    }
    while let Some(undo) = undos.pop() {
        funnel.undo(undo);
    }
    open
}

fn bench_funnel<O: Orient2d>(bencher: Bencher<'_, '_>, scene: &str, orient: O) {
    let corridors = sequences(scene);
    let pushes: usize = corridors.iter().map(Vec::len).sum();
    let mut funnel = Funnel::new(orient);
    let mut undos = Vec::new();
    for doors in &corridors {
        assert_eq!(run(&mut funnel, doors, &mut undos), PlanarCertificate::find(doors).is_none(), "{scene}");
    }
    bencher
        .counter(ItemsCount::new(pushes))
        .bench_local(move || corridors.iter().filter(|doors| run(&mut funnel, black_box(doors), &mut undos)).count());
}

/// Push and pop, exact for any coordinates.
#[divan::bench(args = SCENES, name = "sightline/push_pop/adaptive")]
fn push_pop_adaptive(bencher: Bencher<'_, '_>, scene: &str) {
    bench_funnel(bencher, scene, Adaptive);
}

/// Push and pop, exact on a small grid.
#[divan::bench(args = SCENES, name = "sightline/push_pop/small_grid")]
fn push_pop_small_grid(bencher: Bencher<'_, '_>, scene: &str) {
    let grid = plan(scene).small_grid().expect("generated plans are on a small grid");
    bench_funnel(bencher, scene, grid);
}

/// One linear program for each sequence: the reference, which cannot be extended portal by portal.
#[divan::bench(args = SCENES, name = "sightline/lp_reference", sample_count = 5)]
fn lp_reference(bencher: Bencher<'_, '_>, scene: &str) {
    let corridors: Vec<_> = sequences(scene).into_iter().take(50).collect();
    for doors in &corridors {
        let open = matches!(stab(doors), LpAnswer::Open { .. });
        assert!(!open || PlanarCertificate::find(doors).is_none(), "{scene}: the program opens a blocked sequence");
    }
    let n = corridors.len();
    bencher.counter(ItemsCount::new(n)).bench_local(move || {
        corridors.iter().filter(|doors| matches!(stab(black_box(doors)), LpAnswer::Open { .. })).count()
    });
}
