//! Proofs of whole tables against the searches that made the tables, on random plans, boxes and convex worlds:
//! everything is proven, except wrong rows.

use crate::boxes::{cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, CellGraph, Convex, Planar};
use sightlines_certificates::Proven;
use sightlines_certificates::axial::AxialProofs;
use sightlines_certificates::convex::ConvexProofs;
use sightlines_certificates::planar::PlanarProofs;
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, ObjectId};
use sightlines_scenes::world::{
    BspWorldOptions, QuakeLikeOptions, World, bsp_world, corridor, quake_like, world_families,
};
use sightlines_scenes::{OfficeOptions, office};
use sightlines_stabtree::{
    CertifyOptions, ConvexOptions, ConvexSearch, ConvexVisibility, ObjectRows, SearchOptions, Zones, axial_network,
    axial_visibility, certify_axial, certify_convex, certify_planar, convex_network, planar_network, planar_visibility,
};
use sightlines_testkit::convex::seen_by_rays;
use sightlines_testkit::{axial_plan, small_grid_plan};

fn search() -> SearchOptions<'static> {
    SearchOptions { threads: 1, ..SearchOptions::default() }
}

fn rows_of_plan(graph: &CellGraph<Planar>) -> BitMatrix {
    planar_visibility(graph, &Zones::cells(graph), &search()).expect("nobody cancels").0
}

/// Proofs for these rows, through their bytes and the checker.
fn proven_plan(graph: &CellGraph<Planar>, rows: &BitMatrix, options: &CertifyOptions<'_>) -> Proven {
    let made = certify_planar(graph, rows, options).expect("the graph is good");
    let read = PlanarProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    read.check(&planar_network(graph).expect("the graph is good")).expect("proofs hold")
}

fn proven_space(graph: &CellGraph<Axial>, rows: &BitMatrix) -> Proven {
    let made = certify_axial(graph, rows, None, &CertifyOptions::default()).expect("the graph is good");
    let read = AxialProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    read.check(&axial_network(graph).expect("the graph is good")).expect("proofs hold")
}

/// The same with objects, of which cells see those in `rows_of_objects`.
fn proven_objects(
    graph: &CellGraph<Axial>,
    rows: &BitMatrix,
    objects: &[Aabb<3>],
    rows_of_objects: &BitMatrix,
) -> Proven {
    let of = |cell| rows_of_objects.iter_ones(cell).map(|object| ObjectId(object as u32)).collect();
    let seen: Vec<Vec<ObjectId>> = (0..graph.n_cells()).map(of).collect();
    let objects = ObjectRows { boxes: objects, seen: &seen };
    let made = certify_axial(graph, rows, Some(objects), &CertifyOptions::default()).expect("the graph is good");
    let read = AxialProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    let boxes: Vec<_> = objects.boxes.iter().map(|b| [b.min, b.max]).collect();
    read.check(&axial_network(graph).expect("the graph is good").with_objects(&boxes)).expect("proofs hold")
}

/// Asserts that exactly the content of `rows` is proven; returns how many pairs are visible and hidden.
fn assert_proven(rows: &BitMatrix, proven: &Proven) -> [u64; 2] {
    for a in 0..rows.n_rows() as u32 {
        for b in 0..a {
            let sees = rows.get(a as usize, b as usize);
            assert_eq!((proven.visible.has(a, b), proven.hidden.has(a, b)), (sees, !sees), "cells {a} and {b}");
        }
    }
    [proven.visible.len(), proven.hidden.len()]
}

/// Asserts that nothing is proven that contradicts `rows`.
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
        let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::KdOptions::default());
        if let Ok(cut) = cut {
            let rows = rows_of_plan(&cut.graph);
            assert_proven(&rows, &proven_plan(&cut.graph, &rows, &CertifyOptions::default()));
        }
    }

    /// The impostor: rows with one wrong pair. That pair stays open, or its truth is proven; nothing wrong is.
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
        let seen = axial_visibility(&graph, &solid, &[], &objects, &search()).expect("nobody cancels");
        prop_assert_eq!(seen.n_assumed, 0);
        let proven = proven_objects(&graph, &seen.cells, &objects, &seen.objects);
        assert_proven(&seen.cells, &proven);
        for (cell, object) in (0..graph.n_cells()).flat_map(|cell| (0..objects.len()).map(move |object| (cell, object))) {
            let is_hidden = !seen.objects.get(cell, object);
            let is_proven = proven.hidden_objects.has(cell as u32, object as u32);
            prop_assert!(is_hidden || !is_proven, "cell {} and object {}", cell, object);
            // No open set of lines leads to an object without a surface, so of that there need not be a proof.
            let has_surface = (0..3).filter(|&k| objects[object].min[k] < objects[object].max[k]).count() > 1;
            prop_assert!(is_proven || !is_hidden || !has_surface, "cell {} and object {}", cell, object);
        }
    }

    /// The impostor: rows in which cells see no object, not even those that they touch. Nothing is proven of one that is seen.
    #[test]
    fn wrong_rows_of_objects_are_not_proven(
        faces in faces(9),
        objects in objects(),
        out in prop::collection::vec(prop::bool::weighted(0.25), 1..7),
    ) {
        let (graph, solid) = cut(&faces, &out);
        let seen = axial_visibility(&graph, &solid, &[], &objects, &search()).expect("nobody cancels");
        let none = BitMatrix::new(graph.n_cells(), objects.len());
        let proven = proven_objects(&graph, &seen.cells, &objects, &none);
        for (cell, object) in (0..graph.n_cells()).flat_map(|cell| (0..objects.len()).map(move |object| (cell, object))) {
            let is_proven = proven.hidden_objects.has(cell as u32, object as u32);
            prop_assert!(!(is_proven && seen.objects.get(cell, object)), "cell {} and object {}", cell, object);
        }
    }

    #[test]
    fn wrong_rows_of_boxes_are_not_proven(
        faces in faces(9),
        out in prop::collection::vec(prop::bool::weighted(0.25), 1..7),
        pick in any::<prop::sample::Index>(),
    ) {
        let (graph, solid) = cut(&faces, &out);
        let seen = axial_visibility(&graph, &solid, &[], &[], &search()).expect("nobody cancels");
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

/// Tight and counted: an office where most pairs are hidden.
#[test]
fn an_office_is_proven_whole() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 8, rooms_y: 4, ..OfficeOptions::default() }).unwrap();
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::KdOptions::default()).unwrap();
    let rows = rows_of_plan(&cut.graph);
    let [visible, hidden] = assert_proven(&rows, &proven_plan(&cut.graph, &rows, &CertifyOptions::default()));
    assert!(visible > 100 && hidden > 400, "{visible} {hidden}");
}

/// Too little effort leaves pairs open, and reports them; what is proven is still right.
#[test]
fn effort_has_a_limit() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 8, rooms_y: 4, ..OfficeOptions::default() }).unwrap();
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::KdOptions::default()).unwrap();
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
    let cut = sightlines_kdtree::subdivide_plan(&plan, &sightlines_kdtree::KdOptions::default()).unwrap();
    let rows = rows_of_plan(&cut.graph);
    let made = || certify_planar(&cut.graph, &rows, &CertifyOptions::default()).unwrap().to_bytes();
    assert_eq!(made(), made());
}

fn searched(graph: &CellGraph<Convex>) -> ConvexVisibility {
    let mut search = ConvexSearch::new(graph, ConvexOptions { threads: 1, ..ConvexOptions::default() });
    while search.advance() {}
    search.finish()
}

fn proven_convex(graph: &CellGraph<Convex>, rows: &BitMatrix, options: &CertifyOptions<'_>) -> Proven {
    let made = certify_convex(graph, rows, options).expect("the graph is good");
    let read = ConvexProofs::from_bytes(&made.to_bytes()).expect("what was written is read");
    assert_eq!(read, made);
    read.check(&convex_network(graph).expect("the graph is good")).expect("proofs hold")
}

/// Asserts that all pairs are proven as the search decided them, except those that it could not decide, which may be
/// proven hidden or left open; returns how many are visible, hidden and undecided.
fn assert_world_is_proven(name: &str, graph: &CellGraph<Convex>) -> [u64; 3] {
    let seen = searched(graph);
    let proven = proven_convex(graph, &seen.cells, &CertifyOptions::default());
    for a in 0..graph.n_cells() as u32 {
        for b in a + 1..graph.n_cells() as u32 {
            let sees = seen.cells.get(a as usize, b as usize);
            let found = (proven.visible.has(a, b), proven.hidden.has(a, b));
            let is_open = found == (false, false) && seen.undecided.contains(&[a, b]);
            assert!(found == (sees, !sees) || is_open, "{name}: cells {a} and {b}: {sees} {found:?}");
        }
    }
    [proven.visible.len(), proven.hidden.len(), proven.n_open()]
}

fn leafs(seed: u64, tilted_percent: u32) -> World {
    bsp_world(BspWorldOptions { seed, leafs: 30, solid_percent: 45, tilted_percent })
        .expect("options within their ranges")
}

/// Tight and sound: everything that is decided is proven, as the search decided it.
#[test]
fn worlds_are_proven_whole() {
    let mut sum = [0; 3];
    let mut add = |name: &str, world: &World| {
        let counts = assert_world_is_proven(name, &world.graph);
        sum.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
    };
    for (name, world) in world_families() {
        add(name, &world);
    }
    for seed in 0..4 {
        add("tilted", &leafs(seed, 60));
        add("axial", &leafs(seed, 0));
        add("far", &leafs(seed, 60).moved([1e6, -1e6, 1e6]));
        add("noise", &leafs(seed, 60).jittered(seed, 1e-13));
    }
    for k in 1..3 {
        let options = QuakeLikeOptions { seed: 1, rooms_x: k, rooms_y: k, floors: k };
        add("level", &quake_like(options).expect("few rooms"));
    }
    assert!(sum[0] > 4000 && sum[1] > 4000 && sum[2] * 100 < sum[0], "{sum:?}");
}

/// Lines shot through solid leafs follow no portals: what they prove visible is never proven hidden.
#[test]
fn nothing_that_lines_show_is_proven_hidden() {
    let mut n_seen = 0;
    for seed in 0..4 {
        let world = leafs(seed, 60);
        // Rows that hide everything: the prover attempts every pair.
        let rows = BitMatrix::identity(world.graph.n_cells());
        let proven = proven_convex(&world.graph, &rows, &CertifyOptions::default());
        for [a, b] in seen_by_rays(&world, 2000, seed).pairs {
            assert!(!proven.hidden.has(a, b), "seed {seed}: {a} {b}");
            n_seen += 1;
        }
    }
    assert!(n_seen > 200, "{n_seen}");
}

/// The impostors: rows with one wrong pair, each in turn. That pair stays open, or its truth is proven; nothing wrong
/// is.
#[test]
fn wrong_rows_of_worlds_are_not_proven() {
    let bent = corridor(9, [1, 2], 7).expect("a short corridor");
    for graph in [&bent.graph, &leafs(3, 60).graph] {
        let rows = searched(graph).cells;
        let n = graph.n_cells();
        for k in (0..n * (n - 1)).step_by(n * (n - 1) / 24 + 1) {
            let (a, b) = ((k / (n - 1)) as u32, (k % (n - 1) + usize::from(k % (n - 1) >= k / (n - 1))) as u32);
            let proven = proven_convex(graph, &flipped(&rows, a, b), &CertifyOptions::default());
            assert_nothing_wrong(&rows, &proven);
        }
    }
}

/// Too little effort leaves pairs open, and what is proven is still right; the same effort gives the same bytes.
#[test]
fn effort_for_worlds_has_a_limit() {
    let level = quake_like(QuakeLikeOptions { seed: 1, rooms_x: 2, rooms_y: 2, floors: 1 }).expect("few rooms");
    let rows = searched(&level.graph).cells;
    let mut open = Vec::new();
    for most_steps in [0, 4000, 20_000_000] {
        let options = CertifyOptions { most_steps, ..CertifyOptions::default() };
        let proven = proven_convex(&level.graph, &rows, &options);
        assert_nothing_wrong(&rows, &proven);
        open.push(proven.n_open());
        let made = || certify_convex(&level.graph, &rows, &options).expect("the graph is good").to_bytes();
        assert_eq!(made(), made());
    }
    assert!(open[0] > open[1] && open[1] > open[2] && open[2] == 0, "{open:?}");
}
