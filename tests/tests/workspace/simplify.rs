//! Simplified scenes against rays: by tables, in levels, and on real scenes.

use proptest::prelude::*;
use sightlines::bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::cells::{CellId, Scene, SceneObject};
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::formats::view_cells::read_view_cells;
use sightlines::geometry::{Aabb, Point3, Random};
use sightlines::kdtree::SceneOptions;
use sightlines::multifocal::mesh::{SheetMethod, Sheets};
use sightlines::multifocal::{FromRegion, Volume};
use sightlines::pvs::Table;
use sightlines::scenes::{CityOptions, TowerOptions, city, tower, tower_rooms};
use sightlines::simplify::{
    HiddenBy, Level, LevelOptions, MeasureOptions, Simplified, SimplifyError, SimplifyOptions, Views, ViewsError,
    estimate, levels, measure, simplify,
};
use sightlines_testkit::draw;
use sightlines_testkit::fronts::{Mixed, mixed};
use sightlines_testkit::meshes::boxes;
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

/// A scene of what hides from both sides, the first object, and of what hides from its front.
fn scene_of(mixed: &Mixed) -> Scene {
    let object = |soup: &[[Point3; 3]]| SceneObject {
        name: String::new(),
        vertices: soup.concat(),
        triangles: (0..soup.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
    };
    let scene = Scene::new(vec![object(&mixed.both_sides), object(&mixed.fronts)]).unwrap();
    scene.with_front_occluders(vec![1]).unwrap()
}

/// How many triangles are removed as hidden from a box of eyes, and one that a segment reaches past backs all the same.
///
/// * `occluders`: the scene that hides
fn removed(mixed: &Mixed, occluders: &Scene, eyes: &Aabb<3>, seed: u64) -> (usize, Option<String>) {
    let method = OcclusionMethod::ALL[seed as usize % OcclusionMethod::ALL.len()];
    let buffers = BufferOptions { planes: 3, texels: 32, ..BufferOptions::default() };
    let factory = OcclusionMethodFactory::new(method, occluders, &buffers).unwrap();
    let make = || factory.instance();
    let by = HiddenBy { method: Some(&make), table: None };
    let views = Views::new([Volume::new(*eyes).unwrap()]).unwrap();
    let left = simplify(&scene_of(mixed), &views, &by, &SimplifyOptions { threads: 1, ..SimplifyOptions::default() });
    let hidden = left.unwrap().hidden;
    let mut random = Random::new(seed);
    let mut wrong = None;
    for (object, k) in hidden.iter().enumerate().flat_map(|(object, all)| all.iter().map(move |&k| (object, k))) {
        let mut others = mixed.clone();
        let soup = if object == 0 { &mut others.both_sides } else { &mut others.fronts };
        let [a, b, c] = soup.remove(k as usize);
        // Parts of sixteenths, so that points of most triangles are exact.
        let part = |u: f64, v: f64| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * u + (c[i] - a[i]) * v);
        let inner = (1..15).flat_map(|i| (1..16 - i).map(move |j| part(f64::from(i) / 16.0, f64::from(j) / 16.0)));
        let free = inner.map(|p| [random.point(eyes), p]).find(|&segment| others.is_free(segment));
        wrong = wrong.or(free.map(|free| format!("{method:?} removes {:?}: {free:?}", [a, b, c])));
    }
    (hidden.concat().len(), wrong)
}

proptest! {
    /// Invariant: no segment that passes triangles with one side from behind only reaches a triangle that is removed as hidden.
    #[test]
    fn nothing_that_is_seen_past_backs_is_removed(mixed in mixed(), [eyes, _] in boxes(), seed in any::<u64>()) {
        let (_, wrong) = removed(&mixed, &scene_of(&mixed), &eyes, seed);
        prop_assert!(wrong.is_none(), "{wrong:?}");
    }
}

/// The twin: what hides from its front removes triangles that the rest does not; and the impostor: what hides from both sides removes some that
/// are seen past backs.
#[test]
fn triangles_behind_fronts_are_removed() {
    let [mut n_with, mut n_without, mut n_wrong] = [0; 3];
    for (seed, (mixed, [eyes, _])) in (0..).zip(draw(&(mixed(), boxes()), 150)) {
        let scene = scene_of(&mixed);
        let both_sides = Scene::new(scene.objects().to_vec()).unwrap();
        n_with += removed(&mixed, &scene, &eyes, seed).0;
        n_without += removed(&mixed, &scene.opaque_part(), &eyes, seed).0;
        n_wrong += usize::from(removed(&mixed, &both_sides, &eyes, seed).1.is_some());
    }
    assert!(n_with > n_without * 3 / 2 && n_wrong > 20, "{n_with} {n_without} {n_wrong}");
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
