//! Walls that hide from their front only: one cell may see another that does not see it.

use crate::places::{block, scene};
use sightlines_bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines_bake::region::pack_regions;
use sightlines_bake::{
    BakeRequest, CellsFrom, LiveScene, RegionBakeOptions, Runtime, SceneBakeOptions, SceneMethod, bake_regions,
    bake_scene,
};
use sightlines_cells::{CellId, Scene, SceneObject};
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_kdtree::SceneOptions;
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_progress::Budget;
use sightlines_pvs::{ObjectId, Table};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// How many rooms of a hall there are, one behind the other along x, of 2 by 4 by 3.
const N: usize = 5;

/// Whether the wall behind each room but the last has its front towards lower x.
type Fronts = [bool; N - 1];

/// A closed hall with a block in each room, the objects from 1 on, and walls between the rooms that have one side.
fn hall(fronts: Fronts, are_front_only: bool) -> Scene {
    let mut shell = block(&Aabb { min: [0.0; 3], max: [2.0 * N as f64, 4.0, 3.0] }, false);
    shell.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let mut objects = vec![shell];
    objects.extend((0..N).map(|room| {
        let x = 2.0 * room as f64;
        block(&Aabb { min: [x + 0.75, 1.5, 0.5], max: [x + 1.25, 2.5, 1.5] }, false)
    }));
    for (k, is_towards_low) in fronts.into_iter().enumerate() {
        let x = 2.0 * (k + 1) as f64;
        let vertices = vec![[x, 0.0, 0.0], [x, 0.0, 3.0], [x, 4.0, 3.0], [x, 4.0, 0.0]];
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        if !is_towards_low {
            triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        objects.push(SceneObject { name: format!("wall {k}"), vertices, triangles });
    }
    let walls = if are_front_only { (N as u32 + 1..2 * N as u32).collect() } else { Vec::new() };
    scene(objects).with_front_occluders(walls).expect("walls are objects")
}

/// Whether no wall between two rooms has its front towards the first.
fn sees(fronts: &Fronts, from: usize, to: usize) -> bool {
    let between = &fronts[from.min(to)..from.max(to)];
    between.iter().all(|&is_towards_low| is_towards_low != (from < to))
}

/// A cell in each room, away from its walls: what lies on a wall is seen from both of its sides.
fn cells() -> CellsFrom {
    let cell = |room: usize| {
        let x = 2.0 * room as f64;
        let bounds = Aabb { min: [x + 0.25, 0.5, 0.25], max: [x + 1.75, 3.5, 2.75] };
        ViewCell { id: room.to_string(), bounds }
    };
    CellsFrom::Boxes(ViewCells { cells: (0..N).map(cell).collect(), axes: None })
}

fn by_line_space(scene: &Scene, budget: Option<&dyn Budget>) -> Table {
    let method = Some(SceneMethod::FromRegion(OcclusionMethod::LineSpace));
    let request = BakeRequest { cells: Some(cells()), method, ..BakeRequest::default() };
    Runtime { budget, threads: 1, ..Runtime::default() }.bake(scene, &request).expect("a table").table
}

/// For each room those of which the table shows the block, and those that it shows as cells.
fn shown(table: &Table) -> [Vec<Vec<usize>>; 2] {
    let rooms = || (0..N as u32).map(CellId);
    let list = |sees: &dyn Fn(CellId, usize) -> bool| {
        rooms().map(|from| (0..N).filter(|&to| sees(from, to)).collect()).collect::<Vec<Vec<usize>>>()
    };
    let objects: Vec<Vec<ObjectId>> = rooms().map(|cell| table.visible_objects(cell).to_vec()).collect();
    [
        list(&|from, to| objects[from.idx()].contains(&ObjectId(to as u32 + 1))),
        list(&|from, to| table.sees(from, CellId(to as u32))),
    ]
}

fn expected(fronts: &Fronts) -> [Vec<Vec<usize>>; 2] {
    let list = |sees: &dyn Fn(usize, usize) -> bool| {
        (0..N).map(|from| (0..N).filter(|&to| sees(from, to)).collect()).collect::<Vec<Vec<usize>>>()
    };
    [list(&|a, b| sees(fronts, a, b)), list(&|a, b| sees(fronts, a, b) || sees(fronts, b, a))]
}

/// All ways to turn the walls.
fn all_fronts() -> impl Iterator<Item = Fronts> {
    (0..1u32 << (N - 1)).map(|bits| std::array::from_fn(|k| bits >> k & 1 == 1))
}

/// Exactly what is seen past backs is shown: of objects by direction, of cells if either sees the other.
#[test]
fn tables_show_what_is_seen_past_backs() {
    let mut n_one_way = 0;
    for fronts in all_fronts() {
        let scene = hall(fronts, true);
        let table = by_line_space(&scene, None);
        assert_eq!(shown(&table), expected(&fronts), "{fronts:?}");
        n_one_way += (0..N)
            .flat_map(|a| (0..N).map(move |b| (a, b)))
            .filter(|&(a, b)| sees(&fronts, a, b) && !sees(&fronts, b, a))
            .count();
        // Whatever is chosen shows no less.
        let request = BakeRequest { cells: Some(cells()), ..BakeRequest::default() };
        let chosen = Runtime::default().bake(&scene, &request).expect("a table").table;
        for (chosen, least) in shown(&chosen).iter().flatten().zip(expected(&fronts).iter().flatten()) {
            assert!(least.iter().all(|room| chosen.contains(room)), "{fronts:?}");
        }
    }
    assert!(n_one_way > 50, "{n_one_way}");
    // The impostor: walls with two sides hide some of it.
    let fronts = [true, true, false, false];
    assert_ne!(shown(&by_line_space(&hall(fronts, false), None)), expected(&fronts));
}

/// Whenever a budget is spent, nothing is hidden that is shown without one; and something is decided.
#[test]
fn budgets_hide_no_more() {
    let fronts = [true, true, false, true];
    let scene = hall(fronts, true);
    let [objects, rooms] = expected(&fronts);
    let mut n_decided = 0;
    for n in [1u32, 3, 8, 20, 60, 200, 1000] {
        let spent = AtomicU32::new(0);
        let budget = move || f64::from(spent.fetch_add(1, Relaxed)) / f64::from(n);
        let [more_objects, more_rooms] = shown(&by_line_space(&scene, Some(&budget)));
        for (more, least) in more_objects.iter().chain(&more_rooms).zip(objects.iter().chain(&rooms)) {
            assert!(least.iter().all(|room| more.contains(room)), "{n}");
        }
        n_decided += u32::from(more_rooms.iter().any(|seen| seen.len() < N));
    }
    assert!(n_decided >= 2, "{n_decided}");
}

/// Row by row the packed table is written that the whole one gives.
#[test]
fn rows_one_by_one_make_the_same_packed_table() {
    let fronts = [true, false, false, true];
    let (scene, cells) = (hall(fronts, true), cells());
    let factory = OcclusionMethodFactory::new(OcclusionMethod::LineSpace, &scene, &BufferOptions::default()).unwrap();
    let make = || factory.instance();
    let options = RegionBakeOptions { method: Some(&make), sightlines: false, ..RegionBakeOptions::new(&cells) };
    let table = bake_regions(&scene, &options).unwrap().table;
    assert_eq!(shown(&table), expected(&fronts));
    let (bytes, report, _) = pack_regions(&scene, &options, &|_| {}, Vec::new()).unwrap();
    let large = PackOptions { class: Some(SizeClass::Large), ..PackOptions::default() };
    assert!(bytes == pack(&table, &large).unwrap());
    let n = N as u64;
    assert!(report.n_visible_pairs < n * (n - 1) / 2, "nothing is hidden");
}

/// A table that is kept up to date takes nothing from walls with one side, as one without them.
#[test]
fn live_tables_take_nothing_from_walls_with_one_side() {
    let only = |only_both_sides| {
        let cut = SceneOptions { detail_below: Some(0.0), only_both_sides, ..SceneOptions::default() };
        SceneBakeOptions { cut, ..SceneBakeOptions::default() }
    };
    let scene = hall([true, false, true, true], true);
    let mut live = LiveScene::new(hall([true; N - 1], true), &only(false)).expect("a table");
    live.update(scene.clone()).expect("a table");
    let [all, both_sides] = [false, true].map(|only_both| bake_scene(&scene, &only(only_both)).expect("a table").table);
    assert!(live.table().to_bytes() == both_sides.to_bytes());
    // The impostor hides more.
    assert!(all.to_bytes() != both_sides.to_bytes());
}
