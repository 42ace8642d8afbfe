//! Tables of scenes in space against rays: nothing that a ray was seen to hit is hidden.

use sightlines::bake::{BakedScene, PortalMode, SceneBakeOptions, bake_scene};
use sightlines::cells::Scene;
use sightlines::formats::scene::read_scene;
use sightlines::geometry::Aabb;
use sightlines::pvs::{CellId, ObjectId, Table};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_testkit::rays::RayScene;
use sightlines_tests::data_folder;
use sightlines_tests::scenes::scene_witness;

fn bake(scene: &Scene, portals: PortalMode, threads: usize) -> BakedScene {
    let options = SceneBakeOptions { portals, threads, ..SceneBakeOptions::default() };
    bake_scene(scene, &options).unwrap()
}

/// The objects that the table shows from the cells that a box overlaps.
fn shown(table: &Table, eye: &Aabb<3>) -> Vec<bool> {
    let mut shown = vec![false; table.objects().len()];
    for (cell, record) in (0u32..).map(CellId).zip(table.cells()) {
        if (0..3).all(|k| record.min[k] < eye.max[k] && eye.min[k] < record.max[k]) {
            for object in table.visible_objects(cell) {
                shown[object.idx()] = true;
            }
        }
    }
    shown
}

fn small_tower() -> Scene {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    tower(options).unwrap()
}

/// Invariant: what rays from a cell hit first, the cell sees; and what rays join, the table joins.
#[test]
fn rays_in_a_small_tower_are_in_the_table() {
    const RAYS: u64 = 3_000;
    let scene = small_tower();
    let table = bake(&scene, PortalMode::Exact, 0).table;
    let rays = RayScene::new(&scene);
    let mut n_seen = 0;
    for (cell, record) in (0u32..).map(CellId).zip(table.cells()).step_by(7) {
        let visible = table.visible_objects(cell);
        let bounds = Aabb { min: record.min, max: record.max };
        for object in rays.witness_objects(bounds, u64::from(cell.0), RAYS) {
            assert!(
                visible.binary_search(&ObjectId(object)).is_ok(),
                "cell {cell} sees {}",
                table.objects()[object as usize].name
            );
            n_seen += 1;
        }
    }
    assert!(n_seen > 100, "{n_seen} pairs seen");
    // Not everything is visible, or there would be nothing to test.
    let all = table.n_cells() * table.objects().len();
    let n_visible: usize = (0..table.n_cells() as u32).map(|c| table.visible_objects(CellId(c)).len()).sum();
    assert!(n_visible < all, "{n_visible} of {all}");
}

/// Invariant: rectangles around openings show at least what the exact openings show; a search of the exact openings that
/// starts from that bound finds the same answer; threads change nothing.
#[test]
fn portal_modes_are_nested() {
    let scene = small_tower();
    let exact = bake(&scene, PortalMode::Exact, 1).table;
    assert_eq!(exact.to_bytes(), bake(&scene, PortalMode::Exact, 2).table.to_bytes());
    let bounding = bake(&scene, PortalMode::Bounding, 1).table;
    assert_eq!(exact.n_cells(), bounding.n_cells());
    for cell in (0..exact.n_cells() as u32).map(CellId) {
        assert!(exact.visible(cell).all(|other| bounding.sees(cell, other)));
        let wide = bounding.visible_objects(cell);
        assert!(exact.visible_objects(cell).iter().all(|o| wide.binary_search(o).is_ok()));
    }
    assert_eq!(Table::from_bytes(&exact.to_bytes()), Ok(exact));
}

/// How much of a box the cells of a table cover, from 0 to 1.
fn covered(table: &Table, eye: &Aabb<3>) -> f64 {
    let volume = |min: [f64; 3], max: [f64; 3]| (0..3).map(|k| (max[k] - min[k]).max(0.0)).product::<f64>();
    let common = |c: &sightlines::pvs::CellRecord| {
        let min = std::array::from_fn(|k| c.min[k].max(eye.min[k]));
        let max = std::array::from_fn(|k| c.max[k].min(eye.max[k]));
        volume(min, max)
    };
    table.cells().iter().map(common).sum::<f64>() / volume(eye.min, eye.max)
}

/// Invariant: on a real building, what rays from places where people walk hit first is shown.
///
/// The places of the data folder reach into slabs and walls a little, where there are no cells and an eye sees nothing
/// that matters. So our own rays are shot from them, which leave such eyes out; and the ground truth of the data folder
/// is required where a place is all cells.
#[test]
fn a_real_building_shows_what_was_seen() {
    const RAYS: u64 = 4_000;
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    let folder = folder.join("scenes/whale_large");
    let scene = read_scene(folder.join("whale_large.glb")).unwrap_or_else(|e| panic!("{e}")).scene;
    let table = bake(&scene, PortalMode::Exact, 0).table;
    let rays = RayScene::new(&scene);
    let mut n_seen = 0;
    for (seed, witness) in (0..).zip(scene_witness(&folder)) {
        let eye = Aabb { min: witness.min, max: witness.max };
        let shown = shown(&table, &eye);
        // A sum of a few hundred products rounds by less than 2^-40; 2^-30 is far from both sides.
        let sampled = if covered(&table, &eye) > 1.0 - 2f64.powi(-30) { witness.objects } else { Vec::new() };
        for object in rays.witness_objects(eye, seed, RAYS).into_iter().chain(sampled) {
            assert!(shown[object as usize], "{} sees {}", witness.id, table.objects()[object as usize].name);
            n_seen += 1;
        }
    }
    assert!(n_seen > 50, "{n_seen} pairs seen");
}
