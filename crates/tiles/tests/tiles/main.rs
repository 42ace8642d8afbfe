//! A baked world: what is seen across tiles, and walking through it.

use serde_json::json;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::world::{WorldBake, WorldBakeError, WorldRun, world_files};
use sightlines_bake::{BakeRequest, SceneMethod};
use sightlines_formats::scene::{SceneReadOptions, write_glb};
use sightlines_geometry::{Aabb, Random};
use sightlines_pvs::CellId;
use sightlines_scenes::{CityOptions, city_tiles};
use sightlines_tiles::{
    INDEX_NAME, Seen, TileEntry, TileId, TilePlan, TileScratch, TileTables, TileWalk, TileWalkOptions, TiledWorld,
    WorldError, WorldIndex, WorldPlan,
};
use sightlines_walkthrough::AnswerKind;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Blocks along each side, each a tile.
const N: u32 = 5;

/// A world in a folder, baked once.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        bake(folder.path());
        folder
    });
    FOLDER.get().unwrap().path()
}

/// Bakes into a folder, from a plan and scenes in it.
fn bake(folder: &Path) {
    let mut plan = WorldPlan { border: 20.0, reach: None, tiles: Vec::new() };
    for tile in city_tiles(CityOptions { blocks_x: N, blocks_z: N, ..CityOptions::default() }, 1).unwrap() {
        let [scene, cells] = ["glb", "json"].map(|end| format!("{}.{end}", tile.name));
        fs::write(folder.join(&scene), write_glb(&tile.scene).unwrap()).unwrap();
        let boxes = tile.cells.iter().enumerate().step_by(7);
        let boxes = boxes.map(|(k, b)| json!({"id": k.to_string(), "min": b.min, "max": b.max}));
        fs::write(folder.join(&cells), json!({"cells": boxes.collect::<Vec<_>>()}).to_string()).unwrap();
        plan.tiles.push(TilePlan { name: tile.name, scene, at: [0.0; 3], viewers: None, cells: Some(cells) });
    }
    let path = folder.join("plan.json");
    fs::write(&path, plan.to_json()).unwrap();
    let request =
        BakeRequest { method: Some(SceneMethod::FromRegion(OcclusionMethod::Shafts)), ..BakeRequest::default() };
    let (run, reading, files) = (WorldRun::default(), SceneReadOptions::default(), world_files(&path).unwrap());
    assert_eq!(files.len(), 1 + 2 * plan.tiles.len());
    let read = |files| WorldBake::read((&path, files), (&request, &reading), ("1", 1), &run.runtime);
    assert!(matches!(read(&files[1..]), Err(WorldBakeError::Changed(_))));
    let bake = read(&files).unwrap();
    assert_eq!(bake.n_missing(folder), plan.tiles.len());
    let report = bake.run(folder, &run).unwrap();
    assert_eq!((report.n_baked, report.n_tiles, bake.n_missing(folder)), (plan.tiles.len(), plan.tiles.len(), 0));
    // Nothing is to be done once more, but for what is taken away.
    let far = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    fs::remove_file(far.into_iter().find(|path| path.extension().is_some_and(|end| end == "far")).unwrap()).unwrap();
    let again = bake.run(folder, &run).unwrap();
    assert_eq!((again.n_baked, again.n_far_only, again.n_bytes), (0, 1, report.n_bytes));
}

/// What an eye sees, by a loop over all tiles and all of their cells; none if it is in none.
fn by_loops(world: &TiledWorld, eye: [f64; 3]) -> Option<Seen> {
    let (mut seen, mut scratch, mut is_inside) = (Seen::default(), TileScratch::default(), false);
    for tile in world.tiles() {
        let tables = TileTables::load(world, tile, 0).unwrap();
        for cell in (0..tables.table().n_cells() as u32).map(CellId) {
            let (min, max) = tables.table().cell_box(cell).unwrap();
            if (Aabb { min, max }).contains(eye) {
                is_inside = true;
                tables.see_from(cell, &mut seen, &mut scratch).unwrap();
            }
        }
    }
    seen.sort();
    is_inside.then_some(seen)
}

#[test]
fn a_walk_sees_what_the_tables_say() {
    let world = Arc::new(TiledWorld::open(folder()).unwrap());
    let options = TileWalkOptions { has_thread: false, ..TileWalkOptions::default() };
    let mut walk = TileWalk::new(Arc::clone(&world), options);
    let mut random = Random::new(7);
    let [mut n_inside, mut n_outside] = [0, 0];
    let mut distinct: BTreeSet<usize> = BTreeSet::new();
    for _ in 0..120 {
        // Some eyes are on borders of cells.
        let mut eye = random.point(&Aabb { min: [0.0, 1.0, 0.0], max: [270.0, 2.5, 270.0] });
        if random.unit() < 0.5 {
            eye = [(eye[0] / 4.0).round() * 4.0, eye[1], eye[2]];
        }
        let expected = by_loops(&world, eye);
        let frame = walk.frame(eye);
        match expected {
            Some(expected) => {
                assert_eq!((frame.answer, frame.seen), (AnswerKind::Full, &expected), "{eye:?}");
                distinct.insert(expected.objects.len());
                assert!(expected.tiles.len() < world.index().tiles.len());
                n_inside += 1;
            }
            None => {
                assert_eq!((frame.answer, frame.seen.tiles.len()), (AnswerKind::Outside, 25), "{eye:?}");
                n_outside += 1;
            }
        }
        assert!(walk.take_error().is_none());
    }
    assert!(n_inside >= 5 && n_outside >= 5 && distinct.len() > 3, "{n_inside} {n_outside} {distinct:?}");
}

/// With a thread a frame never waits: until the tile has arrived, all of the world is seen.
#[test]
fn a_frame_does_not_wait_for_a_tile() {
    let world = Arc::new(TiledWorld::open(folder()).unwrap());
    let mut walk = TileWalk::new(Arc::clone(&world), TileWalkOptions { budget: 1, ..TileWalkOptions::default() });
    let eye = world.index().tiles[12].bounds.viewers;
    let eye = [eye.min[0] + 0.5, 1.7, eye.min[2] + 0.5];
    let mut answers = Vec::new();
    for _ in 0..2_000 {
        let frame = walk.frame(eye);
        if answers.last() != Some(&frame.answer) {
            answers.push(frame.answer);
        }
        assert!(frame.answer != AnswerKind::Late || frame.seen.tiles.len() == 25);
        if frame.answer != AnswerKind::Late {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(
        matches!(answers.as_slice(), [AnswerKind::Late, _] | [AnswerKind::Full | AnswerKind::Outside]),
        "{answers:?}"
    );
    // The budget is less than a tile: that of the eye stays, and others go.
    while !walk.is_idle() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    walk.frame(eye);
    let (n_kept, n_loaded, _) = walk.counts();
    assert!(n_kept <= 3 && n_loaded >= 2, "{n_kept} of {n_loaded}");
}

/// A tile that the others do not know of is seen as a whole; one that is gone makes their tables those of another bake.
#[test]
fn tiles_that_are_not_known_are_seen() {
    let copy = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder()).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), copy.path().join(entry.file_name())).unwrap();
    }
    let text = fs::read(folder().join(INDEX_NAME)).unwrap();
    let index = WorldIndex::parse(&text).unwrap();
    let mut more = index.clone();
    more.tiles.push(TileEntry { name: "new".to_owned(), ..index.tiles[0].clone() });
    fs::write(copy.path().join(INDEX_NAME), more.to_json()).unwrap();
    let world = TiledWorld::open(copy.path()).unwrap();
    let (mut seen, mut scratch) = (Seen::default(), TileScratch::default());
    TileTables::load(&world, TileId(12), 0).unwrap().see_from(CellId(0), &mut seen, &mut scratch).unwrap();
    assert!(seen.tiles.contains(&TileId(25)));
    // The block 12 is two blocks away from the first: beyond a reach of less than that it is known not to be seen.
    for (reach, is_seen) in [(30.0, false), (60.0, true)] {
        more.reach = Some(reach);
        fs::write(copy.path().join(INDEX_NAME), more.to_json()).unwrap();
        let world = TiledWorld::open(copy.path()).unwrap();
        seen.clear();
        TileTables::load(&world, TileId(12), 0).unwrap().see_from(CellId(0), &mut seen, &mut scratch).unwrap();
        assert_eq!(seen.tiles.contains(&TileId(25)), is_seen, "{reach}");
    }

    let mut fewer = index.clone();
    fewer.tiles.pop();
    fs::write(copy.path().join(INDEX_NAME), fewer.to_json()).unwrap();
    assert!(matches!(
        TileTables::load(&TiledWorld::open(copy.path()).unwrap(), TileId(0), 0),
        Err(WorldError::Mixed { .. })
    ));
    let mut other = index.clone();
    other.tiles[13].n_cells += 1;
    fs::write(copy.path().join(INDEX_NAME), other.to_json()).unwrap();
    let world = TiledWorld::open(copy.path()).unwrap();
    // Its own table has another number, and to those nearby it is another tile.
    assert!(
        [12, 13].iter().all(|&tile| matches!(TileTables::load(&world, TileId(tile), 0), Err(WorldError::Mixed { .. })))
    );
    assert!(TileTables::load(&world, TileId(0), 0).is_ok());
}
