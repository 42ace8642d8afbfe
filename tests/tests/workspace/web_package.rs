//! The package for browsers against the crates: it is packed, and Node runs its tests on tables that are made here, with the sets that the
//! crates find. Without Node these tests do not run, and say so; the page with three.js needs three.js and Chromium as well.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, Bakeable, CellsFrom, Gap, Subdivide, bake};
use sightlines::cells::{Plan, Scene, SceneObject};
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::Source;
use sightlines::formats::quake::{Bsp, BspFormat};
use sightlines::formats::scene::write_glb;
use sightlines::geometry::Aabb;
use sightlines::pvs::{BitMatrix, CellId, DoorBox, DoorId, ObjectId, Place, Table};
use sightlines::relevance::{Body, ReachOptions, Reaches, Relevance, RelevanceOptions};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_testkit::browser::{Opened, chromium};
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::data_folder;
use sightlines_tests::world_files::{bsp_bytes, prt_of_world};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Eyes that are looked from in each table, and views and pairs of eyes in each.
const N_EYES: usize = 1000;
const N_VIEWS: usize = 60;
const FOV: f64 = 1.2;
const ASPECT: f64 = 1.5;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A program with these arguments; what it prints if it succeeds.
fn run(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    if output.status.success() { Ok(text) } else { Err(text) }
}

/// The packed package, if there is Node.
fn package() -> Option<&'static Path> {
    static PACKED: OnceLock<Option<tempfile::TempDir>> = OnceLock::new();
    let packed = PACKED.get_or_init(|| {
        if let Err(error) = run(Command::new("node").arg("--version")) {
            eprintln!("NOT RUN: there is no Node in the path, so the package for browsers is not tested: {error}");
            return None;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let script = root().join("integrations/web/pack.mjs");
        run(Command::new("node").arg(script).arg(folder.path())).unwrap_or_else(|error| panic!("{error}"));
        Some(folder)
    });
    packed.as_ref().map(tempfile::TempDir::path)
}

/// Runs the tests of a file below `integrations/web/test` on the package, with a folder of cases.
fn node_test(package: &Path, name: &str, cases: &Path) -> Result<String, String> {
    let test = root().join("integrations/web/test").join(name);
    let mut command = Command::new("node");
    command.arg("--test").arg(test).env("SIGHTLINES_PACKAGE", package).env("SIGHTLINES_CASES", cases);
    run(&mut command)
}

struct Chance(SplitMix);

impl Chance {
    fn share(&mut self) -> f64 {
        (self.0.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A point in or around a cell, for some numbers on its border.
    fn eye(&mut self, table: &Table, k: usize) -> [f64; 3] {
        let cell = &table.cells()[(self.share() * table.n_cells() as f64) as usize];
        let p = std::array::from_fn(|axis| {
            let (low, high) = (cell.min[axis], cell.max[axis]);
            match k % 8 {
                0 if axis == 0 => low,
                1 => low + (1.4 * self.share() - 0.2) * (high - low),
                _ => low + self.share() * (high - low),
            }
        });
        table.frame().map_or(p, |frame| frame.to_scene(p))
    }
}

/// Eyes with the cells there, and with the cells and objects that the table says may be seen.
fn eyes(table: &Table, n: usize) -> Value {
    let mut chance = Chance(SplitMix::new(11));
    let look = |k| {
        let eye = chance.eye(table, k);
        let Place::Inside(here) = table.place_at(eye) else { return json!({ "eye": eye, "at": [] }) };
        let cells: Vec<u32> = here.visible_cells().map(|id| id.0).collect();
        let objects: Vec<u32> = here.visible_objects().iter().map(|id| id.0).collect();
        let at: Vec<u32> = here.cells().iter().map(|id| id.0).collect();
        json!({ "eye": eye, "at": at, "cells": cells, "objects": objects })
    };
    (0..n).map(look).collect::<Vec<_>>().into()
}

/// Views, each with some doors shut, and what each method keeps. Without stab trees, along which the crate goes and the package does not.
fn views(table: &Table, n: usize) -> Value {
    let mut parts = table.clone().into_parts();
    parts.stab = None;
    let table = &Table::new(parts).expect("a table");
    let cells = TableCells::new(table);
    let up =
        table.up().map_or([0.0, 1.0, 0.0], |axis| std::array::from_fn(|k| f64::from(u8::from(k == axis as usize))));
    let mut chance = Chance(SplitMix::new(5));
    let (mut scratch, mut seen, mut list) = (Scratch::new(), VisibleSet::new(), Vec::new());
    for k in 0..8 * n {
        let (eye, angle, slope) =
            (chance.eye(table, 2), chance.share() * std::f64::consts::TAU, 0.6 * chance.share() - 0.3);
        let Place::Inside(here) = table.place_at(eye) else { continue };
        let dir = match (table.dimension(), up) {
            (2, _) => [angle.cos(), angle.sin(), 0.0],
            (_, [_, _, 1.0]) => [angle.cos(), angle.sin(), slope],
            _ => [angle.cos(), slope, angle.sin()],
        };
        let shut: Vec<u32> = (0..table.doors().len() as u32).filter(|_| chance.share() < 0.5).collect();
        let mut doors = Doors::all_open();
        for &door in &shut {
            doors.close_door(table.doors(), DoorId(door));
        }
        let is_all_round = k % 5 == 0;
        let view = match table.dimension() {
            _ if is_all_round => View::all_round(eye),
            2 => View::planar([eye[0], eye[1]], [dir[0], dir[1]], FOV),
            _ => View::perspective_horizontal(eye, dir, up, FOV, ASPECT),
        };
        let view = view.expect("a view");
        let subgraphs: Vec<_> = here
            .cells()
            .iter()
            .map(|&cell| VisibleSubgraph::prepare(&cells, cell).expect("a table in memory"))
            .collect();
        let mut kept = Vec::new();
        for method in Method::ALL {
            seen.clear(table.n_cells(), table.objects().len());
            for subgraph in &subgraphs {
                method.look(subgraph, &view, &doors, &mut scratch, &mut seen);
            }
            seen.sort();
            let cells: Vec<u32> = seen.cells().iter().map(|id| id.0).collect();
            let objects: Vec<u32> = seen.objects().iter().map(|id| id.0).collect();
            kept.push(json!({ "cells": cells, "objects": objects }));
        }
        let dir = (!is_all_round).then_some(dir);
        list.push(
            json!({ "eye": eye, "dir": dir, "fov": FOV, "aspect": ASPECT, "up": up, "shut": shut, "kept": kept }),
        );
        if list.len() == n {
            break;
        }
    }
    list.into()
}

/// Pairs of eyes, and the crate's lower bound of the time until sight at these speeds; without a number if that is never.
fn times(table: &Table, n: usize) -> Value {
    let Ok(reaches) = Reaches::of(table, &ReachOptions::default()) else { return json!([]) };
    let mut relevance = Relevance::new(table.clone(), reaches, RelevanceOptions::of(table));
    let mut chance = Chance(SplitMix::new(3));
    let mut point = |k: usize| {
        let p = chance.eye(table, k);
        (p, Aabb { min: p, max: p })
    };
    let mut time = |k: usize| {
        let ((a, at_a), (b, at_b)) = (point(k), point(2));
        let speeds = [[1.0, 1.0], [2.0, 0.5], [3.0, 0.0]][k % 3];
        let seconds = relevance.time_to_sight(&Body::new(at_a, at_a), &Body::new(at_b, at_b), speeds);
        json!({ "a": a, "b": b, "speeds": speeds, "seconds": seconds.is_finite().then_some(seconds) })
    };
    (0..n).map(&mut time).collect::<Vec<_>>().into()
}

/// The same table but for one pair of cells that some eye looks from and to, which is hidden.
fn with_one_pair_hidden(table: &Table, eyes: &Value) -> Table {
    let looked_from = |cell: usize| eyes.as_array().expect("a list").iter().any(|eye| eye["at"] == json!([cell]));
    let pair = (0..table.n_cells()).filter(|&cell| looked_from(cell)).find_map(|a| {
        let b = table.visible(CellId(a as u32)).map(CellId::idx).find(|&b| b != a)?;
        Some((a, b))
    });
    let (a, b) = pair.expect("some eye is in a cell that sees another");
    let mut parts = table.clone().into_parts();
    parts.rows.set(a, b, false);
    parts.rows.set(b, a, false);
    parts.stab = None;
    Table::new(parts).expect("a table")
}

/// Runs the comparison on a table: plain, packed in both ways, and with one pair hidden.
fn check(name: &str, table: &Table) {
    let Some(package) = package() else { return };
    let cases = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| fs::write(cases.path().join(name), bytes).expect("a file");
    let eyes = eyes(table, N_EYES);
    let n_inside = eyes.as_array().expect("a list").iter().filter(|eye| eye["at"] != json!([])).count();
    assert!(n_inside > N_EYES / 3, "{name}: {n_inside} of {N_EYES} eyes in cells");
    write("plain.pvs", &table.to_bytes());
    for class in SizeClass::ALL {
        let options = PackOptions { class: Some(class), ..PackOptions::default() };
        write(&format!("{}.pvz", class.name()), &pack(table, &options).expect("a table is packed"));
    }
    write("impostor.pvs", &with_one_pair_hidden(table, &eyes).to_bytes());
    let names: Vec<&str> = table.objects().iter().map(|object| &*object.name).collect();
    let ids = (0..table.objects().len() as u32).map(ObjectId);
    let sources: Vec<_> = ids.map(|id| table.source_of(id).map(|source| [source.node, source.primitive])).collect();
    let doors: Vec<_> = table
        .doors()
        .iter()
        .map(|door| json!([door.name, door.portals.iter().map(|p| p.0).collect::<Vec<_>>()]))
        .collect();
    let case = json!({
        "name": name, "eyes": eyes, "views": views(table, N_VIEWS), "times": times(table, N_VIEWS),
        "names": names, "sources": sources, "doors": doors, "hasPlaces": table.has_places(),
    });
    write("case.json", case.to_string().as_bytes());
    let told = node_test(package, "agree.test.mjs", cases.path()).unwrap_or_else(|error| panic!("{name}: {error}"));
    for line in told.lines().filter(|line| line.contains("compared")) {
        println!("{name}: {line}");
    }
    assert!(told.contains("compared"), "{name}: {told}");
}

fn baked<'a>(input: impl Into<sightlines::bake::BakeInput<'a>>, request: &BakeRequest) -> Table {
    bake(input, request).expect("a table").table
}

fn small_tower() -> Scene {
    tower(TowerOptions { floors: 2, ..TowerOptions::default() }).expect("a tower")
}

#[test]
fn what_the_package_declares_and_weighs_is_so() {
    let Some(package) = package() else { return };
    let cases = tempfile::tempdir().expect("a folder");
    let plan: Plan = office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office");
    let tower = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).expect("a tower");
    for (name, table) in
        [("plan", baked(&plan, &BakeRequest::default())), ("tower", baked(&tower, &BakeRequest::default()))]
    {
        let write = |ending: &str, bytes: &[u8]| {
            fs::write(cases.path().join(format!("{name}-{ending}")), bytes).expect("a file");
        };
        write("plain.pvs", &table.to_bytes());
        for class in SizeClass::ALL {
            let options = PackOptions { class: Some(class), ..PackOptions::default() };
            write(&format!("{}.pvz", class.name()), &pack(&table, &options).expect("a table is packed"));
        }
    }
    let told = node_test(package, "package.test.mjs", cases.path()).unwrap_or_else(|error| panic!("{error}"));
    assert!(told.contains("# fail 0") && !told.contains("# pass 0"), "{told}");
    assert_eq!(told.matches("with checksums mended").count(), 7, "{told}");
}

#[test]
fn the_adapter_hides_for_its_camera_only() {
    let Some(package) = package() else { return };
    let told = node_test(package, "three.test.mjs", package).unwrap_or_else(|error| panic!("{error}"));
    assert!(told.contains("# fail 0") && !told.contains("# pass 0"), "{told}");
}

#[test]
fn plans_are_as_in_the_crates() {
    let plan: Plan = office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office");
    check("k-d tree", &baked(&plan, &BakeRequest::default()));
    let triangles = BakeRequest { subdivide: Some(Subdivide::Triangulation), ..BakeRequest::default() };
    check("triangulation", &baked(&plan, &triangles));
}

#[test]
fn buildings_with_doors_are_as_in_the_crates() {
    let table = baked(&small_tower(), &BakeRequest::default());
    let around = |k: usize| {
        let bounds = Aabb::around(table.portals()[k].points.iter().copied());
        DoorBox { name: format!("door {}", k % 3), min: bounds.min, max: bounds.max }
    };
    let boxes: Vec<DoorBox> = (0..table.portals().len()).step_by(9).map(around).collect();
    let table = table.with_door_boxes(&boxes);
    assert!(table.doors().len() > 10);
    check("tower", &table);
}

#[test]
fn boxes_that_leave_gaps_are_as_in_the_crates() {
    let grid = BakeRequest { cells: Some(CellsFrom::Grid([6, 4, 5])), ..BakeRequest::default() };
    let table = baked(&small_tower(), &grid);
    assert!(table.portals().is_empty());
    check("grid", &table);
}

#[test]
fn turned_buildings_are_as_in_the_crates() {
    let scene = tower(TowerOptions { floors: 1, rooms_x: 3, rooms_y: 2, ..TowerOptions::default() }).expect("a tower");
    let (s, c) = 0.4f64.sin_cos();
    let turn = |[x, y, z]: &[f64; 3]| [c * x + s * z, *y, c * z - s * x].map(|x| f64::from(x as f32));
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(turn).collect(), ..o.clone() };
    let turned = Scene::new(scene.objects().iter().map(object).collect()).expect("a scene");
    let table = baked(&turned, &BakeRequest { gap: Gap::Width(1e-4), ..BakeRequest::default() });
    assert!(table.frame().is_some());
    check("turned", &table);
}

#[test]
fn quake_maps_are_as_in_the_crates() {
    let world = quake_like(QuakeLikeOptions { seed: 5, rooms_x: 3, rooms_y: 2, floors: 2 }).expect("few rooms");
    let bsp = Bsp::parse(bsp_bytes(&world, BspFormat::Bsp29)).expect("a map");
    check("quake", &baked((&bsp, &prt_of_world(&world)), &BakeRequest::default()));
}

#[test]
fn real_scenes_are_as_in_the_crates() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    for name in
        ["plans/duplex_0.geojson", "doom/freedoom1_E1M1.wad", "scenes/whale_large/whale_large.glb", "quake/e1m7.bsp"]
    {
        let read = Bakeable::read(&Source::File(&data.join(name)), None).expect("real input is read");
        check(name, &bake(&read, &BakeRequest::default()).expect("a table").table);
    }
}

/// What the check tells of the example page with a scene and a table.
fn example_page(browser: &Path, three: &Path, folder: &Path, table: &Table) -> Value {
    let file = |name: &str| folder.join(name);
    fs::write(file("table.pvs"), table.to_bytes()).expect("a file");
    let package = package().expect("there is Node");
    let mut make = Command::new("node");
    make.arg(package.join("examples/make.mjs")).arg(three).args(["scene.glb", "table.pvs", "page.html"].map(file));
    run(&mut make).unwrap_or_else(|error| panic!("{error}"));
    // Without smoothing, which shows what is behind hairline gaps between triangles.
    let html = fs::read_to_string(file("page.html")).expect("a page").replace("antialias: true", "antialias: false");
    let html = html.replace("<head>", "<head><!-- script-src 'sha256-'; -->");
    let given = json!({ "frames": 40 });
    let script = include_str!("../../../integrations/web/test/three_check.js");
    Opened { html: &html, script, given: &given, size: [320, 240], link: "" }.result(browser)
}

/// Pictures of the example page with and without culling are the same, shadows and other cameras included; with one pair hidden they are not.
#[test]
fn the_example_page_looks_the_same_with_and_without_culling() {
    let Some(three) = data_folder("SIGHTLINES_THREE") else { return };
    let (Some(_), Some(browser)) = (package(), chromium()) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.glb");
    fs::write(&scene, write_glb(&small_tower()).expect("a scene is written")).expect("a file");
    let read = Bakeable::read(&Source::File(&scene), None).expect("a scene is read");
    let table = baked(&read, &BakeRequest::default());
    assert!(table.has_sources());
    let told = example_page(&browser, &three, folder.path(), &table);
    println!("{told}");
    assert_eq!([&told["frames"], &told["wrong"], &told["wrongElsewhere"]], [40, 0, 0], "{told}");
    let n = |key: &str| told[key].as_u64().unwrap_or_else(|| panic!("{told}"));
    assert!(n("flat") * 3 < n("frames") * 2, "many frames show more than a wall: {told}");
    assert!(n("calls") * 10 < n("callsAll") * 9, "{told}");

    // The impostor: a table without one object that the picture needs.
    let pair = &told["needed"][0];
    let [cell, object] = [0, 1].map(|k| pair[k].as_u64().unwrap_or_else(|| panic!("{told}")) as usize);
    let mut parts = table.clone().into_parts();
    let mut seen = BitMatrix::new(table.n_cells(), table.objects().len());
    for k in 0..table.n_cells() {
        table.visible_objects(CellId(k as u32)).iter().for_each(|object| seen.set(k, object.idx(), true));
    }
    seen.set(cell, object, false);
    parts.objects_seen = Some(seen);
    let less = Table::new(parts).expect("a table");
    let told = example_page(&browser, &three, folder.path(), &less);
    assert!(told["wrong"].as_u64() > Some(0), "{told}");
}
