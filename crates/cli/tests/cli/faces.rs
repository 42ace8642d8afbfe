//! One request, several faces: the program, Rust, jobs and tiles make the same table of the same file, with nothing said and with each option.
//!
//! The tests of C compare it with Rust, and those of Python with the program.

use crate::common::quake::row_of_leafs;
use crate::common::{Folder, levels, one_floor};
use serde_json::json;
use sightlines::bake::places::PlaceOptions;
use sightlines::bake::{
    BakeInput, BakeRequest, Bakeable, BufferRequest, CellsFrom, Gap, Runtime, SceneMethod, Subdivide, bake,
};
use sightlines::cells::{Plan, Scene, SceneObject};
use sightlines::formats::quake::BspFormat;
use sightlines::formats::scene::{parse_glb, write_glb, write_obj};
use sightlines::formats::{Source, ViewCells, geojson};
use sightlines::geometry::{Aabb, Point2, Point3};
use sightlines::multifocal::Split;
use sightlines::pvs::Table;

/// A floor whose corners were moved: in single precision, as a file has them.
fn floor(moved: impl Fn(Point3) -> Point3) -> Vec<u8> {
    let single = |p: &Point3| moved(*p).map(|x| f64::from(x as f32));
    let upright = parse_glb(&one_floor(1, 0), None).expect("a floor").scene;
    let object = |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(single).collect(), ..o.clone() };
    write_glb(&Scene::new(upright.objects().iter().map(object).collect()).expect("a scene")).expect("single precision")
}

/// Walls that are not at right angles: no frame makes them so.
fn slanted() -> Vec<u8> {
    floor(|[x, y, z]| [x + 0.25 * z, y, z + 0.125 * x])
}

/// A building that stands at an angle in its file.
fn turned() -> Vec<u8> {
    floor(|[x, y, z]| [0.8 * x - 0.6 * z, y, 0.6 * x + 0.8 * z])
}

/// Two rooms with a door between them, and a third behind a wall without one.
fn walls() -> Vec<[f64; 4]> {
    vec![
        [0.0, 0.0, 12.0, 0.0],
        [12.0, 0.0, 12.0, 3.0],
        [12.0, 3.0, 0.0, 3.0],
        [0.0, 3.0, 0.0, 0.0],
        [4.0, 0.0, 4.0, 1.0],
        [4.0, 2.0, 4.0, 3.0],
        [8.0, 0.0, 8.5, 3.0],
    ]
}

fn plan() -> Plan {
    Plan::from_walls(walls().iter().map(|w| (Point2::new(w[0], w[1]), Point2::new(w[2], w[3])))).expect("a plan")
}

/// A folder with inputs of every kind.
fn inputs() -> Folder {
    let folder = Folder::new();
    folder.write("slanted.glb", slanted());
    folder.write("turned.glb", turned());
    folder.write("axial.glb", one_floor(2, 0));
    folder.write("viewers.glb", levels::blender_with_extras());
    folder.write("plan.geojson", geojson::write_plan(&plan()));
    let map = row_of_leafs(BspFormat::Bsp29);
    folder.write("map.bsp", map.bsp);
    folder.write("map.prt", map.prt);
    folder
}

const FILES: [&str; 7] =
    ["slanted.glb", "turned.glb", "axial.glb", "viewers.glb", "plan.geojson", "map.bsp", "map.prt"];

fn read(folder: &Folder, name: &str) -> Bakeable {
    Bakeable::read(&Source::File(&folder.path(name)), None).expect("it can be baked")
}

fn by_rust(input: &Bakeable, request: &BakeRequest) -> Table {
    bake(input, request).expect("a table").table
}

fn by_program(folder: &Folder, name: &str, args: &[&str]) -> Vec<u8> {
    folder.run(&[&["build", name, "-o", "out.pvs"], args].concat()).expect(0);
    folder.read("out.pvs")
}

#[test]
fn with_nothing_said_every_face_makes_the_same_table() {
    let folder = inputs();
    let standard = BakeRequest::default();
    for name in FILES {
        let input = read(&folder, name);
        let table = by_rust(&input, &standard);
        let expected = table.to_bytes();
        assert!(by_program(&folder, name, &[]) == expected, "{name}: the program");
        let job = format!("job-{name}");
        folder.run(&["job", "plan", "-o", &job, "--shards", "2", "build", name, "-o", "by-job.pvs"]).expect(0);
        folder.run(&["job", "work", &job]).expect(0);
        folder.run(&["job", "merge", &job]).expect(0);
        assert!(folder.read("by-job.pvs") == expected, "{name}: a job");
        // The impostor of each: what sightlines alone say.
        let sightlines = BakeRequest { method: Some(SceneMethod::Sightlines), ..BakeRequest::default() };
        if name == "slanted.glb" {
            assert!(by_rust(&input, &sightlines).to_bytes() != expected);
            assert!(table.mean_visible_share() < 0.999, "something is hidden");
        }
    }
}

/// A world of one tile: the table has the cells of the scene as boxes, and the same is visible.
#[test]
fn a_world_of_one_tile_is_the_scene() {
    let folder = inputs();
    let world = json!({"sightlines_world": 1, "border": 1, "tiles": [{"name": "one", "scene": "slanted.obj"}]});
    // Tiles stand along the axes of the world, and have no frame; decimals need none.
    let slanted = parse_glb(&slanted(), None).expect("a scene").scene;
    folder.write("slanted.obj", write_obj(&slanted).expect("a file"));
    folder.write("world.json", world.to_string());
    folder.run(&["tiles", "build", "world.json", "--method", "shafts", "--n-cells", "40", "-o", "out"]).expect(0);
    let tile = crate::common::names(&folder.path("out")).into_iter().find(|name| name.ends_with(".pvz"));
    folder.run(&["unpack", &format!("out/{}", tile.expect("a table")), "-o", "tile.pvs"]).expect(0);
    let tile = Table::from_bytes(&folder.read("tile.pvs")).expect("a table");
    let places = CellsFrom::Places(PlaceOptions { n_cells: Some(40), cell_size: None });
    let request = BakeRequest { cells: Some(places), method: method("shafts"), ..BakeRequest::default() };
    let whole = by_rust(&read(&folder, "slanted.obj"), &request);
    assert!(tile.cells() == whole.cells() && tile.n_cells() > 20, "{}", tile.n_cells());
    assert!(tile.parts().rows == whole.parts().rows && tile.parts().objects_seen == whole.parts().objects_seen);
    assert!(whole.mean_visible_share() < 0.999, "something is hidden");
}

/// A method by name.
fn method(name: &str) -> Option<SceneMethod> {
    Some(name.parse().expect("a method"))
}

/// A request as JSON, as Python, C and pages say it, from the arguments of the program.
fn as_json(args: &[&str]) -> String {
    let mut request = serde_json::Map::new();
    let mut args = args.iter().peekable();
    while let Some(name) = args.next() {
        let name = name.trim_start_matches('-').replace('-', "_");
        let value = match args.next_if(|value| !value.starts_with("--")) {
            None if name == "no_carry" => {
                request.insert("carry".to_owned(), false.into());
                continue;
            }
            None => true.into(),
            Some(value) => serde_json::from_str(value)
                .or_else(|_| serde_json::from_str(&format!("[{value}]")))
                .unwrap_or_else(|_| (*value).into()),
        };
        request.insert(name, value);
    }
    serde_json::Value::Object(request).to_string()
}

/// Options of scenes: what the program and Rust have for them.
fn options() -> Vec<(&'static str, BakeRequest)> {
    let plain = BakeRequest::default;
    let places = |n_cells, cell_size| Some(CellsFrom::Places(PlaceOptions { n_cells, cell_size }));
    let few = || BakeRequest { cells: places(Some(12), None), ..plain() };
    let grid = || BakeRequest { cells: Some(CellsFrom::Grid([3, 1, 2])), ..plain() };
    let sightlines = || BakeRequest { method: method("sightlines"), ..plain() };
    let small = BufferRequest { planes: Some(1), texels: Some(16), ..BufferRequest::default() };
    let walls_alone = BufferRequest { sheets: Some(0), carry: Some(false), occluders: Some(20), ..small };
    let view_region = Some(Aabb { min: [1.0, 0.5, 1.0], max: [9.0, 2.5, 9.0] });
    let split = Some(Split { depth: 1, ..Split::default() });
    let tau = Some(0.5);
    vec![
        ("--n-cells 12", few()),
        ("--cell-size 4", BakeRequest { cell_size: Some(4.0), ..plain() }),
        ("--n-cells 12 --cell-size 4", BakeRequest { cells: places(Some(12), Some(4.0)), ..plain() }),
        (
            "--method line-space --cell-size 4",
            BakeRequest { cell_size: Some(4.0), method: method("line-space"), ..plain() },
        ),
        ("--grid 3,1,2", grid()),
        ("--grid 3,1,2 --method line-space", BakeRequest { method: method("line-space"), ..grid() }),
        ("--method sightlines", sightlines()),
        ("--n-cells 12 --method auto", BakeRequest { method: method("auto"), ..few() }),
        ("--n-cells 12 --method shafts --split 1", BakeRequest { method: method("shafts"), split, ..few() }),
        (
            "--n-cells 12 --method multifocal --planes 1 --texels 16",
            BakeRequest { method: method("multifocal"), buffers: small, ..few() },
        ),
        (
            "--n-cells 12 --method both --planes 1 --texels 16 --sheets 0 --no-carry --occluders 20",
            BakeRequest { method: method("both"), buffers: walls_alone, ..few() },
        ),
        ("--n-cells 12 --view-region 1,0.5,1,9,2.5,9", BakeRequest { view_region, ..few() }),
        ("--n-cells 12 --gap 0.001", BakeRequest { gap: Gap::Width(0.001), ..few() }),
        ("--n-cells 12 --gap 0", BakeRequest { gap: Gap::Width(0.0), ..few() }),
        ("--method sightlines --detail-below 0.5", BakeRequest { detail_below: Some(0.5), ..sightlines() }),
        ("--method sightlines --keep-solid --tau 0.5", BakeRequest { keep_solid: true, tau, ..sightlines() }),
        ("--n-cells 12 --max-cells 40", BakeRequest { max_cells: Some(40), ..few() }),
    ]
}

#[test]
fn with_each_option_every_face_makes_the_same_table() {
    let folder = inputs();
    for name in ["slanted.glb", "turned.glb"] {
        let input = read(&folder, name);
        for (args, request) in options() {
            let expected = by_rust(&input, &request).to_bytes();
            let args: Vec<&str> = args.split(' ').collect();
            assert_eq!(BakeRequest::from_json(&as_json(&args)), Ok(request), "{args:?}");
            assert!(by_program(&folder, name, &args) == expected, "{name}: the program with {args:?}");
        }
    }
    let others: [(&str, &[&str], BakeRequest); 3] = [
        (
            "plan.geojson",
            &["--subdivide", "triangulation"],
            BakeRequest { subdivide: Some(Subdivide::Triangulation), ..BakeRequest::default() },
        ),
        (
            "plan.geojson",
            &["--subdivide", "kd", "--tau", "0.5"],
            BakeRequest { subdivide: Some(Subdivide::KdTree), tau: Some(0.5), ..BakeRequest::default() },
        ),
        ("map.prt", &["--fast"], BakeRequest { fast: true, ..BakeRequest::default() }),
    ];
    for (name, args, request) in others {
        let expected = by_rust(&read(&folder, name), &request).to_bytes();
        assert_eq!(BakeRequest::from_json(&as_json(args)), Ok(request), "{args:?}");
        assert!(by_program(&folder, name, args) == expected, "{name}: the program with {args:?}");
    }
}

/// Given cells, by file, take what the scene suggests, as those of Rust do.
#[test]
fn given_cells_take_what_suits_the_scene() {
    let folder = inputs();
    let cells = json!({"cells": [
        {"id": "a", "min": [0.5, 0.5, 0.5], "max": [1.5, 2.0, 1.5]},
        {"id": "b", "min": [9.0, 0.5, 1.5], "max": [10.0, 2.0, 2.5]},
    ]});
    folder.write("cells.json", cells.to_string());
    let given: ViewCells = sightlines::formats::view_cells::read_view_cells(folder.path("cells.json")).expect("cells");
    let input = read(&folder, "slanted.glb");
    let request = BakeRequest { cells: Some(CellsFrom::Boxes(given)), ..BakeRequest::default() };
    let expected = by_rust(&input, &request);
    assert!(by_program(&folder, "slanted.glb", &["--cells", "cells.json"]) == expected.to_bytes());
    let method = expected.info_value("method").expect("a method");
    assert!(method.contains("line"), "{method}");
}

/// What means nothing is refused, by name, and nothing is ignored.
#[test]
fn what_means_nothing_is_refused_by_name() {
    let folder = inputs();
    let refused = |name: &str, args: &[&str]| folder.refused(&[&["build", name, "-o", "out.pvs"], args].concat());
    folder.write("cells.json", r#"{"cells":[{"id":"a","min":[1,1,1],"max":[2,2,2]}]}"#);
    let cases: [(&str, &[&str], &str); 14] = [
        (
            "slanted.glb",
            &["--planes", "3"],
            "--planes is for the methods multifocal and both, and this is the method chosen by the scene",
        ),
        (
            "slanted.glb",
            &["--method", "auto", "--no-carry"],
            "--no-carry is for the methods multifocal and both, and this is the method chosen by the scene",
        ),
        (
            "slanted.glb",
            &["--method", "line-space", "--texels", "64"],
            "--texels is for the methods multifocal and both, and this is line-space",
        ),
        (
            "slanted.glb",
            &["--method", "sightlines", "--split", "1"],
            "--split is for methods that look from whole cells, and this is sightlines",
        ),
        (
            "slanted.glb",
            &["--certify", "--split", "1"],
            "--split is for methods that look from whole cells, and this is sightlines",
        ),
        (
            "slanted.glb",
            &["--cells", "cells.json", "--view-region", "0,0,0,1,1,1"],
            "--view-region is for cells that are cut, and this is given boxes",
        ),
        (
            "slanted.glb",
            &["--cells", "cells.json", "--keep-solid"],
            "--keep-solid is for cells that are cut along walls, and this is given boxes",
        ),
        (
            "slanted.glb",
            &["--grid", "2,2,1", "--keep-solid"],
            "--keep-solid is for cells that are cut along walls, and this is a grid",
        ),
        (
            "slanted.glb",
            &["--n-cells", "8", "--method", "line-space", "--detail-below", "1"],
            "--detail-below is for the cells of a k-d tree and for sightlines, and this is line-space",
        ),
        (
            "plan.geojson",
            &["--subdivide", "triangulation", "--tau", "0.5"],
            "--tau is for k-d trees, and this is a triangulation",
        ),
        ("plan.geojson", &["--sheets", "1"], "--sheets is for scenes in space, and this is a plan"),
        ("plan.geojson", &["--split", "1"], "--split is for scenes in space, and this is a plan"),
        ("plan.geojson", &["--grid", "1,1,1"], "--grid is for scenes in space, and this is a plan"),
        ("map.prt", &["--cell-size", "3"], "--cell-size is for scenes in space, and this is a portal file"),
    ];
    for (name, args, text) in cases {
        assert_eq!(refused(name, args), format!("{name}: {text}"));
    }
    // The same by Rust, with its own names.
    let request = BakeRequest { view_region: Some(Aabb { min: [0.0; 3], max: [1.0; 3] }), ..BakeRequest::default() };
    let error = request.prepare(BakeInput::Plan(&plan()), &Runtime::default()).expect_err("no region in a plan");
    assert_eq!(error.to_string(), "view_region is for scenes in space, and this is a plan");
}
