//! Cells at the height of eyes: they do not overlap, eyes on floors are in cells, and units are recognised.

use crate::places::{block, city_of_boxes, scene};
use proptest::prelude::*;
use sightlines_bake::eye_level::{EyeLevelCells, EyeLevelError, EyeLevelOptions, LeftOut, UnitsFrom, eye_level_cells};
use sightlines_bake::places::PlaceOptions;
use sightlines_bake::region::CellsFrom;
use sightlines_bake::{BakeInput, BakeRequest, Runtime, SceneMethod};
use sightlines_cells::{Scene, SceneObject};
use sightlines_formats::scene::{SceneInfo, parse_glb, read_scene, write_glb};
use sightlines_formats::view_cells::read_view_cells;
use sightlines_geometry::vector::normal;
use sightlines_geometry::{Aabb, Point3, Random, ray_triangle};
use sightlines_kdtree::KdError;
use sightlines_multifocal::Split;
use sightlines_progress::{Cancelled, Progress};
use sightlines_pvs::Axis;
use sightlines_scenes::{TowerOptions, tower};
use std::ops::ControlFlow;
use std::time::Instant;

const MANY: u32 = 1 << 20;

fn metres() -> EyeLevelOptions {
    EyeLevelOptions { units_per_metre: Some(1.0), cell_size: Some(4.0), ..EyeLevelOptions::default() }
}

fn cut(scene: &Scene, up: Axis, options: &EyeLevelOptions) -> EyeLevelCells {
    eye_level_cells(scene, up, None, options, MANY, None).expect("floors")
}

/// How many parts are in several of the boxes, of all parts that the planes of their sides cut; and the boxes that are flat. Exact:
/// coordinates are only compared.
fn faults(boxes: &[Aabb<3>]) -> usize {
    let lines: [Vec<f64>; 3] = [0, 1, 2].map(|k| {
        let mut lines: Vec<f64> = boxes.iter().flat_map(|b| [b.min[k], b.max[k]]).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        lines
    });
    let at = |k: usize, x: f64| lines[k].partition_point(|&line| line < x);
    let [nx, ny, nz] = [0, 1, 2].map(|k| lines[k].len() - 1);
    let mut n_covers = vec![0u8; nx * ny * nz];
    for b in boxes {
        for x in at(0, b.min[0])..at(0, b.max[0]) {
            for y in at(1, b.min[1])..at(1, b.max[1]) {
                let row = (x * ny + y) * nz;
                n_covers[row + at(2, b.min[2])..row + at(2, b.max[2])]
                    .iter_mut()
                    .for_each(|n| *n = n.saturating_add(1));
            }
        }
    }
    let is_flat = |b: &&Aabb<3>| (0..3).any(|k| b.min[k] >= b.max[k]);
    n_covers.iter().filter(|&&n| n > 1).count() + boxes.iter().filter(is_flat).count()
}

/// Blocks at places of a small grid, upright or turned about the last axis.
fn blocks() -> impl Strategy<Value = Vec<(Aabb<3>, bool)>> {
    let one = ([0i32..9, 0i32..9, 0i32..5], [1i32..5, 1i32..5, 1i32..4], any::<bool>());
    let one = one.prop_map(|(min, size, turned)| {
        let max = std::array::from_fn(|k| f64::from(min[k] + size[k]));
        (Aabb { min: min.map(f64::from), max }, turned)
    });
    prop::collection::vec(one, 1..8)
}

/// The same scene with its axes exchanged, so that `up` takes the place of the last one.
fn with_up(scene: &Scene, up: Axis) -> Scene {
    let turn = |p: &Point3| -> Point3 { std::array::from_fn(|k| p[(k + 2 - up.idx()) % 3]) };
    let objects = scene.objects().iter();
    let objects = objects.map(|o| SceneObject { vertices: o.vertices.iter().map(turn).collect(), ..o.clone() });
    Scene::new(objects.collect()).expect("a scene")
}

fn axis() -> impl Strategy<Value = Axis> {
    (0usize..3).prop_map(|k| Axis::ALL[k])
}

proptest! {
    /// Cells do not overlap, are no larger than said, and are in their region.
    #[test]
    fn cells_do_not_overlap(solids in blocks(), up in axis(), width in 1u32..5, tall in 1u32..5, part in any::<bool>()) {
        let scene = with_up(&scene(solids.iter().map(|(b, turned)| block(b, *turned)).collect()), up);
        let (width, tall) = (f64::from(width) * 0.75, f64::from(tall) * 0.4);
        let options = EyeLevelOptions { cell_size: Some(width), eye_height: Some([0.0, tall]), ..metres() };
        let all = scene.bounds();
        // A part of the scene, and of what is beside it.
        let region = Aabb { min: all.min.map(|x| x + 0.75), max: all.max.map(|x| x + 0.5) };
        let region = Some(region).filter(|b| part && (0..3).all(|k| b.min[k] < b.max[k]));
        let found = match eye_level_cells(&scene, up, region.as_ref(), &options, MANY, None) {
            Err(EyeLevelError::NoFloor) if region.is_some() => return Ok(()),
            found => found.expect("cells"),
        };
        prop_assert_eq!(faults(&found.cells), 0, "{:?}", found);
        for cell in &found.cells {
            prop_assert!(cell.max[up.idx()] - cell.min[up.idx()] <= 1.5 * tall * 1.5 * (1.0 + 1e-9), "{:?}", cell);
            prop_assert!((0..3).all(|k| k == up.idx() || cell.max[k] - cell.min[k] <= width * (1.0 + 1e-9)), "{:?}", cell);
            if let Some(region) = region {
                prop_assert!((0..3).all(|k| region.min[k] <= cell.min[k] && cell.max[k] <= region.max[k]), "{:?}", cell);
            }
        }
        // The impostors: a cell that is there twice, or that reaches into another one by the smallest step.
        let mut cells = found.cells.clone();
        let mut beside = cells[cells.len() / 2];
        cells.push(beside);
        prop_assert!(faults(&cells) > 0);
        let k = up.idx();
        (beside.min[k], beside.max[k]) = (beside.max[k].next_down(), beside.max[k] + tall);
        *cells.last_mut().expect("a cell") = beside;
        prop_assert!(faults(&cells) > 0);
    }
}

/// Hills of steps and ramps, 40 by 40 m: for each square of 2 m a height, and triangles between.
fn hills() -> Scene {
    let height = |x: u32, y: u32| f64::from((x * 7 + y * 3) % 11 / 4) + 0.25 * f64::from(x * y % 20);
    let at = |x: u32, y: u32| [2.0 * f64::from(x), 2.0 * f64::from(y), height(x, y)];
    let mut ground = SceneObject { name: "ground".to_owned(), vertices: Vec::new(), triangles: Vec::new() };
    for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
        let n = ground.vertices.len() as u32;
        ground.vertices.extend([at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
        ground.triangles.extend([[n, n + 1, n + 2], [n, n + 2, n + 3]]);
    }
    Scene::new(vec![ground]).expect("a scene")
}

/// Eyes above points of the floors that are named so, with room for somebody to stand there; how many there are, and how many are in no box.
fn eyes(scene: &Scene, up: usize, floors: &[&str], boxes: &[Aabb<3>], n: usize) -> [usize; 2] {
    let all: Vec<[Point3; 3]> = scene.objects().iter().flat_map(SceneObject::corners).collect();
    let of = |o: &&SceneObject| floors.iter().any(|name| o.name.contains(name));
    let is_floor = |t: &[Point3; 3]| {
        let m = normal(*t);
        m[up] > 0.0 && m[up] * m[up] > 0.42 * m.iter().map(|x| x * x).sum::<f64>()
    };
    let triangles: Vec<[Point3; 3]> =
        scene.objects().iter().filter(of).flat_map(SceneObject::corners).filter(is_floor).collect();
    let mut random = Random::new(n as u64);
    let mut way = [0.0; 3];
    way[up] = 1.0;
    let mut counts = [0, 0];
    for _ in 0..n {
        let [a, b, c] = triangles[random.below(triangles.len())];
        let (x, y) = (random.unit(), random.unit());
        let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
        let p: Point3 = std::array::from_fn(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]));
        let clearance = all.iter().map(|t| ray_triangle(t, p, way)).fold(f64::INFINITY, |least, [s, t, at]| {
            if s >= 0.0 && t >= 0.0 && s + t <= 1.0 && at > 1e-6 { least.min(at) } else { least }
        });
        let mut eye = p;
        eye[up] += random.unit() * clearance.min(2.5);
        // Not in a house, which is solid.
        let house = |o: &SceneObject| o.name.contains("house") && o.bounds().contains(eye);
        if clearance >= 1.3 && !scene.objects().iter().any(house) {
            counts[0] += 1;
            counts[1] += usize::from(!boxes.iter().any(|b| b.contains(eye)));
        }
    }
    counts
}

#[test]
fn eyes_above_floors_are_in_cells() {
    let furnished = TowerOptions { floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    let scenes = [
        ("tower", tower(furnished).expect("a tower"), Axis::Y, vec!["slab", "stairs"]),
        ("city", city_of_boxes([2, 2]), Axis::Y, vec!["ground", "house"]),
        ("hills", hills(), Axis::Z, vec!["ground"]),
    ];
    for (width, (name, scene, up, floors)) in scenes.iter().flat_map(|of| [1.0, 4.0].map(|width| (width, of))) {
        let found = cut(scene, *up, &EyeLevelOptions { cell_size: Some(width), ..metres() });
        let [n, lost] = eyes(scene, up.idx(), floors, &found.cells, 2000);
        eprintln!("{name}, {width} m: {n} eyes, {lost} lost; {:?}", found.summary);
        assert!(n > 300 && lost == 0, "{name}: {n} eyes, {lost} of them in no cell");
        // The twin: cells are no higher than they have to be, and few places that are no eye's are in them.
        assert!(found.cells.iter().all(|b| b.max[up.idx()] - b.min[up.idx()] < 1.5 * 2.5 * 1.5), "{name}");
        let volume = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).product::<f64>();
        let around = found.cells.iter().fold(scene.bounds(), |all, b| all.with(b.min).with(b.max));
        let share = found.cells.iter().map(volume).sum::<f64>() / volume(&around);
        assert!(share < 0.95, "{name}: {share}");
        // The impostor: without every third cell.
        let some: Vec<Aabb<3>> = (0..).zip(&found.cells).filter(|(i, _)| i % 3 > 0).map(|(_, b)| *b).collect();
        assert!(eyes(scene, up.idx(), floors, &some, 2000)[1] > 20, "{name}");
    }
}

fn boxed(min: Point3, max: Point3) -> Aabb<3> {
    Aabb { min, max }
}

/// A block, and ground around it 20 m wide.
fn on_ground(block: SceneObject) -> Scene {
    on_ground_at(block, 0.0)
}

fn on_ground_at(block: SceneObject, z: f64) -> Scene {
    let vertices = vec![[-10.0, -10.0, z], [18.0, -10.0, z], [18.0, 18.0, z], [-10.0, 18.0, z]];
    scene(vec![block, SceneObject { name: String::new(), vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }])
}

fn inside(found: &EyeLevelCells, p: Point3) -> bool {
    found.cells.iter().any(|b| b.contains(p))
}

#[test]
fn nobody_stands_in_solids_nor_behind_backs() {
    let solid = block(&boxed([0.0; 3], [8.0; 3]), false);
    let turned_over =
        SceneObject { triangles: solid.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect(), ..solid.clone() };
    let mut open = solid.clone();
    // A part of a side.
    open.triangles.remove(4);
    for (block, is_room, z, why) in [
        (&solid, false, 0.0, "a solid"),
        (&open, false, -0.5, "a solid with a hole"),
        (&turned_over, true, 0.0, "a room"),
    ] {
        let found = cut(&on_ground_at(block.clone(), z), Axis::Z, &metres());
        for p in [[4.0, 4.0, 1.0], [2.5, 5.5, 0.1], [5.5, 2.5, 2.0]] {
            assert_eq!(inside(&found, p), is_room, "{why}: {:?}", found.summary);
        }
        assert!(inside(&found, [-5.0, -5.0, 1.0]) && inside(&found, [4.0, 4.0, 9.0]), "{why}");
    }
    // Ground that is seen from above, and other ground 3 m below it; from below both are nothing. At its border one sees out.
    let sheet = |z: f64| SceneObject {
        name: String::new(),
        vertices: vec![[0.0, 0.0, z], [40.0, 0.0, z], [40.0, 40.0, z], [0.0, 40.0, z]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let sheets = scene(vec![sheet(0.0), sheet(3.0)]);
    for (single, n_cells) in [(vec![], 200), (vec![0, 1], 136)] {
        let found = cut(&sheets.clone().with_single_sided(single).expect("objects"), Axis::Z, &metres());
        assert_eq!(
            (found.cells.len(), inside(&found, [20.0, 20.0, 1.0])),
            (n_cells, n_cells == 200),
            "{:?}",
            found.summary
        );
    }
}

#[test]
fn floors_without_room_and_slivers_are_left_out() {
    let post = |side: f64, z: f64| block(&boxed([1.0, 1.0, z], [1.0 + side, 1.0 + side, z + 0.5]), false);
    let layers = |thing: SceneObject| cut(&on_ground(thing), Axis::Z, &metres()).summary;
    let (post_far, bench) = (layers(post(0.25, 6.0)), layers(post(1.0, 6.0)));
    assert_eq!((post_far.n_layers, post_far.left_out), (1, LeftOut { no_room: 2, slivers: 2, ..LeftOut::default() }));
    assert_eq!((bench.n_layers, bench.left_out.slivers), (2, 0));
    // Under something low there is no room. It is as wide as the ground.
    let over = |z: f64| block(&boxed([-10.0, -10.0, z], [18.0, 18.0, z + 8.0]), false);
    assert_eq!([1.0, 2.0].map(|z| layers(over(z)).n_layers), [1, 2]);
}

#[test]
fn close_floors_share_layers() {
    // Plates 1.5 m apart: a run of 7.5 + 2.5 m; cut at plates.
    let plate = |i: u32| block(&boxed([0.0, 0.0, 1.5 * f64::from(i)], [4.0, 4.0, 1.5 * f64::from(i) + 0.125]), false);
    let found = cut(&scene((0..6).map(plate).collect()), Axis::Z, &metres());
    let heights: Vec<f64> = found.cells.iter().map(|b| b.min[2]).collect();
    assert_eq!(heights, [0.125, 3.125, 6.125], "{found:?}");
    // A storey above another one.
    let plate = |i: u32| block(&boxed([0.0, 0.0, 3.0 * f64::from(i)], [4.0, 4.0, 3.0 * f64::from(i) + 0.125]), false);
    let found = cut(&scene((0..2).map(plate).collect()), Axis::Z, &metres());
    assert_eq!(found.cells.len(), 2, "{found:?}");
}

/// Kilometres, metres, Quake's units, inches, centimetres, millimetres.
const SCALES: [f64; 6] = [0.001, 1.0, 32.0, 39.3701, 100.0, 1000.0];

fn scaled(scene: &Scene, by: f64) -> Scene {
    let objects = scene.objects().iter();
    let objects =
        objects.map(|o| SceneObject { vertices: o.vertices.iter().map(|p| p.map(|x| x * by)).collect(), ..o.clone() });
    let scaled = Scene::new(objects.collect()).and_then(|s| s.with_see_through(scene.see_through().to_vec()));
    let scaled = scaled.and_then(|s| s.with_single_sided(scene.single_sided().to_vec()));
    scaled.and_then(|s| s.with_front_occluders(scene.front_occluders().to_vec())).expect("a scene")
}

/// Scales at which the number of units in a metre is not the scale, but for a third.
fn mistaken(scene: &Scene, up: Axis, told: Option<f64>, scales: &[f64]) -> Vec<(f64, f64, UnitsFrom)> {
    let options = EyeLevelOptions { units_per_metre: told, ..EyeLevelOptions::default() };
    let units = |by: f64| {
        let summary = cut(&scaled(scene, by), up, &options).summary;
        (by, summary.units_per_metre, summary.units_from)
    };
    let is_off = |&(by, units, _): &(f64, f64, UnitsFrom)| !(0.75..=4.0 / 3.0).contains(&(units / by));
    scales.iter().copied().map(units).filter(is_off).collect()
}

#[test]
fn units_are_recognised() {
    let small = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let tower = tower(small).expect("a tower");
    assert_eq!(mistaken(&tower, Axis::Y, None, &SCALES), []);
    assert_eq!(cut(&tower, Axis::Y, &EyeLevelOptions::default()).summary.units_from, UnitsFrom::Metres);
    let summary = cut(&scaled(&tower, 100.0), Axis::Y, &EyeLevelOptions::default()).summary;
    assert!(
        matches!(summary.units_from, UnitsFrom::Clearances(median) if (200.0..350.0).contains(&median)),
        "{summary:?}"
    );
    // Outside there are no ceilings, but things.
    let city = city_of_boxes([1, 1]);
    let wrong = mistaken(&city, Axis::Y, None, &SCALES);
    assert!(wrong.iter().all(|of| of.0 != 1.0 && (0.099..10.1).contains(&(of.1 / of.0))), "{wrong:?}");
    let summary = cut(&scaled(&city, 1000.0), Axis::Y, &EyeLevelOptions::default()).summary;
    assert!(matches!(summary.units_from, UnitsFrom::Objects(_)), "{summary:?}");
    // The impostor: who is told that all units are metres is wrong wherever they are not, and the same cells are of another size.
    assert_eq!(mistaken(&tower, Axis::Y, Some(1.0), &[0.001, 1.0, 32.0]).len(), 2);
    let told = EyeLevelOptions { units_per_metre: Some(2.0), ..EyeLevelOptions::default() };
    let summary = cut(&tower, Axis::Y, &told).summary;
    assert_eq!((summary.units_from, summary.cell_size, summary.eye_height), (UnitsFrom::Options, 2.0, [0.0, 5.0]));
}

/// Where nothing is said, cells are at the height of eyes only if the file states what is up, and viewers do not fly.
#[test]
fn scenes_with_few_walls_along_axes_have_these_cells() {
    let glb = parse_glb(&write_glb(&hills()).expect("single precision"), None).expect("a scene");
    let obj = SceneInfo { up_is_assumed: true, ..glb.info.clone() };
    let cells = |request: &BakeRequest, info: Option<&SceneInfo>| {
        let prepared = request.prepare(BakeInput::Scene(&glb.scene, info), &Runtime::default()).expect("a recipe");
        prepared.recipe().cells.clone()
    };
    let plain = BakeRequest::default;
    let at_eyes = |request: &BakeRequest| matches!(cells(request, Some(&glb.info)), CellsFrom::EyeLevel(_));
    let auto = BakeRequest { method: Some(SceneMethod::Auto), ..plain() };
    assert!(at_eyes(&plain()) && at_eyes(&auto));
    let named = BakeRequest { method: Some("shafts".parse().expect("a method")), ..plain() };
    let split = BakeRequest { split: Some(Split { depth: 1, ..Split::default() }), ..plain() };
    let region = BakeRequest { view_region: Some(glb.scene.bounds()), ..plain() };
    assert!([named, split, region].iter().all(|request| !at_eyes(request)));
    for info in [Some(&obj), None] {
        assert!(matches!(cells(&plain(), info), CellsFrom::Places(_)));
    }
    // A width alone says nothing of what cells are; along axes it takes the place of a k-d tree.
    let wide = |request: BakeRequest| BakeRequest { cell_size: Some(3.0), ..request };
    let of_eyes = CellsFrom::EyeLevel(EyeLevelOptions {
        cell_size: Some(3.0),
        up: Some(glb.info.up),
        ..EyeLevelOptions::default()
    });
    let anywhere = CellsFrom::Places(PlaceOptions { n_cells: None, cell_size: Some(3.0) });
    assert_eq!(cells(&wide(plain()), Some(&glb.info)), of_eyes);
    assert_eq!(cells(&wide(plain()), Some(&obj)), anywhere);
    assert_eq!(cells(&wide(BakeRequest { for_proofs: true, ..plain() }), Some(&glb.info)), anywhere);
    let grid = wide(BakeRequest { cells: Some(CellsFrom::Grid([1; 3])), ..plain() });
    let refused = grid.prepare(BakeInput::Scene(&glb.scene, Some(&glb.info)), &Runtime::default());
    assert!(refused.expect_err("cells have their widths").to_string().contains("cell_size"));
}

#[test]
fn limits_hold() {
    let lift = on_ground(block(&boxed([0.0; 3], [1.0; 3]), false));
    // The limit widens cells that nobody asked for.
    let limited = |options: &EyeLevelOptions, limit| eye_level_cells(&lift, Axis::Z, None, options, limit, None);
    let few = limited(&EyeLevelOptions { cell_size: None, ..metres() }, 10).expect("wide cells");
    assert!(few.cells.len() <= 10 && few.summary.cell_size == 16.0, "{:?}", few.summary);
    let wide = EyeLevelOptions { cell_size: Some(4.0), ..metres() };
    assert_eq!(limited(&wide, 10), Err(EyeLevelError::TooMany { cell_size: 4.0, limit: 10 }));
    assert!(matches!(limited(&metres(), 0), Err(EyeLevelError::TooMany { limit: 0, .. })));
    let tiny = EyeLevelOptions { cell_size: Some(1e-9), ..metres() };
    assert_eq!(limited(&tiny, MANY), Err(EyeLevelError::TooMany { cell_size: 1e-9, limit: MANY }));
}

#[test]
fn what_cannot_be_cut_is_named() {
    let ground = on_ground(block(&boxed([0.0; 3], [1.0; 3]), false));
    let cut = |scene: &Scene, region: Option<Aabb<3>>, options: EyeLevelOptions| {
        eye_level_cells(scene, Axis::Z, region.as_ref(), &options, MANY, None).map(|_| ()).expect_err("refused")
    };
    let with = |cell_size, eye_height| EyeLevelOptions { cell_size, eye_height, ..metres() };
    let units = EyeLevelOptions { units_per_metre: Some(f64::NAN), ..EyeLevelOptions::default() };
    assert_eq!(
        cut(&ground, None, with(Some(0.0), None)).to_string(),
        "the width of cells is 0: this is not a number above 0"
    );
    assert_eq!(
        cut(&ground, None, units).to_string(),
        "the number of units in a metre is NaN: this is not a number above 0"
    );
    let eyes = cut(&ground, None, with(None, Some([2.0, 1.0])));
    assert_eq!(
        eyes.to_string(),
        "eyes from 2 to 1 units above floors: the second number has to be larger, and both finite"
    );
    assert_eq!(cut(&Scene::default(), None, metres()), EyeLevelError::Region(KdError::Empty));
    assert_eq!(cut(&ground, Some(Aabb::EMPTY), metres()), EyeLevelError::Region(KdError::ViewRegion));
    let flat = boxed([0.0; 3], [1.0, 1.0, 0.0]);
    assert_eq!(cut(&ground, Some(flat), metres()), EyeLevelError::Region(KdError::Flat { axis: 2 }));
    let away = boxed([0.0, 0.0, 50.0], [1.0, 1.0, 60.0]);
    assert_eq!(cut(&ground, Some(away), metres()), EyeLevelError::NoFloor);
    let far = with(None, Some([0.0, 1e70]));
    assert!(matches!(cut(&ground, None, far), EyeLevelError::Bounds(_)));
    let wall = scene(vec![SceneObject {
        name: String::new(),
        vertices: vec![[0.0; 3], [4.0, 1.0, 0.0], [4.0, 1.0, 4.0]],
        triangles: vec![[0, 1, 2]],
    }]);
    assert_eq!(cut(&wall, None, metres()).to_string(), "no floor to stand on was found in the region");
    for phase in ["surfaces", "floors"] {
        let observer =
            |now: Progress| if now.phase == phase { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        let cancelled = eye_level_cells(&ground, Axis::Z, None, &metres(), MANY, Some(&observer));
        assert_eq!(cancelled, Err(EyeLevelError::Cancelled(Cancelled)), "{phase}");
    }
}

#[test]
fn threads_change_nothing() {
    let scene = hills();
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        pool.install(|| cut(&scene, Axis::Z, &EyeLevelOptions::default()))
    };
    assert_eq!(with(1), with(3));
}

/// Prints what becomes of real scenes, and checks places where people walk.
#[test]
fn real_scenes_have_cells_where_people_walk() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED: SIGHTLINES_DATA is not set, so real data is not tested");
        return;
    };
    let folder = std::path::Path::new(&data).join("scenes");
    // The least share of the places, in percent. Many of the streets of Delft are over gaps between its meshes.
    let scenes = [
        ("castle", "walk", 98),
        ("sponza", "walk", 98),
        ("pandora", "walk", 98),
        ("duplex", "walk", 98),
        ("delft", "street", 78),
        ("office_a", "rooms", 98),
    ];
    for (name, places, least) in scenes {
        let file = read_scene(folder.join(name).join(format!("{name}.glb"))).expect("a scene");
        let cells = read_view_cells(folder.join(name).join(format!("cells_{places}.json"))).expect("cells").cells;
        let start = Instant::now();
        let found = cut(&file.scene, file.info.up, &EyeLevelOptions::default());
        let seconds = start.elapsed().as_secs_f64();
        let middle = |b: &Aabb<3>| -> Point3 { std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0) };
        let n_inside = cells.iter().filter(|cell| inside(&found, middle(&cell.bounds))).count();
        eprintln!("{name}: {seconds:.1} s, {n_inside} of {} places; {:?}", cells.len(), found.summary);
        assert!(100 * n_inside >= least * cells.len(), "{name}");
    }
}
