//! Columns and horizons against the search without them, on storeys one above the other, where both matter.

use crate::boxes::cut_box;
use proptest::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{AxialFace, SceneOptions, subdivide_scene};
use sightlines_scenes::{TowerOptions, tower};
use sightlines_sightline::ShaftCounters;
use sightlines_stabtree::{AxialVisibility, LiveAxial, SearchOptions, axial_visibility};
use std::cell::Cell;

/// Storeys of random buildings: enough for columns.
const STOREYS: usize = 12;

/// Tiles of a storey along x.
const TILES: usize = 3;

fn options() -> SearchOptions<'static> {
    SearchOptions { threads: 1, ..SearchOptions::default() }
}

fn with_columns(graph: &CellGraph<Axial>, solid: &[Aabb<3>], objects: &[Aabb<3>], threads: usize) -> AxialVisibility {
    let options = SearchOptions { threads, ..options() };
    axial_visibility(graph, solid, &[], objects, &options).expect("nobody cancels")
}

/// The search that keeps its lines for updates uses neither columns nor horizons.
fn without(graph: &CellGraph<Axial>, solid: &[Aabb<3>], objects: &[Aabb<3>]) -> AxialVisibility {
    let live = LiveAxial::new(graph.clone(), solid, objects.to_vec(), &options()).expect("nobody cancels");
    live.seen().clone()
}

/// Slabs with holes and walls beside a well, from one number for each tile of each storey.
fn building(choices: &[u8]) -> Vec<AxialFace<3>> {
    let mut faces = Vec::new();
    for (i, &choice) in choices.iter().enumerate() {
        let (storey, tile) = ((i / TILES) as f64, (i % TILES) as f64);
        // Slabs are rare in the middle, where the well is, and holes are rare beside it.
        let is_closed = if i % TILES == 1 { choice % 8 == 0 } else { choice % 8 != 0 };
        if is_closed && storey > 0.0 {
            faces.push(AxialFace::new(1, [tile, storey, 0.0], [tile + 1.0, storey, 2.0]));
        }
        // A wall at the side of a tile: none, half as high, or half as deep.
        let end = match choice / 8 % 4 {
            0 => Some([storey + 0.5, 2.0]),
            1 => Some([storey + 1.0, 1.0]),
            _ => None,
        };
        if let Some([high, deep]) = end.filter(|_| tile > 0.0) {
            faces.push(AxialFace::new(0, [tile, storey, 0.0], [tile, high, deep]));
        }
    }
    faces
}

fn bounds() -> Aabb<3> {
    Aabb { min: [0.0; 3], max: [TILES as f64, STOREYS as f64, 2.0] }
}

/// Invariant: columns and horizons change no answer about random storeys around a well, for cells, objects, and any number of
/// threads; they do decide pairs there; and no line from cell to cell past all walls is denied.
#[test]
fn columns_change_no_answer() {
    let [seen, hidden, saved, rays] = [(); 4].map(|()| Cell::new(0u64));
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let strategy = (prop::collection::vec(any::<u8>(), STOREYS * TILES), any::<u64>());
    let result = runner.run(&strategy, |(choices, seed)| {
        let faces = building(&choices);
        let (graph, _) = cut_box(&faces, bounds(), &[false]);
        let objects: Vec<Aabb<3>> =
            (0..STOREYS).map(|k| Aabb { min: [1.25, k as f64, 0.5], max: [1.5, k as f64 + 0.5, 1.0] }).collect();
        let expected = without(&graph, &[], &objects);
        for threads in [1, 2] {
            let found = with_columns(&graph, &[], &objects, threads);
            prop_assert_eq!(&found.cells, &expected.cells);
            prop_assert_eq!(&found.objects, &expected.objects);
            saved.set(saved.get() + u64::from(found.counters.n_asked != expected.counters.n_asked));
        }
        rays.set(rays.get() + free_rays(&graph, &faces, seed, &expected)?);
        let ones = expected.cells.count_ones();
        seen.set(seen.get() + ones);
        hidden.set(hidden.get() + (graph.n_cells() as u64).pow(2) - ones);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("columns_change_no_answer: {e}"));
    assert!(seen.get() > cases && hidden.get() > cases, "{} seen, {} hidden", seen.get(), hidden.get());
    assert!(saved.get() > cases / 4 && rays.get() > cases, "{} differ in work, {} rays", saved.get(), rays.get());
}

/// Shoots segments between points of cells; those that meet no wall have to join cells that see each other. Returns how many
/// were free.
fn free_rays(
    graph: &CellGraph<Axial>,
    faces: &[AxialFace<3>],
    seed: u64,
    seen: &AxialVisibility,
) -> Result<u64, TestCaseError> {
    let mut random = sightlines_testkit::Random::new(seed, 0);
    let mut n = 0;
    for _ in 0..200 {
        let cells = [(); 2].map(|()| random.below(graph.n_cells()));
        let [p, q] = cells.map(|cell| random.point(&graph.cells()[cell].bounds));
        let meets = |face: &AxialFace<3>| {
            let at = (face.at - p[face.axis]) / (q[face.axis] - p[face.axis]);
            let beside = |k: usize| {
                let x = p[k] + at * (q[k] - p[k]);
                x < face.min[k] - 1e-9 || x > face.max[k] + 1e-9
            };
            (0.0..=1.0).contains(&at) && !(0..3).any(|k| k != face.axis && beside(k))
        };
        if !faces.iter().any(meets) {
            n += 1;
            prop_assert!(seen.cells.get(cells[0], cells[1]), "a ray from {:?} to {:?} is free", p, q);
        }
    }
    Ok(n)
}

/// The queries about the cells of an unfurnished tower without windows, with columns and without; the answers are the same.
fn queries(floors: u32) -> [ShaftCounters; 2] {
    let options = TowerOptions { floors, rooms_y: 3, furniture: 0, windows: false, ..TowerOptions::default() };
    let scene = tower(options).expect("such a tower exists");
    let cut = subdivide_scene(&scene, &SceneOptions::default()).expect("the scene is good");
    let solid = cut.left_out();
    let (found, expected) = (with_columns(&cut.graph, &solid, &[], 1), without(&cut.graph, &solid, &[]));
    assert_eq!(found.cells, expected.cells, "{floors} floors");
    [found.counters, expected.counters]
}

/// Invariant: from 16 to 32 floors, which have twice as many cells, the queries with columns and horizons grow by less than
/// floors^1.15. The impostor is the search without them.
#[test]
fn queries_grow_little_more_than_floors() {
    let (low, high) = (queries(16), queries(32));
    let exponent = |k: usize| (high[k].n_asked as f64 / low[k].n_asked as f64).log2();
    assert!(exponent(0) < 1.15, "floors^{:.2}", exponent(0));
    assert!(exponent(1) > 1.2, "floors^{:.2} without columns", exponent(1));
    assert!(high[0].n_programs < high[1].n_programs, "{high:?}");
}
