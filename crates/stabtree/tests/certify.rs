//! Proofs of whole tables against the searches that made the tables, on random plans and boxes: everything is proven, and
//! wrong rows are not.

mod boxes;

use boxes::{cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, CellGraph, Planar};
use sightlines_certificates::Proven;
use sightlines_certificates::plan::PlanProofs;
use sightlines_certificates::space::BoxProofs;
use sightlines_pvs::BitMatrix;
use sightlines_scenes::{OfficeOptions, office};
use sightlines_stabtree::{
    CertifyOptions, Known, SearchOptions, Zones, certify_plan, certify_space, plan_network, see_plan, see_space,
    space_network,
};
use sightlines_testkit::{axial_plan, small_grid_plan};

fn search() -> SearchOptions<'static> {
    SearchOptions { threads: 1, ..SearchOptions::default() }
}

fn rows_of_plan(graph: &CellGraph<Planar>) -> BitMatrix {
    see_plan(graph, &Zones::cells(graph), &search()).0
}

/// Proofs for these rows, through their bytes and the checker.
fn proven_plan(graph: &CellGraph<Planar>, rows: &BitMatrix, options: &CertifyOptions) -> Proven {
    let made = certify_plan(graph, rows, options).expect("the graph is good");
    let read = PlanProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    read.check(&plan_network(graph).expect("the graph is good")).expect("proofs hold")
}

fn proven_space(graph: &CellGraph<Axial>, rows: &BitMatrix) -> Proven {
    let made = certify_space(graph, rows, &CertifyOptions::default()).expect("the graph is good");
    let read = BoxProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    read.check(&space_network(graph).expect("the graph is good")).expect("proofs hold")
}

/// Asserts that exactly what rows say is proven; returns how many pairs are visible and hidden.
fn assert_proven(rows: &BitMatrix, proven: &Proven) -> [u64; 2] {
    for a in 0..rows.n_rows() as u32 {
        for b in 0..a {
            let sees = rows.get(a as usize, b as usize);
            assert_eq!((proven.visible.has(a, b), proven.hidden.has(a, b)), (sees, !sees), "cells {a} and {b}");
        }
    }
    [proven.visible.len(), proven.hidden.len()]
}

/// Asserts that nothing is proven that rows deny.
fn assert_nothing_wrong(rows: &BitMatrix, proven: &Proven) {
    for [a, b] in proven.visible.iter() {
        assert!(rows.get(a as usize, b as usize), "cells {a} and {b} are hidden");
    }
    for [a, b] in proven.hidden.iter() {
        assert!(!rows.get(a as usize, b as usize), "cells {a} and {b} see each other");
    }
}

fn cut_plan(plan: &sightlines_cells::Plan) -> Option<CellGraph<Planar>> {
    sightlines_triangulation::subdivide(plan).ok().map(|cut| cut.0)
}

proptest! {
    #[test]
    fn plans_are_proven_whole(plan in small_grid_plan(1..14)) {
        if let Some(graph) = cut_plan(&plan) {
            let rows = rows_of_plan(&graph);
            assert_proven(&rows, &proven_plan(&graph, &rows, &CertifyOptions::default()));
        }
    }

    #[test]
    fn axial_plans_are_proven_whole(plan in axial_plan(1..20)) {
        let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::Options::default());
        if let Ok(cut) = cut {
            let rows = rows_of_plan(&cut.graph);
            assert_proven(&rows, &proven_plan(&cut.graph, &rows, &CertifyOptions::default()));
        }
    }

    /// The impostor: rows with a pair that is wrong. That pair stays open, or its truth is proven; nothing wrong is.
    #[test]
    fn wrong_rows_of_plans_are_not_proven(plan in small_grid_plan(3..14), pick in any::<prop::sample::Index>()) {
        if let Some(graph) = cut_plan(&plan).filter(|graph| graph.n_cells() > 1) {
            let rows = rows_of_plan(&graph);
            let (a, b) = pair(pick, graph.n_cells());
            let wrong = flipped(&rows, a, b);
            let proven = proven_plan(&graph, &wrong, &CertifyOptions::default());
            assert_nothing_wrong(&rows, &proven);
            prop_assert!(!(proven.hidden.has(a, b) && rows.get(a as usize, b as usize)));
        }
    }

    #[test]
    fn boxes_are_proven_whole(
        faces in faces(9),
        objects in objects(),
        out in prop::collection::vec(prop::bool::weighted(0.25), 1..7),
    ) {
        let (graph, solid) = cut(&faces, &out);
        let seen = see_space(&graph, &solid, &objects, &Known::nothing(graph.n_cells()), &search());
        prop_assert_eq!(seen.n_assumed, 0);
        assert_proven(&seen.cells, &proven_space(&graph, &seen.cells));
    }

    #[test]
    fn wrong_rows_of_boxes_are_not_proven(
        faces in faces(9),
        out in prop::collection::vec(prop::bool::weighted(0.25), 1..7),
        pick in any::<prop::sample::Index>(),
    ) {
        let (graph, solid) = cut(&faces, &out);
        let seen = see_space(&graph, &solid, &[], &Known::nothing(graph.n_cells()), &search());
        if graph.n_cells() > 1 {
            let (a, b) = pair(pick, graph.n_cells());
            assert_nothing_wrong(&seen.cells, &proven_space(&graph, &flipped(&seen.cells, a, b)));
        }
    }
}

fn pair(pick: prop::sample::Index, n: usize) -> (u32, u32) {
    let k = pick.index(n * (n - 1));
    let (a, b) = (k / (n - 1), k % (n - 1));
    (a as u32, (b + usize::from(b >= a)) as u32)
}

fn flipped(rows: &BitMatrix, a: u32, b: u32) -> BitMatrix {
    let mut other = rows.clone();
    let bit = !rows.get(a as usize, b as usize);
    other.set(a as usize, b as usize, bit);
    other.set(b as usize, a as usize, bit);
    other
}

/// Tight and counted: an office where most is hidden.
#[test]
fn an_office_is_proven_whole() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 8, rooms_y: 4, ..OfficeOptions::default() }).unwrap();
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::Options::default()).unwrap();
    let rows = rows_of_plan(&cut.graph);
    let [visible, hidden] = assert_proven(&rows, &proven_plan(&cut.graph, &rows, &CertifyOptions::default()));
    assert!(visible > 100 && hidden > 400, "{visible} {hidden}");
}

/// Too little effort leaves pairs open, and says so; what is proven is still right.
#[test]
fn effort_has_a_limit() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 8, rooms_y: 4, ..OfficeOptions::default() }).unwrap();
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::Options::default()).unwrap();
    let rows = rows_of_plan(&cut.graph);
    let mut open = Vec::new();
    for most_steps in [0, 4, 16, 20_000_000] {
        let proven = proven_plan(&cut.graph, &rows, &CertifyOptions { most_steps, ..CertifyOptions::default() });
        assert_nothing_wrong(&rows, &proven);
        open.push(proven.n_open());
    }
    assert!(open.windows(2).all(|w| w[0] >= w[1]) && open[0] > open[2] && open[3] == 0, "{open:?}");
}

/// The same proofs, byte for byte, each time.
#[test]
fn proofs_are_the_same_each_time() {
    let plan = office(OfficeOptions { seed: 7, rooms_x: 6, rooms_y: 3, ..OfficeOptions::default() }).unwrap();
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::Options::default()).unwrap();
    let rows = rows_of_plan(&cut.graph);
    let made = || certify_plan(&cut.graph, &rows, &CertifyOptions::default()).unwrap().to_bytes();
    assert_eq!(made(), made());
}
