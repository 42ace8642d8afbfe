//! Simplified scenes against rays: by tables, in levels, and on real scenes.

use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::cells::{CellId, Scene};
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::formats::view_cells::read_view_cells;
use sightlines::geometry::{Aabb, Point3};
use sightlines::kdtree::SceneOptions;
use sightlines::multifocal::mesh::{SheetMethod, Sheets};
use sightlines::multifocal::{FromRegion, Volume};
use sightlines::pvs::Table;
use sightlines::scenes::{CityOptions, TowerOptions, city, tower, tower_rooms};
use sightlines::simplify::{
    HiddenBy, Level, LevelOptions, MeasureOptions, Simplified, SimplifyError, SimplifyOptions, Views, ViewsError,
    estimate, levels, measure, simplify,
};
use std::path::PathBuf;
use std::sync::Arc;

/// Two floors without furniture, their table, and where the rooms are.
fn small_tower() -> (Scene, Table, Vec<Aabb<3>>) {
    let options = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let scene = tower(options).unwrap();
    let table = bake_scene(&scene, &SceneBakeOptions::default()).unwrap().table;
    (scene, table, tower_rooms(options).unwrap().into_iter().map(|r| r.bounds).collect())
}

fn cells_in(table: &Table, b: &Aabb<3>) -> Vec<CellId> {
    let inside = |c: &CellId| b.contains(table.cells()[c.idx()].min) && b.contains(table.cells()[c.idx()].max);
    (0..table.n_cells() as u32).map(CellId).filter(inside).collect()
}

fn sheets(scene: &Scene) -> Arc<Sheets> {
    let triangles: Vec<[Point3; 3]> = scene.objects().iter().flat_map(|o| o.corners()).collect();
    Arc::new(Sheets::new(&triangles))
}

/// That no eye's share is above the promise, but for chance below one in a billion.
fn check(name: &str, scene: &Scene, left: &Simplified, views: &Views, options: &MeasureOptions) {
    let measured = measure(scene, left, views, options).unwrap();
    let hits = (measured.worst * options.n_rays as f64).round() as u64;
    let surely = estimate::interval(hits, options.n_rays, 1.0 - 1e-9 / options.n_eyes as f64).ends[0];
    assert!(surely <= left.bound, "{name}: {measured:?} {}", left.bound);
    if left.bound == 0.0 {
        assert_eq!(measured.changed, 0.0, "{name}: {measured:?}");
    }
}

#[test]
fn a_table_hides_what_the_multifocal_buffer_leaves() {
    let (scene, table, rooms) = small_tower();
    let sheets = sheets(&scene);
    let make = || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as Box<dyn FromRegion + Send>;
    for (k, room) in rooms.iter().enumerate().step_by(3) {
        let views = Views::of_cells(&table, &cells_in(&table, room)).unwrap();
        let ways = [
            HiddenBy { method: None, table: Some(&table) },
            HiddenBy { method: Some(&make), table: None },
            HiddenBy { method: Some(&make), table: Some(&table) },
        ];
        let left = ways.map(|by| simplify(&scene, &views, &by, &SimplifyOptions::default()).unwrap());
        let n = [0, 1, 2].map(|i| left[i].counts.left);
        assert!(n[2] <= n[0] && n[2] <= n[1] && n[2] * 3 < scene.n_triangles(), "room {k}: {n:?}");
        let options = MeasureOptions { n_eyes: 100, n_rays: 500, ..MeasureOptions::default() };
        left.iter().for_each(|left| check("no budget", &scene, left, &views, &options));
        let some = SimplifyOptions { flat: true, ..SimplifyOptions::default().with_budget(0.01) };
        let some = simplify(&scene, &views, &ways[2], &some).unwrap();
        assert!(some.counts.left < n[2], "room {k}: {:?}", some.counts);
        check("a hundredth", &scene, &some, &views, &MeasureOptions { n_eyes: 10, n_rays: 5000, ..options });
    }
}

#[test]
fn levels_are_for_all_cells_and_fit() {
    // Furniture cuts no cells, so that these are few.
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let scene = tower(options).unwrap();
    let cut = SceneOptions { detail_below: Some(1.5), ..SceneOptions::default() };
    let table = bake_scene(&scene, &SceneBakeOptions { cut, ..SceneBakeOptions::default() }).unwrap().table;
    let simplify = SimplifyOptions { n_parts: 1, n_rays: 1 << 11, depth: 2, ..SimplifyOptions::default() };
    let all = LevelOptions { simplify: simplify.with_budget(1e-3), ..LevelOptions::default() };
    let by = HiddenBy::default();
    let many = levels(&scene, &table, &by, &all).unwrap();
    assert!(many.levels.len() > 20, "{}", many.levels.len());
    let memory = many.n_bytes() / 5;
    let few = levels(&scene, &table, &by, &LevelOptions { memory, ..all }).unwrap();
    assert!(few.n_bytes() <= memory && few.levels.len() > 1 && few.levels.len() < many.levels.len());
    for made in [&many, &few] {
        assert_eq!(made.of_cell.len(), table.n_cells());
        for (cell, &level) in (0..).map(CellId).zip(&made.of_cell) {
            assert!(made.levels[level as usize].cells.binary_search(&cell).is_ok());
        }
        let n_cells: usize = made.levels.iter().map(|l| l.cells.len()).sum();
        assert_eq!(n_cells, table.n_cells());
        for level in made.levels.iter().step_by(made.levels.len().div_ceil(12)) {
            assert!(level.simplified.counts.left < scene.n_triangles() && level.simplified.bound <= 1e-3);
            let views = Views::of_cells(&table, &level.cells).unwrap();
            let options = MeasureOptions { n_eyes: 12, n_rays: 1000, ..MeasureOptions::default() };
            check("level", &scene, &level.simplified, &views, &options);
        }
    }
    // Each was made for its cells: elsewhere they show less than there is.
    let options = MeasureOptions { n_eyes: 12, n_rays: 1000, ..MeasureOptions::default() };
    let least = few.levels.iter().min_by_key(|l| l.simplified.counts.left).unwrap();
    let changes = |other: &Level| {
        let elsewhere = Views::of_cells(&table, &other.cells).unwrap();
        measure(&scene, &least.simplified, &elsewhere, &options).unwrap().changed
    };
    assert!(few.levels.iter().map(changes).fold(0.0, f64::max) > 0.01);
    // Merging faces leaves less, and what fits then is not merged with others.
    let flat = LevelOptions { simplify: SimplifyOptions { flat: true, ..all.simplify }, ..all };
    let merged = levels(&scene, &table, &by, &flat).unwrap();
    assert!(merged.n_bytes() < many.n_bytes());
    let exact = levels(&scene, &table, &by, &LevelOptions { memory: merged.n_bytes(), ..flat }).unwrap();
    assert_eq!(exact.levels.len(), merged.levels.len());
    let none = levels(&scene, &table, &by, &LevelOptions { memory: 1000, ..all }).unwrap_err();
    assert!(matches!(none, SimplifyError::Memory { asked: 1000, least } if least > 1000), "{none}");
    let threads = |threads| LevelOptions { simplify: SimplifyOptions { threads, ..all.simplify }, memory, ..all };
    assert_eq!(levels(&scene, &table, &by, &threads(3)).unwrap(), few);
}

#[test]
fn what_does_not_fit_is_refused() {
    let (scene, table, _) = small_tower();
    let other = city(CityOptions { blocks_x: 1, blocks_z: 1, ..CityOptions::default() }).unwrap();
    let views = Views::of_cells(&table, &[CellId(0)]).unwrap();
    let by = HiddenBy { method: None, table: Some(&table) };
    let error = simplify(&other, &views, &by, &SimplifyOptions::default()).unwrap_err();
    assert!(matches!(error, SimplifyError::OtherScene(_)), "{error}");
    let n_cells = table.n_cells();
    let none = CellId(n_cells as u32);
    assert_eq!(Views::of_cells(&table, &[none]).unwrap_err(), ViewsError::NoCell { cell: none.0, n_cells });
    assert_eq!(Views::of_cells(&table, &[]).unwrap_err(), ViewsError::None);
    assert_eq!(Views::new([]).unwrap_err(), ViewsError::None);
    // A table of the same scene that is cut otherwise.
    let cut = SceneOptions { detail_below: Some(100.0), ..SceneOptions::default() };
    let coarse = bake_scene(&scene, &SceneBakeOptions { cut, ..SceneBakeOptions::default() }).unwrap().table;
    let last = CellId(n_cells as u32 - 1);
    let views = Views::of_cells(&table, &[last]).unwrap();
    let by = HiddenBy { method: None, table: Some(&coarse) };
    let error = simplify(&scene, &views, &by, &SimplifyOptions::default()).unwrap_err();
    assert_eq!(error, SimplifyError::OtherTable { cell: last.0 });
}

fn real(scene: &str, file: &str) -> Option<PathBuf> {
    let data = std::env::var_os("SIGHTLINES_DATA");
    if data.is_none() {
        eprintln!("!! SKIPPED: SIGHTLINES_DATA is not set, so {scene} is not looked at");
    }
    Some(PathBuf::from(data?).join("scenes").join(scene).join(file))
}

/// A hundred eyes, and promises of all sizes, in real scenes.
#[test]
fn promises_are_kept_in_real_scenes() {
    for (name, cells) in [("sponza", "cells_walk"), ("duplex", "cells_rooms"), ("delft", "cells_street")] {
        let Some(path) = real(name, &format!("{name}.glb")) else { return };
        let scene = read_scene_with(path, &SceneReadOptions::with_backs(BackFaces::Drawn)).unwrap().scene;
        let cells = read_view_cells(real(name, &format!("{cells}.json")).unwrap()).unwrap().cells;
        let sheets = sheets(&scene);
        let make = || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as Box<dyn FromRegion + Send>;
        let by = HiddenBy { method: Some(&make), table: None };
        let views = Views::new([Volume::new(cells[cells.len() / 2].bounds).unwrap()]).unwrap();
        let mut left = vec![];
        for budget in [0.0, 1e-3, 1e-2] {
            let options = SimplifyOptions { n_parts: 2, depth: 3, n_rays: 1 << 14, ..SimplifyOptions::default() };
            let some = simplify(&scene, &views, &by, &options.with_budget(budget)).unwrap();
            let n_eyes = if budget == 0.0 { 100 } else { 10 };
            let options = MeasureOptions { n_eyes, n_rays: 20_000 / n_eyes as u64, ..MeasureOptions::default() };
            check(name, &scene, &some, &views, &options);
            left.push(some.counts.left);
        }
        assert!(left[2] < left[1] && left[1] < left[0] && left[0] < scene.n_triangles(), "{name}: {left:?}");
    }
}
