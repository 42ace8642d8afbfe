//! Tables by what is hidden from whole cells.

use crate::from_region::common::{around, shipped, triangles};
use sightlines::bake::region::grid;
use sightlines::bake::{BakedRegions, CellsFrom, RegionBakeOptions, bake_regions};
use sightlines::cells::Scene;
use sightlines::formats::ViewCells;
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::formats::view_cells::ViewCell;
use sightlines::geometry::Aabb;
use sightlines::multifocal::{FromRegion, Split};
use sightlines::pvs::{CellId, ObjectId, Table};
use sightlines::scenes::city::{CityOptions, city, city_crossings};
use sightlines::scenes::{TowerOptions, tower};
use sightlines_testkit::RayScene;
use sightlines_tests::data_folder;
use sightlines_tests::scenes::scene_witness;

/// The methods.
#[derive(Debug, Clone, Copy, PartialEq)]
enum By {
    Sightlines,
    Multifocal,
    Both,
}

fn bake(scene: &Scene, cells: &CellsFrom, by: By, split: u32, threads: usize) -> BakedRegions {
    let all = triangles(scene);
    let ends = match cells {
        CellsFrom::Boxes(boxes) => boxes.cells.iter().map(|c| c.bounds).collect(),
        CellsFrom::KdTree | CellsFrom::Grid(_) | CellsFrom::Places(_) | CellsFrom::EyeLevel(_) => Vec::new(),
    };
    let around = around(scene, &ends);
    let make = || -> Box<dyn FromRegion + Send> { Box::new(shipped(&all, around)) };
    let options = RegionBakeOptions {
        method: (by != By::Sightlines).then_some(&make),
        sightlines: by != By::Multifocal,
        split: Split { depth: split, n_rays: 1024, ..Split::default() },
        threads,
        ..RegionBakeOptions::new(cells)
    };
    bake_regions(scene, &options).expect("the scene can be baked")
}

/// Pairs of ids.
type Pairs = Vec<(u32, u32)>;

/// Pairs of a cell and an object, and of cells, that the table calls visible.
fn visible(table: &Table) -> (Pairs, Pairs) {
    let ids = 0..table.n_cells() as u32;
    let objects = ids.clone().flat_map(|c| table.visible_objects(CellId(c)).into_iter().map(move |o| (c, o.0)));
    let cells =
        ids.clone().flat_map(|a| ids.clone().map(move |b| (a, b))).filter(|&(a, b)| table.sees(CellId(a), CellId(b)));
    (objects.collect(), cells.collect())
}

/// Objects and cells that rays reach are visible in the table.
fn check(scene: &Scene, table: &Table, what: &str) -> usize {
    let rays = RayScene::new(scene);
    let cells: Vec<Aabb<3>> = table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect();
    let mut n = 0;
    for (id, cell) in (0..).zip(&cells) {
        let listed = table.visible_objects(CellId(id));
        for object in rays.witness_objects(*cell, 7, 500) {
            assert!(listed.binary_search(&ObjectId(object)).is_ok(), "{what}: cell {id} sees object {object}");
            n += 1;
        }
    }
    for (a, b) in rays.witness_cells(&cells, 8, 50) {
        assert!(table.sees(CellId(a), CellId(b)), "{what}: cell {a} sees cell {b}");
    }
    n
}

#[test]
fn a_city_is_seen_as_rays_see_it_and_mostly_hidden() {
    let options = CityOptions { blocks_x: 3, blocks_z: 3, ..CityOptions::default() };
    let scene = city(options).unwrap();
    let crossings = city_crossings(options).unwrap();
    let named = crossings
        .iter()
        .enumerate()
        .map(|(i, b)| sightlines::formats::view_cells::ViewCell { id: format!("crossing_{i}"), bounds: *b });
    let cells = CellsFrom::Boxes(sightlines::formats::ViewCells { cells: named.collect(), axes: None });
    let baked = bake(&scene, &cells, By::Multifocal, 0, 2);
    let seen = check(&scene, &baked.table, "city");
    let (objects, _) = visible(&baked.table);
    println!("city: {} seen, {} listed, of {}", seen, objects.len(), crossings.len() * scene.objects().len());
    assert!(seen > 50 && objects.len() < 3 * seen, "{} listed, {seen} seen", objects.len());
    assert_eq!(baked.table.cell_name(CellId(3)), Some("crossing_3"));
    // Splitting never loses anything that is hidden, and the answer has the same bytes with any number of threads.
    let split = bake(&scene, &cells, By::Multifocal, 2, 1);
    check(&scene, &split.table, "city in parts");
    let (fewer, _) = visible(&split.table);
    assert!(fewer.iter().all(|pair| objects.contains(pair)) && fewer.len() <= objects.len());
    assert!(split.report.effort.n_volumes > baked.report.effort.n_volumes);
    assert_eq!(split.table.to_bytes(), bake(&scene, &cells, By::Multifocal, 2, 3).table.to_bytes());
}

#[test]
fn both_methods_hide_what_either_hides() {
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }).unwrap();
    let boxes = CellsFrom::Boxes(grid(&scene.bounds(), [3, 2, 2]).unwrap());
    for cells in [CellsFrom::KdTree, boxes] {
        let [lines, region, both] = [By::Sightlines, By::Multifocal, By::Both].map(|by| {
            let baked = bake(&scene, &cells, by, 0, 2);
            check(&scene, &baked.table, &format!("{by:?}"));
            visible(&baked.table)
        });
        let common =
            |a: &[(u32, u32)], b: &[(u32, u32)]| a.iter().filter(|p| b.contains(p)).copied().collect::<Vec<_>>();
        // Objects that touch a cell are visible whatever is proven.
        assert_eq!(both.0, common(&lines.0, &region.0), "objects");
        assert_eq!(both.1, common(&lines.1, &region.1), "cells");
        println!("{} {} {}", lines.0.len(), region.0.len(), both.0.len());
    }
}

/// Invariant: on real scenes, sightlines from given cells show all that was seen from them, and hide a good part of the rest where
/// walls are perpendicular to an axis.
#[test]
fn real_cells_show_what_was_seen() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    // The least share of what was not seen that has to be hidden, in percent, if backs are drawn and if nothing is known of them: about nine tenths of
    // what it was.
    let scenes: [(&str, [usize; 2]); 6] = [
        ("duplex", [80, 0]),
        ("office_a", [90, 0]),
        ("whale_large", [70, 0]),
        ("pandora", [37, 0]),
        ("sponza", [45, 0]),
        ("delft", [0, 0]),
    ];
    let each = [BackFaces::Drawn, BackFaces::Either].into_iter().enumerate();
    let each = each.flat_map(|(k, backs)| scenes.map(|(name, least)| (name, least[k], backs)));
    for (name, least, backs) in each {
        let folder = data.join("scenes").join(name);
        let reading = SceneReadOptions { backs, ..SceneReadOptions::default() };
        let scene =
            read_scene_with(folder.join(format!("{name}.glb")), &reading).unwrap_or_else(|e| panic!("{e}")).scene;
        let witnesses = scene_witness(&folder);
        let named = witnesses.iter().map(|w| ViewCell { id: w.id.clone(), bounds: Aabb { min: w.min, max: w.max } });
        let cells = CellsFrom::Boxes(ViewCells { cells: named.collect(), axes: None });
        let start = std::time::Instant::now();
        let baked = bake(&scene, &cells, By::Sightlines, 0, 2);
        let time = start.elapsed();
        let rays = RayScene::new(&scene);
        let (mut n_seen, mut n_hidden) = (0, 0);
        for (id, witness) in (0u32..).zip(&witnesses) {
            let listed = baked.table.visible_objects(CellId(id));
            let eye = Aabb { min: witness.min, max: witness.max };
            for object in rays.witness_objects(eye, u64::from(id), 1000).iter().chain(&witness.objects) {
                assert!(
                    listed.binary_search(&ObjectId(*object)).is_ok(),
                    "{name}: {} sees object {object}",
                    witness.id
                );
            }
            n_seen += witness.objects.len();
            n_hidden += scene.objects().len() - listed.len();
        }
        let n_unseen = witnesses.len() * scene.objects().len() - n_seen;
        println!(
            "{name}, backs {}: {} cells in {time:?}, {n_seen} seen, {n_hidden} of {n_unseen} unseen hidden, {} assumed",
            backs.name(),
            witnesses.len(),
            baked.report.n_assumed
        );
        assert!(n_seen > 100 && n_hidden * 100 >= least * n_unseen, "{name}: {n_hidden} of {n_unseen} hidden");
    }
}

/// What has no place in a table is refused, and what is empty is not.
#[test]
fn odd_scenes_are_baked() {
    let scene = Scene::new(Vec::new()).unwrap();
    let cells = CellsFrom::Boxes(grid(&Aabb { min: [0.0; 3], max: [1.0, 1.0, 0.0] }, [2, 1, 1]).unwrap());
    let baked = bake(&scene, &cells, By::Multifocal, 3, 1);
    assert_eq!((baked.table.n_cells(), baked.table.objects().len()), (2, 0));
    let lone = sightlines::cells::SceneObject { name: String::new(), vertices: vec![[0.0; 3]], triangles: vec![] };
    let scene = Scene::new(vec![lone]).unwrap();
    let baked = bake(&scene, &cells, By::Multifocal, 3, 1);
    assert_eq!(visible(&baked.table).0, []);
    assert!(grid(&Aabb { min: [0.0; 3], max: [1.0; 3] }, [0, 1, 1]).is_err());
    assert!(grid(&Aabb { min: [0.0; 3], max: [1.0; 3] }, [5000, 5000, 5000]).is_err());
}
