//! A city in tiles: baked into a folder, and walked through.

use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::world::{WorldBake, WorldRun, world_files};
use sightlines_bake::{BakeRequest, CellsFrom, SceneMethod};
use sightlines_formats::scene::{SceneReadOptions, write_glb};
use sightlines_geometry::Aabb;
use sightlines_scenes::{CityOptions, city_tiles};
use sightlines_tiles::{TilePlan, TileWalk, TileWalkOptions, TiledWorld, WorldPlan};
use std::sync::Arc;

/// Blocks along each side, each a tile.
const N: u32 = 4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let mut plan = WorldPlan { border: 20.0, reach: None, tiles: Vec::new() };
    for tile in city_tiles(CityOptions { blocks_x: N, blocks_z: N, ..CityOptions::default() }, 1)? {
        let scene = format!("{}.glb", tile.name);
        std::fs::write(folder.path().join(&scene), write_glb(&tile.scene)?)?;
        let viewers = Some(Aabb::around(tile.cells.iter().flat_map(|cell| [cell.min, cell.max])));
        plan.tiles.push(TilePlan { name: tile.name, scene, at: [0.0; 3], viewers, cells: None });
    }
    let path = folder.path().join("plan.json");
    std::fs::write(&path, plan.to_json())?;
    let method = Some(SceneMethod::FromRegion(OcclusionMethod::LineSpace));
    let request = BakeRequest { method, cells: Some(CellsFrom::Grid([3, 1, 3])), ..BakeRequest::default() };
    let (run, reading) = (WorldRun::default(), SceneReadOptions::default());
    let bake = WorldBake::read((&path, &world_files(&path)?), (&request, &reading), ("1.0", 1), &run.runtime)?;
    bake.run(folder.path(), &run)?;

    let world = Arc::new(TiledWorld::open(folder.path())?);
    let options = TileWalkOptions { has_thread: false, ..TileWalkOptions::default() };
    let mut walk = TileWalk::new(Arc::clone(&world), options);
    for step in 0..4 {
        let eye = [46.0, 1.7, 20.0 + 52.0 * f64::from(step)];
        let frame = walk.frame(eye);
        let [cells, objects, tiles] = [frame.seen.cells.len(), frame.seen.objects.len(), frame.seen.tiles.len()];
        println!("at {eye:?}: {cells} cells and {objects} houses nearby, {tiles} blocks farther away");
    }
    let (n_loaded, _, n_bytes) = walk.counts();
    println!("{n_loaded} of {} tiles are in memory, with {} KiB", world.index().tiles.len(), n_bytes / 1024);
    Ok(())
}
