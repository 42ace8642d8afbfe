//! Tables of scenes that change against tables baked anew, byte for byte, after random edits of small towers and of
//! boxes.

use proptest::prelude::*;
use sightlines_bake::{LiveScene, PortalMode, SceneBakeOptions, bake_scene};
use sightlines_cells::{CellGraph, PortalId, Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, subdivide_scene};
use sightlines_scenes::{TowerOptions, tower};
use sightlines_stabtree::{SearchOptions, axial_visibility};
use std::cell::Cell;

/// A closed box that faces outwards.
fn block(name: &str, b: &Aabb<3>) -> SceneObject {
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

/// What happens to the objects of a scene.
#[derive(Debug, Clone)]
enum Edit {
    /// An object goes.
    Remove(usize),
    /// An object is moved along an axis, by quarters of a unit.
    Move(usize, usize, i8),
    /// A box comes, with corners on a grid in the scene's box.
    Add([[u8; 3]; 2]),
    /// The order of objects changes.
    Turn(usize),
    /// Back to the scene at the beginning.
    Undo,
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let index = any::<usize>;
    let edit = prop_oneof![
        index().prop_map(Edit::Remove),
        (index(), 0..3usize, -2..3i8).prop_map(|(object, axis, by)| Edit::Move(object, axis, by)),
        prop::array::uniform2(prop::array::uniform3(0..9u8)).prop_map(Edit::Add),
        index().prop_map(Edit::Turn),
        Just(Edit::Undo),
    ];
    prop::collection::vec(edit, 1..4)
}

fn edited(scene: &Scene, first: &Scene, edit: &Edit) -> Scene {
    let mut objects = scene.objects().to_vec();
    let n = objects.len();
    let pick = |i: &usize| i % n;
    match edit {
        Edit::Remove(i) if objects.len() > 1 => drop(objects.remove(pick(i))),
        Edit::Remove(_) => {}
        Edit::Move(i, axis, by) => {
            let object = pick(i);
            objects[object].vertices.iter_mut().for_each(|p| p[*axis] += 0.25 * f64::from(*by));
        }
        Edit::Add(ends) => {
            let all = first.bounds();
            let place =
                |end: [u8; 3]| [0, 1, 2].map(|k| all.min[k] + (all.max[k] - all.min[k]) / 8.0 * f64::from(end[k]));
            let bounds = Aabb::around(ends.map(place));
            objects.push(block("new", &bounds));
        }
        Edit::Turn(i) => {
            let first = pick(i);
            objects.rotate_left(first);
        }
        Edit::Undo => return first.clone(),
    }
    Scene::new(objects).expect("corners on a grid make a scene")
}

fn small_tower(seed: u64, furniture: u32) -> Scene {
    let options = TowerOptions { seed, floors: 1, rooms_x: 2, rooms_y: 1, furniture, ..TowerOptions::default() };
    tower(options).expect("a tower")
}

fn a_few_boxes() -> impl Strategy<Value = Scene> {
    let ends = || prop::array::uniform3(0..=6i8);
    let boxes = prop::collection::vec((ends(), ends()), 2..10);
    boxes.prop_map(|boxes| {
        let point = |p: [i8; 3]| p.map(f64::from);
        let mut objects = vec![
            block("floor", &Aabb { min: [0.0, 0.0, -1.0], max: [6.0, 6.0, 0.0] }),
            block("roof", &Aabb { min: [0.0, 0.0, 6.0], max: [6.0, 6.0, 7.0] }),
        ];
        objects.extend(boxes.into_iter().map(|(p, q)| block("box", &Aabb::around([point(p), point(q)]))));
        Scene::new(objects).expect("corners on a grid make a scene")
    })
}

/// Updates along `edits`, each compared with a table baked anew; returns how many tables differed in visibility.
fn follow(scene: &Scene, edits: &[Edit], options: &SceneBakeOptions<'_>) -> Result<u64, TestCaseError> {
    let mut live = LiveScene::new(scene.clone(), options).expect("a table");
    let mut now = scene.clone();
    let mut n_changed = 0;
    for (step, edit) in edits.iter().enumerate() {
        now = edited(&now, scene, edit);
        let before = live.table().to_bytes();
        match (bake_scene(&now, options), live.update(now.clone())) {
            (Ok(expected), Ok(update)) => {
                prop_assert_eq!(expected.report.n_assumed, 0);
                let bytes = expected.table.to_bytes();
                prop_assert!(bytes == live.table().to_bytes(), "step {}, {:?}: {:?}", step, edit, update);
                n_changed += u64::from(before != bytes);
            }
            (Err(expected), Err(found)) => {
                prop_assert_eq!(expected.to_string(), found.to_string());
                prop_assert!(before == live.table().to_bytes());
            }
            (expected, found) => prop_assert!(false, "{:?} but {:?}", expected.err(), found.err()),
        }
    }
    Ok(n_changed)
}

/// Invariant: whatever happens to a scene, its table is the one baked anew, byte for byte.
#[test]
fn live_tables_equal_tables_baked_anew() {
    let changed = Cell::new(0);
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let mode = prop_oneof![Just(PortalMode::Exact), Just(PortalMode::Bounding)];
    let strategy = (a_few_boxes(), edits(), mode, 1..3usize);
    let result = runner.run(&strategy, |(scene, edits, portals, threads)| {
        let cut = SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() };
        let options = SceneBakeOptions { cut, portals, threads, ..SceneBakeOptions::default() };
        changed.set(changed.get() + follow(&scene, &edits, &options)?);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("live_tables_equal_tables_baked_anew: {e}"));
    assert!(changed.get() > cases / 2, "{} changed, of {cases} cases", changed.get());
}

/// The same for a tower with its walls, doors and windows, and the default size of detail, which edits may change.
#[test]
fn towers_that_change_are_baked_right() {
    let moves = [
        vec![Edit::Add([[2, 0, 0], [3, 8, 8]]), Edit::Undo, Edit::Add([[0, 4, 0], [8, 5, 8]])],
        (0..6).map(|k| Edit::Move(7 * k, k % 3, 1)).collect(),
        (0..6).flat_map(|k| [Edit::Remove(5 * k + 1), Edit::Turn(k)]).collect(),
    ];
    let mut n_changed = 0;
    for (edits, seed) in moves.iter().zip(1..) {
        let options = SceneBakeOptions { threads: 2, ..SceneBakeOptions::default() };
        n_changed += follow(&small_tower(seed, 1), edits, &options).expect("the tables are equal");
    }
    assert!(n_changed > 8, "{n_changed}");
}

/// Portals that are closed by id are walls for the rows, and the table keeps them; open again, all is as before. What a
/// forgetful update would say, the open table, is noticed.
#[test]
fn portals_close_and_open() {
    let scene = small_tower(3, 0);
    let options = SceneBakeOptions { threads: 1, ..SceneBakeOptions::default() };
    let mut live = LiveScene::new(scene.clone(), &options).expect("a table");
    let open = live.table().to_bytes();
    let cut = subdivide_scene(&scene, &SceneOptions::default()).expect("cells");
    let boxes: Vec<Aabb<3>> = scene.objects().iter().map(|o| Aabb::around(o.corners().flatten())).collect();
    let mut n_changed = 0;
    for first in (0..cut.graph.portals().len() as u32).step_by(7) {
        let closed = [PortalId(first), PortalId(first / 2)];
        live.close(&closed).expect("a table");
        let portals = (0u32..).zip(cut.graph.portals()).filter(|(id, _)| !closed.contains(&PortalId(*id)));
        let graph = CellGraph::new(cut.graph.cells().to_vec(), portals.map(|(_, p)| p.clone()).collect());
        let search = SearchOptions { threads: 1, ..SearchOptions::default() };
        let seen = axial_visibility(&graph, &cut.left_out(), &[], &boxes, &search).expect("nobody cancels");
        for cell in graph.cell_ids() {
            assert!(live.table().visible(cell).map(|c| c.idx()).eq(seen.cells.iter_ones(cell.idx())));
            let objects = live.table().visible_objects(cell);
            assert!(objects.iter().map(|o| o.idx()).eq(seen.objects.iter_ones(cell.idx())));
        }
        assert_eq!(live.table().portals().len(), cut.graph.portals().len());
        assert!(closed.iter().all(|id| live.closed_portals().contains(id)));
        n_changed += u32::from(live.table().to_bytes() != open);
        live.open(&closed).expect("a table");
        assert!(live.closed_portals().is_empty() && live.table().to_bytes() == open);
    }
    assert!(n_changed > 5, "{n_changed}");
    // A scene that changes keeps what is closed in openings that stay, and ids without a portal close nothing.
    live.close(&[PortalId(0), PortalId(u32::MAX)]).expect("a table");
    let more = edited(&scene, &scene, &Edit::Add([[7, 0, 7], [8, 1, 8]]));
    live.update(more).expect("a table");
    live.update(scene).expect("a table");
    assert_eq!(live.closed_portals(), [PortalId(0)]);
}

/// Walls that are a rounding apart, so that some pairs of cells are hard to decide about: an update that asks fewer groups than a
/// rebuild must not give up what that one proves.
#[test]
fn walls_a_rounding_apart_are_decided_as_in_a_rebuild() {
    let [p, q] = [0.899_999_999_999_999_9, 1.799_999_999_999_999_8];
    let ends = [
        [[0.6, p, 1.5], [p, q, q]],
        [[0.0, 0.6, p], [0.6, 1.2, 1.5]],
        [[0.0; 3], [0.001, 6.0, 6.0]],
        [[0.3; 3], [1.5, p, 1.2]],
    ];
    let boxes: Vec<SceneObject> = ends.iter().map(|&[min, max]| block("b", &Aabb { min, max })).collect();
    let before = Scene::new(boxes.clone()).expect("boxes");
    let mut more = boxes;
    more.insert(3, block("new", &Aabb { min: [p, 1.2, 0.6], max: [q, q, 1.5] }));
    let after = Scene::new(more).expect("boxes");
    let cut = SceneOptions { tau: 0.0, keep_solid: true, ..SceneOptions::default() };
    let options = SceneBakeOptions { cut, threads: 1, ..SceneBakeOptions::default() };
    let mut live = LiveScene::new(before, &options).expect("a table");
    live.update(after.clone()).expect("a table");
    let baked = bake_scene(&after, &options).expect("a table");
    assert!(baked.report.n_assumed == 0 && live.table().to_bytes() == baked.table.to_bytes());
}

/// What is closed stays closed while it is walled up, whatever else is opened meanwhile.
#[test]
fn doors_that_are_walled_up_stay_closed() {
    let at = |min, max| Aabb { min, max };
    let mut shell = block("shell", &at([0.0; 3], [4.0, 5.0, 2.0]));
    shell.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let wall = |y: f64| block("wall", &at([2.0, y, 0.0], [2.25, y + 1.0, 2.0]));
    let scene = |walls: &[f64]| {
        let objects = std::iter::once(shell.clone()).chain(walls.iter().map(|&y| wall(y))).collect();
        Scene::new(objects).expect("boxes")
    };
    let cut = SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() };
    let options = SceneBakeOptions { cut, threads: 1, ..SceneBakeOptions::default() };
    let mut live = LiveScene::new(scene(&[0.0, 2.0, 4.0]), &options).expect("a table");
    let door = |live: &LiveScene, y: f64| -> Vec<PortalId> {
        let portals = (0u32..).map(PortalId).zip(live.graph().portals());
        let is_there = |shape: &sightlines_geometry::AxialDoor| {
            shape.axis == 0 && shape.at() == 2.0 && shape.extent.min[1] >= y && shape.extent.max[1] <= y + 1.0
        };
        portals.filter(|(_, portal)| is_there(&portal.shape)).map(|(id, _)| id).collect()
    };
    let first = door(&live, 1.0);
    live.close(&first).expect("a table");
    let closed = live.closed_portals();
    assert!(!closed.is_empty());
    live.update(scene(&[0.0, 2.0, 4.0, 1.0])).expect("a table");
    assert!(live.closed_portals().is_empty());
    let second = door(&live, 3.0);
    live.open(&second).expect("a table");
    live.update(scene(&[0.0, 2.0, 4.0])).expect("a table");
    assert_eq!(live.closed_portals(), closed);
    let first = door(&live, 1.0);
    live.open(&first).expect("a table");
    assert!(live.closed_portals().is_empty());
}
