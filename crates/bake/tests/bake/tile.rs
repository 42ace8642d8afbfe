//! Tiles of a world: together they say what a bake of the whole world says, as far as they look.

use crate::places::city_of_boxes;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::tile::{BakedTile, Columns, NearTile, Tile, bake_far, bake_tile, tile_cells, tile_extent};
use sightlines_bake::{BakeRequest, BufferRequest, CellsFrom, Runtime, SceneMethod};
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::{Aabb, Random};
use sightlines_multifocal::RaySampler;
use sightlines_pvs::{CellId, Table};
use std::collections::BTreeSet;

/// Blocks of the city along each side; each is a tile.
const N: usize = 5;

/// A block with its streets.
struct Block {
    scene: Scene,
    cells: Vec<ViewCell>,
    extent: Aabb<3>,
}

/// The blocks of a city without its ground, and cells along the streets of each.
fn blocks() -> Vec<Block> {
    let whole = city_of_boxes([N as u32; 2]);
    let block = |(x, z): (usize, usize)| {
        let of_block = format!("block_{x}_{z}/");
        let houses = whole.objects().iter().filter(|o| o.name.starts_with(&of_block)).cloned();
        let scene = Scene::new(houses.collect()).unwrap();
        assert_eq!(scene.objects().len(), 4);
        let [x0, z0] = [x, z].map(|k| k as f64 * 52.0);
        let street = |(k, [x, z, dx, dz]): (usize, [f64; 4])| ViewCell {
            id: k.to_string(),
            bounds: Aabb { min: [x0 + x, 1.25, z0 + z], max: [x0 + x + dx, 2.25, z0 + z + dz] },
        };
        let boxes = [[42.0, 2.0, 8.0, 8.0], [42.0, 30.0, 8.0, 8.0], [2.0, 42.0, 8.0, 8.0], [42.0, 42.0, 8.0, 8.0]];
        let cells: Vec<ViewCell> = boxes.into_iter().enumerate().map(street).collect();
        let extent = tile_extent(&scene, &cells);
        Block { scene, cells, extent }
    };
    (0..N * N).map(|k| block((k % N, k / N))).collect()
}

/// The tiles up to so many blocks away from one, and the others.
fn around(tile: usize, reach: usize) -> (Vec<usize>, Vec<usize>) {
    let far = |a: usize, b: usize| (a % N).abs_diff(b % N).max((a / N).abs_diff(b / N));
    (0..N * N).filter(|&other| other != tile).partition(|&other| far(tile, other) <= reach)
}

/// A tile, with what its columns are.
struct Baked {
    tile: usize,
    near: Vec<usize>,
    far: Vec<usize>,
    baked: BakedTile,
}

fn bake_one(blocks: &[Block], tile: usize, reach: usize, options: &BakeRequest) -> Baked {
    let (near, far) = around(tile, reach);
    let of_near: Vec<NearTile<'_>> =
        near.iter().map(|&k| NearTile { scene: &blocks[k].scene, cells: &blocks[k].cells }).collect();
    let of_far: Vec<Aabb<3>> = far.iter().map(|&k| blocks[k].extent).collect();
    let Block { scene, cells, .. } = &blocks[tile];
    let baked =
        bake_tile(&Tile { scene, file: None, cells, near: &of_near, far: &of_far }, options, &on_two()).unwrap();
    Baked { tile, near, far, baked }
}

impl Baked {
    /// For each cell of the tile the cells and the objects of each block that it may see.
    fn seen(&self, blocks: &[Block], cell: usize) -> Seen {
        let table = &self.baked.table;
        let own = |k: u32| (self.tile, k as usize);
        let mut seen = Seen {
            cells: table.visible(CellId(cell as u32)).map(|c| own(c.0)).collect(),
            objects: objects_of(table, cell).into_iter().map(own).collect(),
            whole: BTreeSet::new(),
        };
        let mut what = Vec::new();
        for &k in &self.near {
            what.extend((0..blocks[k].cells.len()).map(|c| (true, (k, c))));
            what.extend((0..blocks[k].scene.objects().len()).map(|o| (false, (k, o))));
        }
        for column in self.baked.near[cell].iter().cloned().flatten() {
            let (is_cell, which) = what[column as usize];
            if is_cell { &mut seen.cells } else { &mut seen.objects }.insert(which);
        }
        seen.whole.extend(self.baked.far[cell].iter().cloned().flatten().map(|k| self.far[k as usize]));
        seen
    }
}

#[derive(Debug, Default, PartialEq, Eq)]
struct Seen {
    cells: BTreeSet<(usize, usize)>,
    objects: BTreeSet<(usize, usize)>,
    whole: BTreeSet<usize>,
}

/// The objects that a cell may see.
fn objects_of(table: &Table, cell: usize) -> Vec<u32> {
    let seen = table.parts().objects_seen.as_ref().expect("the objects that cells see");
    seen.iter_ones(cell).map(|o| o as u32).collect()
}

/// The table of the whole city, with the objects block by block, and the cells of some of the blocks, in this order.
fn whole(blocks: &[Block], of: &[usize], options: &BakeRequest) -> Table {
    let objects = blocks.iter().flat_map(|b| b.scene.objects().to_vec()).collect();
    let cells = of.iter().flat_map(|&k| blocks[k].cells.clone()).enumerate();
    let cells = cells.map(|(k, cell)| ViewCell { id: k.to_string(), ..cell }).collect();
    let options = BakeRequest { cells: Some(CellsFrom::Boxes(ViewCells { cells, axes: None })), ..options.clone() };
    on_two().bake(&Scene::new(objects).unwrap(), &options).unwrap().table
}

fn by(method: SceneMethod) -> BakeRequest {
    let mut request = BakeRequest { method: Some(method), ..BakeRequest::default() };
    if [SceneMethod::Both, SceneMethod::FromRegion(OcclusionMethod::Multifocal)].contains(&method) {
        request.buffers = BufferRequest { planes: Some(2), texels: Some(64), ..BufferRequest::default() };
    }
    request
}

fn on_two() -> Runtime<'static> {
    Runtime { threads: 2, ..Runtime::default() }
}

/// Looked at to the end of the world, tiles say what one table says: sightlines are exact, however cells are grouped.
#[test]
fn with_all_others_nearby_tiles_are_parts_of_the_whole_table() {
    let blocks = blocks();
    let options = by(SceneMethod::Sightlines);
    let whole = whole(&blocks, &Vec::from_iter(0..N * N), &options);
    let (mut n_seen, mut n_all) = (0, 0);
    for tile in 0..N * N {
        let baked = bake_one(&blocks, tile, N, &options);
        for cell in 0..4 {
            let seen = baked.seen(&blocks, cell);
            let id = CellId((tile * 4 + cell) as u32);
            let split = |k: u32| (k as usize / 4, k as usize % 4);
            let cells: BTreeSet<_> = whole.visible(id).map(|c| split(c.0)).collect();
            let objects: BTreeSet<_> = objects_of(&whole, id.idx()).into_iter().map(split).collect();
            n_seen += cells.len() + objects.len();
            n_all += 8 * N * N;
            assert_eq!(seen, Seen { cells, objects, whole: BTreeSet::new() }, "cell {cell} of tile {tile}");
        }
    }
    assert!(n_seen * 3 < n_all && n_seen * 50 > n_all, "{n_seen} of {n_all}");
}

/// What rays from the cells of a tile hit first that the tile does not show.
fn lost(blocks: &[Block], seen: &dyn Fn(usize) -> Seen, tile: usize, n_rays: u32) -> (u32, u32) {
    let triangles: Vec<Vec<_>> =
        blocks.iter().flat_map(|b| b.scene.objects()).map(|object| object.corners().collect()).collect();
    let rays = RaySampler::new(triangles.iter().map(|of| &of[..]));
    let mut random = Random::new(5 + tile as u64);
    let (mut n_hits, mut n_lost) = (0, 0);
    for (k, cell) in blocks[tile].cells.iter().enumerate() {
        let seen = seen(k);
        for _ in 0..n_rays {
            let origin = random.point(&cell.bounds);
            let direction = random.point(&Aabb { min: [-1.0, -0.1, -1.0], max: [1.0, 0.3, 1.0] });
            let Some(hit) = rays.first_hit(origin, direction) else { continue };
            let (block, object) = (hit as usize / 4, hit as usize % 4);
            n_hits += 1;
            n_lost += u32::from(!seen.objects.contains(&(block, object)) && !seen.whole.contains(&block));
        }
    }
    (n_hits, n_lost)
}

/// Tiles at a corner, beside the middle and in it.
const TILES: [usize; 3] = [0, N + 2, N * N / 2];

#[test]
fn tiles_show_what_rays_hit_and_little_more_than_the_whole_table() {
    let blocks = blocks();
    for method in [SceneMethod::Sightlines, SceneMethod::FromRegion(OcclusionMethod::LineSpace), SceneMethod::Both] {
        let options = by(method);
        let whole = whole(&blocks, &TILES, &options);
        let (mut n_hits, mut n_tiles, mut n_near, mut n_of_whole) = (0, 0, 0, 0);
        for (k, tile) in TILES.into_iter().enumerate() {
            let baked = bake_one(&blocks, tile, 1, &options);
            let (hits, lost) = lost(&blocks, &|cell| baked.seen(&blocks, cell), tile, 4_000);
            assert_eq!(lost, 0, "{method} of tile {tile}");
            n_hits += hits;
            for cell in 0..4 {
                let seen = baked.seen(&blocks, cell);
                n_tiles += seen.whole.len();
                // Nearby, everything that hides there is known.
                let is_near = |k: u32| k as usize / 4 == tile || baked.near.contains(&(k as usize / 4));
                n_near += seen.objects.len();
                let id = CellId((k * 4 + cell) as u32);
                n_of_whole += objects_of(&whole, id.idx()).into_iter().filter(|o| is_near(*o)).count();
            }
        }
        assert!(n_hits > 20_000, "{n_hits}");
        let n_far = TILES.map(|tile| around(tile, 1).1.len() * 4).iter().sum::<usize>();
        assert!(n_tiles > 0 && n_tiles * 2 < n_far, "{method}: {n_tiles} of {n_far} tiles far away are seen");
        assert!(
            n_near >= n_of_whole && n_near * 20 <= n_of_whole * 21,
            "{method}: {n_near} objects, {n_of_whole} of the whole"
        );
    }
}

/// What is far away is decided alone as with all the rest, whatever else there is.
#[test]
fn far_tiles_alone_are_as_in_a_whole_bake() {
    let blocks = blocks();
    for method in [SceneMethod::Sightlines, SceneMethod::FromRegion(OcclusionMethod::LineSpace), SceneMethod::Both] {
        let options = by(method);
        let mut n_seen = [0, 0];
        for tile in [0, 13] {
            let (near, far) = around(tile, 1);
            let of_near: Vec<NearTile<'_>> =
                near.iter().map(|&k| NearTile { scene: &blocks[k].scene, cells: &blocks[k].cells }).collect();
            let of_far: Vec<Aabb<3>> = far.iter().map(|&k| blocks[k].extent).collect();
            let Block { scene, cells, .. } = &blocks[tile];
            let tile = Tile { scene, file: None, cells, near: &of_near, far: &of_far };
            let whole = bake_tile(&tile, &options, &on_two()).unwrap();
            assert_eq!(bake_far(&tile, &options, &on_two()).unwrap(), whole.far, "{method}");
            // Those nearby are the same without any far away.
            let alone = bake_tile(&Tile { far: &[], ..tile }, &options, &on_two()).unwrap();
            assert_eq!((&alone.near, alone.table.to_bytes()), (&whole.near, whole.table.to_bytes()), "{method}");
            let count = |rows: &Columns| rows.iter().flatten().map(|run| run.len()).sum::<usize>();
            n_seen = [n_seen[0] + count(&whole.near), n_seen[1] + count(&whole.far)];
        }
        assert!(n_seen[0] > 50 && n_seen[1] > 0, "{method}: {n_seen:?}");
    }
}

/// A tile that forgets one that it sees is noticed.
#[test]
fn lost_tiles_are_noticed() {
    let blocks = blocks();
    let baked = bake_one(&blocks, 7, 1, &by(SceneMethod::Sightlines));
    for (from_whole, kind) in [(true, "a tile"), (false, "an object")] {
        let seen = |cell: usize| {
            let mut seen = baked.seen(&blocks, cell);
            if from_whole {
                seen.whole.clear();
            } else {
                seen.objects.retain(|(block, _)| *block == 7);
            }
            seen
        };
        assert!(lost(&blocks, &seen, 7, 4_000).1 > 0, "{kind}");
    }
}

/// What hides is what is nearby: with less of it more is seen, and never less.
#[test]
fn tiles_farther_away_do_not_hide() {
    let blocks = blocks();
    let options = by(SceneMethod::Sightlines);
    let [none, one] = [0, 1].map(|reach| bake_one(&blocks, 12, reach, &options));
    let tiles = |baked: &Baked, cell: usize| -> BTreeSet<usize> {
        let seen = baked.seen(&blocks, cell);
        seen.objects.iter().map(|(block, _)| *block).chain(seen.whole).collect()
    };
    let mut n = [0, 0];
    for cell in 0..4 {
        let (wide, narrow) = (tiles(&none, cell), tiles(&one, cell));
        assert!(narrow.is_subset(&wide));
        n = [n[0] + wide.len(), n[1] + narrow.len()];
    }
    assert!(n[1] < n[0], "{n:?}");
}

/// Glass nearby hides nothing, what moves nearby is where it may be, and what is anywhere is seen from everywhere.
#[test]
fn surfaces_keep_their_meaning_in_other_tiles() {
    let wall = |name: &str, x: f64, size: f64| SceneObject {
        name: name.to_owned(),
        vertices: vec![[x, -size, -size], [x, size, -size], [x, size, size], [x, -size, size]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let own = Scene::new(vec![wall("own", 1.0, 0.5)]).unwrap();
    let eye = ViewCell { id: "eye".to_owned(), bounds: Aabb { min: [-1.0; 3], max: [0.0, 1.0, 1.0] } };
    let behind = Scene::new(vec![wall("picture", 9.0, 1.0), wall("mover", 9.5, 1.0), wall("ghost", 9.5, 1.0)]).unwrap();
    let bounds = Aabb { min: [8.0, -2.0, -2.0], max: [10.0, 2.0, 2.0] };
    let moving = [(1, Some(bounds)), (2, None)].map(|(object, within)| MovingObject { object, within });
    let behind = behind.with_moving(moving.to_vec()).unwrap();
    let screen = Scene::new(vec![wall("screen", 5.0, 100.0)]).unwrap();
    let glass = screen.clone().with_see_through(vec![0]).unwrap();
    let options = by(SceneMethod::FromRegion(OcclusionMethod::LineSpace));
    let seen = |screen: &Scene| {
        let near = [NearTile { scene: screen, cells: &[] }, NearTile { scene: &behind, cells: &[] }];
        let far = [bounds, tile_extent(&behind, &[])];
        let tile = Tile { scene: &own, file: None, cells: std::slice::from_ref(&eye), near: &near, far: &far };
        let baked = bake_tile(&tile, &options, &on_two()).unwrap();
        assert_eq!(objects_of(&baked.table, 0), [0]);
        [baked.near, baked.far].map(|rows| rows[0].iter().cloned().flatten().collect::<Vec<_>>())
    };
    // The screen; the picture, what moves behind it, what is anywhere. Then a box behind, and one that is everywhere.
    assert_eq!(seen(&screen), [vec![0, 3], vec![1]]);
    assert_eq!(seen(&glass), [vec![0, 1, 2, 3], vec![0, 1]]);
}

/// Cells are those of the tile alone, and the same options cut them in each of the ways.
#[test]
fn cells_are_cut_in_the_box_of_viewers() {
    let block = &blocks()[0];
    let viewers = Aabb { min: [0.0, 0.0, 0.0], max: [52.0, 6.0, 52.0] };
    let cut = |cells: CellsFrom| {
        let request = BakeRequest { cells: Some(cells), ..BakeRequest::default() };
        tile_cells(&block.scene, &viewers, &request, &on_two()).unwrap()
    };
    let n_cells = Some(20);
    let places = sightlines_bake::places::PlaceOptions { n_cells, cell_size: None };
    for (how, most) in [(CellsFrom::KdTree, 200), (CellsFrom::Grid([3, 1, 3]), 9), (CellsFrom::Places(places), 20)] {
        let cells = cut(how.clone());
        assert!((2..=most).contains(&cells.len()), "{how:?}: {}", cells.len());
        let is_in = |b: &Aabb<3>| (0..3).all(|k| viewers.min[k] <= b.min[k] && b.max[k] <= viewers.max[k]);
        assert!(cells.iter().all(|cell| is_in(&cell.bounds)), "{how:?}");
    }
}
