//! The older methods against the exact ones: what errs towards visible hides nothing, what samples invents nothing, and
//! both find something.

use super::*;
use proptest::prelude::*;
use sightlines::bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines::cells::Plan;
use sightlines::geometry::Aabb;
use sightlines::kdtree::{SceneOptions, subdivide_scene};
use sightlines::pvs::BitMatrix;
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, maze, office, tower};
use sightlines::stabtree::{ConvexOptions, ConvexSearch, SearchOptions, Zones, planar_visibility};
use sightlines_testkit::Random;
use sightlines_testkit::small_grid_plan;
use std::time::Duration;

/// Pairs of `a` that are not in `b`.
fn n_only(a: &BitMatrix, b: &BitMatrix) -> u64 {
    let rows = (0..a.n_rows()).flat_map(|i| a.row(i).iter().zip(b.row(i)));
    rows.map(|(a, b)| u64::from((a & !b).count_ones())).sum()
}

fn exact_planar(graph: &CellGraph<Planar>) -> BitMatrix {
    planar_visibility(graph, &Zones::cells(graph), &SearchOptions { threads: 1, ..SearchOptions::default() })
        .expect("nobody cancels")
        .0
}

/// Checks sampled ⊆ exact ⊆ shadows ⊆ connected.
fn check<O: Opening>(graph: &PortalGraph<O>, exact: &BitMatrix, n_rays: u64) -> Result<[u64; 4], TestCaseError> {
    let (few, all) = (sampled(graph, n_rays, 7), connected(graph));
    let shadows = shadow_volumes(graph, Duration::MAX).expect("there is time enough");
    prop_assert_eq!(n_only(&few, exact), 0, "rays see what is visible only");
    prop_assert_eq!(n_only(exact, &shadows), 0, "shadow volumes hide nothing that is visible");
    prop_assert_eq!(n_only(&shadows, &all), 0, "only reachable cells are visible");
    Ok([&few, exact, &shadows, &all].map(|m| m.count_ones() - m.n_rows() as u64))
}

proptest! {
    #[test]
    fn plans_are_within_their_bounds(plan in small_grid_plan(2..14)) {
        if let Ok((graph, _)) = sightlines::triangulation::subdivide(&plan) {
            check(&planar_portal_graph(&graph), &exact_planar(&graph), 16)?;
        }
    }
}

fn graph(plan: &Plan) -> CellGraph<Planar> {
    sightlines::triangulation::subdivide(plan).unwrap().0
}

#[test]
fn each_method_finds_something_in_plans() {
    let plans =
        [maze(1, 8, 8).unwrap(), office(OfficeOptions { rooms_x: 3, rooms_y: 3, ..OfficeOptions::default() }).unwrap()];
    let mut all_few = [0; 2];
    for plan in plans {
        let graph = graph(&plan);
        let [few, exact, shadows, all] = check(&planar_portal_graph(&graph), &exact_planar(&graph), 100).unwrap();
        assert!(few * 2 > exact, "rays find much: {few} of {exact}");
        assert!(shadows < exact * 4 && shadows < all, "shadows hide much: {shadows}, {exact} of {all}");
        all_few = [all_few[0] + few, all_few[1] + exact];
    }
    assert!(all_few[0] < all_few[1], "rays miss something: {all_few:?}");
}

#[test]
fn each_method_finds_something_among_boxes() {
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 2, furniture: 0, ..TowerOptions::default() }).unwrap();
    let cut = subdivide_scene(&scene, &SceneOptions::default()).unwrap();
    let options = SceneBakeOptions { portals: PortalMode::Exact, threads: 1, ..SceneBakeOptions::default() };
    let exact = bake_scene(&scene, &options).unwrap().table.parts().rows.clone();
    let [few, exact, shadows, all] = check(&axial_portal_graph(&cut.graph), &exact, 200).unwrap();
    assert!(few * 4 > exact && few < exact && shadows < all, "{few} {exact} {shadows} {all}");
}

#[test]
fn each_method_finds_something_in_worlds() {
    let world = quake_like(QuakeLikeOptions { seed: 1, rooms_x: 2, rooms_y: 2, floors: 1 }).unwrap();
    let mut search = ConvexSearch::new(&world.graph, ConvexOptions { fast: false, threads: 1 });
    while search.advance() {}
    let exact = search.finish().cells;
    let [few, exact, shadows, all] = check(&convex_portal_graph(&world.graph), &exact, 200).unwrap();
    assert!(few * 4 > exact && few < exact && shadows < all, "{few} {exact} {shadows} {all}");
}

#[test]
fn spoilt_answers_are_noticed() {
    let graph = graph(&maze(2, 5, 5).unwrap());
    let (portals, exact) = (planar_portal_graph(&graph), exact_planar(&graph));
    let mut more = exact.clone();
    let [a, b] = (0..more.n_rows()).flat_map(|a| (0..a).map(move |b| [a, b])).find(|&[a, b]| !exact.get(a, b)).unwrap();
    more.set(a, b, true);
    // Were that pair visible, shadows or rays would have to say so.
    assert!(check(&portals, &exact, 50).is_ok());
    assert_eq!(n_only(&more, &exact), 1);
    let full = connected(&portals);
    assert!(check(&portals, &full, 50).is_err(), "who calls everything visible hides by shadows");
}

#[test]
fn trees_of_boxes_agree_with_asking_every_box() {
    let mut random = Random::new(3, 0);
    let cube = |at: f64| Aabb { min: [at; 3], max: [at + 0.0; 3] };
    let mut n_found = 0;
    for round in 0..40 {
        let space = Aabb { min: [0.0; 3], max: [10.0; 3] };
        let any = |random: &mut Random| {
            let (p, size) = (random.point(&space), random.unit() * if round % 2 == 0 { 1.0 } else { 5.0 });
            Aabb { min: p, max: p.map(|x| x + size) }
        };
        let boxes: Vec<Aabb<3>> = (0..60).map(|_| any(&mut random)).collect();
        let probe = any(&mut random);
        let meets = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= probe.max[k] && probe.min[k] <= b.max[k]);
        let expected: Vec<u32> = (0u32..).zip(&boxes).filter(|(_, b)| meets(b)).map(|(i, _)| i).collect();
        let mut found = [Vec::new(), Vec::new()];
        BoxTreeN::<2>::build(boxes.clone()).cull(meets, &mut found[0]);
        BoxTreeN::<3>::build(boxes).cull(meets, &mut found[1]);
        for mut found in found {
            found.sort_unstable();
            assert_eq!(found, expected);
            n_found += found.len();
        }
    }
    assert!(n_found > 100, "{n_found} boxes");
    // Boxes on top of each other end somewhere.
    let mut found = Vec::new();
    BoxTreeN::<3>::build(vec![cube(1.0); 50]).cull(|_| true, &mut found);
    assert_eq!(found.len(), 50);
    BoxTreeN::<3>::build(Vec::new()).cull(|_| true, &mut found);
    assert_eq!(found.len(), 50);
}
