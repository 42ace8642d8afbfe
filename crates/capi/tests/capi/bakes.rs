//! What C bakes is what Rust bakes.

use crate::common::{Handle, list, plans, towers};
use crate::same::compare_content;
use sightlines_bake::eye_level::EyeLevelOptions;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::places::PlaceOptions;
use sightlines_bake::region::CellsFrom;
use sightlines_bake::{BakeRequest, Gap, PlanBakeOptions, SceneMethod, bake, bake_plan};
use sightlines_capi::*;
use sightlines_cells::{MovingObject, Point3, Scene, SceneObject};
use sightlines_formats::ViewCells;
use sightlines_formats::view_cells::ViewCell;
use sightlines_geometry::Aabb;
use sightlines_pvs::Axis;
use sightlines_scenes::{TowerOptions, tower};
use std::collections::BTreeSet;
use std::ffi::CString;
use std::ptr;

/// A scene goes through the border object by object, and the table that comes back has the same bytes.
#[test]
fn bakes_are_those_of_rust() {
    let options = BakeRequest::default();
    let mut n = 0;
    for scene in towers() {
        let expected = bake(&scene, &options).expect("a scene").table.to_bytes();
        let mut handle = ptr::null_mut();
        // SAFETY: handles live until they are freed; all pointers are to live memory of the stated sizes.
        unsafe {
            assert_eq!(sl_scene_new(&mut handle), SL_OK);
            for object in scene.objects() {
                let name = CString::new(object.name.as_str()).expect("no zeros");
                let (vertices, triangles) = (object.vertices.as_flattened(), object.triangles.as_flattened());
                let [v, i] = [vertices.len() / 3, triangles.len()];
                let mut id = SL_NONE;
                let status =
                    sl_scene_add_object(handle, name.as_ptr(), vertices.as_ptr(), v, triangles.as_ptr(), i, 0, &mut id);
                assert_eq!(status, SL_OK);
            }
            for threads in [1, 3] {
                let mut given = std::mem::zeroed::<SlBakeOptions>();
                (given.struct_size, given.threads) = (size_of::<SlBakeOptions>(), threads);
                let mut table = ptr::null_mut();
                assert_eq!(sl_bake(handle, &given, &mut table, ptr::null_mut()), SL_OK);
                assert_eq!(list(|to, size, n| sl_table_bytes(table, SL_FORM_PLAIN, to, size, n)), expected);
                let packed = list(|to, size, n| sl_table_bytes(table, SL_FORM_PACKED, to, size, n));
                assert!(packed.len() < expected.len());
                let again = Handle::of(&packed);
                assert_eq!(list(|to, size, n| sl_table_bytes(again.0, SL_FORM_PLAIN, to, size, n)), expected);
                sl_table_free(table);
                n += 1;
            }
            let mut given = std::mem::zeroed::<SlBakeOptions>();
            (given.struct_size, given.parts) = (size_of::<SlBakeOptions>(), 6);
            let mut table = ptr::null_mut();
            assert_eq!(sl_bake(handle, &given, &mut table, ptr::null_mut()), SL_OK);
            let expected = bake(&scene, &BakeRequest { parts: Some(6), ..options.clone() }).expect("a scene").table;
            assert!(!expected.object_parts().is_empty());
            assert_eq!(list(|to, size, n| sl_table_bytes(table, SL_FORM_PLAIN, to, size, n)), expected.to_bytes());
            assert_eq!(compare_content(&expected, &Handle(table))[1], 0);
            given.request = c"{\"parts\": 6}".as_ptr();
            let mut twice = ptr::null_mut();
            assert_eq!(sl_bake(handle, &given, &mut twice, ptr::null_mut()), SL_ERROR_ARGUMENT);
            (given.parts, given.request) = (0, c"{\"parts\": 6, \"n_cell\": 4}".as_ptr());
            assert_eq!(sl_bake(handle, &given, &mut twice, ptr::null_mut()), SL_ERROR_ARGUMENT);
            let text = c"{\"parts\": 6, \"n_cells\": 9, \"method\": \"shafts\", \"split\": 1}";
            given.request = text.as_ptr();
            assert_eq!(sl_bake(handle, &given, &mut twice, ptr::null_mut()), SL_OK);
            let request = BakeRequest::from_json(text.to_str().expect("a text")).expect("a request");
            let request = BakeRequest { gap: options.gap, ..request };
            let expected = bake(&scene, &request).expect("a scene").table;
            assert_eq!(list(|to, size, n| sl_table_bytes(twice, SL_FORM_PLAIN, to, size, n)), expected.to_bytes());
            sl_table_free(twice);
            sl_scene_free(handle);
        }
    }
    for plan in plans().into_iter().filter(|plan| plan.mirrors().is_empty() && plan.objects().is_empty()) {
        let walls: Vec<f64> = plan.lines().iter().flat_map(|line| [line.a.x, line.a.y, line.b.x, line.b.y]).collect();
        let plain = plan.lines().iter().all(|line| line.opaque && line.left.is_none() && line.right.is_none());
        if !plain {
            continue;
        }
        let expected = bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").table.to_bytes();
        let mut table = ptr::null_mut();
        // SAFETY: all pointers are to live memory of the stated sizes.
        unsafe {
            let status = sl_bake_plan(walls.as_ptr(), walls.len() / 4, ptr::null(), &mut table, ptr::null_mut());
            assert_eq!(status, SL_OK);
            assert_eq!(list(|to, size, n| sl_table_bytes(table, SL_FORM_PLAIN, to, size, n)), expected);
            sl_table_free(table);
        }
        n += 1;
    }
    assert!(n >= 5, "{n}");
}

/// Flags and options mean what they mean in Rust.
#[test]
fn flags_and_options_are_those_of_rust() {
    const FLAGS: [u32; 7] = [
        0,
        SL_OBJECT_SEE_THROUGH,
        0,
        SL_OBJECT_MIRROR,
        SL_OBJECT_SINGLE_SIDED,
        SL_OBJECT_MOVING,
        SL_OBJECT_DOOR | SL_OBJECT_SINGLE_SIDED,
    ];
    let plain = towers().remove(0);
    let within = Aabb { min: [1.0, 0.5, 1.0], max: [3.0, 1.5, 2.0] };
    let with = |flag: u32| {
        let flagged = move |i: &u32| FLAGS[*i as usize % FLAGS.len()] & flag != 0;
        (0..plain.objects().len() as u32).filter(flagged).collect::<Vec<_>>()
    };
    // Those that move are 5, 12, 19, …: one of them stays in a box.
    let moving = with(SL_OBJECT_MOVING);
    assert!(moving.len() > 1 && with(SL_OBJECT_DOOR).len() > 1, "{} objects", plain.objects().len());
    let moves = |&object: &u32| MovingObject { object, within: (object == moving[0]).then_some(within) };
    let scene = plain
        .clone()
        .with_see_through(with(SL_OBJECT_SEE_THROUGH | SL_OBJECT_DOOR))
        .and_then(|scene| scene.with_doors(with(SL_OBJECT_DOOR)))
        .and_then(|scene| scene.with_mirrors(with(SL_OBJECT_MIRROR)))
        .and_then(|scene| scene.with_backs_culled(with(SL_OBJECT_SINGLE_SIDED)))
        .and_then(|scene| scene.with_moving(moving.iter().map(moves).collect()))
        .expect("a scene");
    let bounds = scene.bounds();
    let half = Aabb { min: bounds.min, max: std::array::from_fn(|k| (bounds.min[k] + bounds.max[k]) / 2.0) };
    let boxes = [half, bounds].map(|b| SlBox { min: b.min, max: b.max });
    let cell = |(i, b): (usize, &SlBox)| ViewCell { id: i.to_string(), bounds: Aabb { min: b.min, max: b.max } };
    let given = ViewCells { cells: boxes.iter().enumerate().map(cell).collect(), axes: None };
    // SAFETY: all zeros are a value of every field.
    let mut zero = unsafe { std::mem::zeroed::<SlBakeOptions>() };
    (zero.struct_size, zero.gap) = (size_of::<SlBakeOptions>(), 0.0);
    let exact = BakeRequest::default();
    let places = PlaceOptions { n_cells: Some(6), cell_size: None };
    let eyes = EyeLevelOptions {
        cell_size: Some(3.0),
        eye_height: Some([0.5, 2.0]),
        up: Some(Axis::Y),
        ..EyeLevelOptions::default()
    };
    let cases: [(SlBakeOptions, BakeRequest); 8] = [
        (zero, exact.clone()),
        (
            SlBakeOptions { cells: SL_CELLS_EYE_LEVEL, cell_size: 3.0, eye_height: [0.5, 2.0], up: 2, ..zero },
            BakeRequest { cells: Some(CellsFrom::EyeLevel(eyes)), ..exact.clone() },
        ),
        (SlBakeOptions { cell_size: 4.0, ..zero }, BakeRequest { cell_size: Some(4.0), ..exact.clone() }),
        (
            SlBakeOptions { cells: SL_CELLS_GRID, grid: [2, 1, 2], method: c"multifocal".as_ptr(), ..zero },
            BakeRequest {
                cells: Some(CellsFrom::Grid([2, 1, 2])),
                method: Some(SceneMethod::FromRegion(OcclusionMethod::Multifocal)),
                ..exact.clone()
            },
        ),
        (
            SlBakeOptions { cells: SL_CELLS_BOXES, boxes: boxes.as_ptr(), box_count: 2, ..zero },
            BakeRequest { cells: Some(CellsFrom::Boxes(given)), ..exact.clone() },
        ),
        (
            SlBakeOptions { cells: SL_CELLS_PLACES, place_count: 6, method: c"both".as_ptr(), ..zero },
            BakeRequest { cells: Some(CellsFrom::Places(places)), method: Some(SceneMethod::Both), ..exact.clone() },
        ),
        (
            SlBakeOptions {
                cells: SL_CELLS_KD_TREE,
                view_region: &boxes[0],
                keep_solid: 1,
                detail_below: -1.0,
                ..zero
            },
            BakeRequest {
                cells: Some(CellsFrom::KdTree),
                view_region: Some(half),
                keep_solid: true,
                detail_below: Some(0.0),
                ..exact.clone()
            },
        ),
        (
            SlBakeOptions { gap: 0.01, detail_below: 0.5, method: c"auto".as_ptr(), cells: SL_CELLS_KD_TREE, ..zero },
            BakeRequest {
                gap: Gap::Width(0.01),
                cells: Some(CellsFrom::KdTree),
                detail_below: Some(0.5),
                method: Some(SceneMethod::Auto),
                ..exact.clone()
            },
        ),
    ];
    let mut handle = ptr::null_mut();
    let mut all = BTreeSet::new();
    // SAFETY: handles live until they are freed; all pointers are to live memory of the stated sizes.
    unsafe {
        assert_eq!(sl_scene_new(&mut handle), SL_OK);
        for (i, object) in plain.objects().iter().enumerate() {
            let name = CString::new(object.name.as_str()).expect("no zeros");
            let (vertices, triangles) = (object.vertices.as_flattened(), object.triangles.as_flattened());
            let (n_vertices, n_indices, flags) = (vertices.len() / 3, triangles.len(), FLAGS[i % FLAGS.len()]);
            let (vertices, indices, name) = (vertices.as_ptr(), triangles.as_ptr(), name.as_ptr());
            let status =
                sl_scene_add_object(handle, name, vertices, n_vertices, indices, n_indices, flags, ptr::null_mut());
            assert_eq!(status, SL_OK);
        }
        let stays = SlBox { min: within.min, max: within.max };
        assert_eq!(sl_scene_set_motion(handle, moving[0], &stays), SL_OK);
        for (i, (given, options)) in cases.iter().enumerate() {
            let expected = bake(&scene, options).expect("a scene").table;
            let mut table = ptr::null_mut();
            assert_eq!(sl_bake(handle, given, &mut table, ptr::null_mut()), SL_OK, "case {i}");
            let bytes = list(|to, size, n| sl_table_bytes(table, SL_FORM_PLAIN, to, size, n));
            assert!(bytes == expected.to_bytes(), "case {i}");
            assert_eq!(compare_content(&expected, &Handle(table))[1], 0, "case {i}");
            all.insert(bytes);
        }
        sl_scene_free(handle);
    }
    assert_eq!(all.len(), cases.len(), "every option changes something");
}

/// Files by path: written, read, and errors that name the path.
#[test]
fn files_are_written_and_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a table.pvz");
    let path = CString::new(path.to_str().expect("UTF-8")).expect("no zeros");
    let table = bake_plan(&plans()[0], &PlanBakeOptions::default()).expect("a plan").table;
    let c = Handle::of(&table.to_bytes());
    let mut again = ptr::null_mut();
    // SAFETY: handles live until they are freed; texts end with zeros.
    unsafe {
        assert_eq!(sl_table_save(c.0, path.as_ptr(), SL_FORM_PACKED), SL_OK);
        assert_eq!(sl_table_load(path.as_ptr(), &mut again), SL_OK);
        assert_eq!(compare_content(&table, &Handle(again))[1], 0);
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing else is left");
        std::fs::write(folder.path().join("a table.pvz"), b"\x89PVP\r\n\x1a\nand no more").expect("it is writable");
        assert_eq!(sl_table_load(path.as_ptr(), &mut again), SL_ERROR_FORMAT);
        let message = std::ffi::CStr::from_ptr(sl_last_error()).to_str().expect("UTF-8").to_owned();
        assert!(message.contains("a table.pvz: ") && again.is_null(), "{message}");
    }
}

/// A floor whose corners were moved, in single precision.
fn moved(change: impl Fn(Point3) -> Point3) -> Scene {
    let floor = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let upright = tower(TowerOptions { windows: false, ..floor }).expect("a floor");
    let single = |p: &Point3| change(*p).map(|x| f64::from(x as f32));
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(single).collect(), ..o.clone() };
    Scene::new(upright.objects().iter().map(object).collect()).expect("a scene")
}

/// The bytes of the table of a scene that C was given in single precision, or, but for the last object, so.
fn by_c(scene: &Scene, gap: f64, is_single: bool) -> Vec<u8> {
    let mut handle = ptr::null_mut();
    // SAFETY: handles live until they are freed; all pointers are to live memory of the stated sizes.
    unsafe {
        assert_eq!(sl_scene_new(&mut handle), SL_OK);
        for (i, o) in scene.objects().iter().enumerate() {
            let name = CString::new(o.name.as_str()).expect("no zeros");
            let (doubles, triangles) = (o.vertices.as_flattened(), o.triangles.as_flattened());
            let singles: Vec<f32> = doubles.iter().map(|x| *x as f32).collect();
            let ([v, n], t) = ([doubles.len() / 3, triangles.len()], triangles.as_ptr());
            let (name, nowhere) = (name.as_ptr(), ptr::null_mut());
            let status = if is_single || i + 1 < scene.objects().len() {
                sl_scene_add_object_f32(handle, name, singles.as_ptr(), v, t, n, 0, nowhere)
            } else {
                sl_scene_add_object(handle, name, doubles.as_ptr(), v, t, n, 0, nowhere)
            };
            assert_eq!(status, SL_OK);
        }
        let mut options = std::mem::zeroed::<SlBakeOptions>();
        (options.struct_size, options.gap) = (size_of::<SlBakeOptions>(), gap);
        let mut table = ptr::null_mut();
        assert_eq!(sl_bake(handle, &options, &mut table, ptr::null_mut()), SL_OK);
        let bytes = list(|to, size, n| sl_table_bytes(table, SL_FORM_PLAIN, to, size, n));
        sl_table_free(table);
        sl_scene_free(handle);
        bytes
    }
}

/// With nothing said, walls in single precision that stand at an angle are walls, as those of a file are.
#[test]
fn single_precision_is_known_for_what_it_is() {
    let slanted = moved(|[x, y, z]| [x + 0.25 * z, y, z + 0.125 * x]);
    let turned = moved(|[x, y, z]| [0.8 * x - 0.6 * z, y, 0.6 * x + 0.8 * z]);
    // Walls along one of two directions are walls in a frame, too.
    for scene in [slanted, turned] {
        let by_rust = |gap| bake(&scene, &BakeRequest { gap, ..BakeRequest::default() }).expect("a table").table;
        let [single, exact] = [Gap::OfSingle, Gap::OfFile].map(by_rust);
        assert!(single.frame().is_some() && exact.frame().is_none());
        assert!(single.mean_visible_share() < 0.999 && exact.mean_visible_share() < 0.999, "something is hidden");
        let [single, exact] = [single, exact].map(|table| table.to_bytes());
        assert!(by_c(&scene, 0.0, true) == single);
        // The impostors: a coordinate in double precision, and a gap that takes all as they are.
        assert!(by_c(&scene, 0.0, false) == exact && by_c(&scene, -1.0, true) == exact);
    }
}
