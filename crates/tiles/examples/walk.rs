//! A city in tiles: baked, written into a folder, and walked through.

use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::tile::{NearTile, Tile, bake_tile, tile_extent};
use sightlines_bake::{BakeRequest, Runtime, SceneMethod};
use sightlines_cells::Scene;
use sightlines_formats::ViewCell;
use sightlines_geometry::Aabb;
use sightlines_scenes::{CityOptions, city};
use sightlines_tiles::{
    INDEX_NAME, TileBounds, TileEntry, TilePart, TileWalk, TileWalkOptions, World, WorldIndex, far_bytes, near_bytes,
    near_tiles, table_bytes,
};
use std::sync::Arc;

/// Blocks along each side.
const N: u32 = 4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let whole = city(CityOptions { blocks_x: N, blocks_z: N, ..CityOptions::default() })?;
    // A tile for each block, with a cell along each of its two streets.
    let mut tiles = Vec::new();
    for (x, z) in (0..N).flat_map(|z| (0..N).map(move |x| (x, z))) {
        let of_block = format!("block_{x}_{z}/");
        let houses = whole.objects().iter().filter(|o| o.name.starts_with(&of_block)).cloned().collect();
        let scene = Scene::new(houses)?;
        let [x0, z0] = [x, z].map(|k| f64::from(k) * 52.0);
        let cell = |[x, z, dx, dz]: [f64; 4]| ViewCell {
            id: String::new(),
            bounds: Aabb { min: [x0 + x, 1.25, z0 + z], max: [x0 + x + dx, 2.25, z0 + z + dz] },
        };
        let cells = [[40.0, 0.0, 12.0, 52.0], [0.0, 40.0, 40.0, 12.0]].map(cell).to_vec();
        let viewers = Aabb::around(cells.iter().flat_map(|cell| [cell.bounds.min, cell.bounds.max]));
        let bounds = TileBounds { viewers, extent: tile_extent(&scene, &cells) };
        tiles.push((format!("{x}_{z}"), scene, cells, bounds));
    }
    let bounds: Vec<TileBounds> = tiles.iter().map(|tile| tile.3).collect();
    let near_of = near_tiles(&bounds, 20.0);
    let options =
        BakeRequest { method: Some(SceneMethod::FromRegion(OcclusionMethod::LineSpace)), ..BakeRequest::default() };
    let mut index = WorldIndex { border: 20.0, reach: None, tiles: Vec::new() };
    for (k, (name, scene, cells, bounds)) in (0u32..).zip(&tiles) {
        let near: Vec<usize> = near_of[k as usize].iter().map(|&near| near as usize).collect();
        let far: Vec<usize> = (0..tiles.len()).filter(|other| *other != k as usize && !near.contains(other)).collect();
        let scenes: Vec<NearTile<'_>> =
            near.iter().map(|&near| NearTile { scene: &tiles[near].1, cells: &tiles[near].2 }).collect();
        let boxes: Vec<Aabb<3>> = far.iter().map(|&far| tiles[far].3.extent).collect();
        let baked =
            bake_tile(&Tile { scene, file: None, cells, near: &scenes, far: &boxes }, &options, &Runtime::default())?;
        // Who bakes again when something changes takes hashes of all that decides the content.
        let entry = TileEntry {
            name: name.clone(),
            bounds: *bounds,
            key: [k as u8; 16],
            far_key: [k as u8; 16],
            n_cells: cells.len() as u32,
            n_objects: scene.objects().len() as u32,
        };
        let sizes: Vec<(String, [u32; 2])> = near
            .iter()
            .map(|&near| (tiles[near].0.clone(), [tiles[near].2.len() as u32, tiles[near].1.objects().len() as u32]))
            .collect();
        let names: Vec<String> = far.iter().map(|&far| tiles[far].0.clone()).collect();
        let files = [
            (TilePart::Table, table_bytes(baked.table, entry.key)?),
            (TilePart::Near, near_bytes(entry.key, sizes, &baked.near)?),
            (TilePart::Far, far_bytes(entry.far_key, names, &baked.far)?),
        ];
        for (part, bytes) in files {
            std::fs::write(folder.path().join(entry.file_name(part)), bytes)?;
        }
        index.tiles.push(entry);
    }
    std::fs::write(folder.path().join(INDEX_NAME), index.to_json())?;

    let world = Arc::new(World::open(folder.path())?);
    let options = TileWalkOptions { has_thread: false, ..TileWalkOptions::default() };
    let mut walk = TileWalk::new(Arc::clone(&world), options);
    for step in 0..4 {
        let eye = [46.0, 1.7, 20.0 + 52.0 * f64::from(step)];
        let frame = walk.frame(eye);
        let [cells, objects, tiles] = [frame.seen.cells.len(), frame.seen.objects.len(), frame.seen.tiles.len()];
        println!("at {eye:?}: {cells} cells and {objects} houses nearby, {tiles} blocks farther away");
    }
    let (n_loaded, _, n_bytes) = walk.counts();
    println!("{n_loaded} of {} tiles are in memory, with {} KiB", index.tiles.len(), n_bytes / 1024);
    Ok(())
}
