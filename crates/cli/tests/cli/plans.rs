//! Floor plans of other formats and with faults: DXF, layers, dropped lines, reference systems, and plans cut from scenes.

use crate::common::dxf::{Dxf, small_drawing};
use crate::common::{Folder, wad};
use serde_json::json;
use sightlines::formats::geojson::{parse_plan, parse_plan_file};

/// Two rooms, with a door between them; the door's wall is on a layer of its own, the furniture on one that is frozen.
fn two_rooms() -> Vec<u8> {
    let layers = Dxf::layers(&[("Walls", 0, 7), ("Door", 0, 1), ("Chairs", 1, 2)]);
    let walls = Dxf::new()
        .path(true, &[([0.0, 0.0], 0.0), ([8.0, 0.0], 0.0), ([8.0, 4.0], 0.0), ([0.0, 4.0], 0.0)])
        .line("Walls", [4.0, 0.0], [4.0, 1.0])
        .line("Walls", [4.0, 2.0], [4.0, 4.0])
        .line("Walls", [4.0, 4.0], [4.0, 2.0])
        .line("Walls", [1.0, 1.0], [1.0, 1.0])
        .line("Door", [4.0, 1.0], [4.0, 2.0])
        .line("Chairs", [6.0, 1.0], [6.0, 2.0])
        .entity("TEXT", "Walls")
        .at(10, [1.0, 1.0])
        .put(1, "hall");
    layers.add(&walls.as_section("ENTITIES")).as_file()
}

#[test]
fn drawings_are_built_and_verified_layer_by_layer() {
    let folder = Folder::new();
    folder.write("rooms.dxf", two_rooms());
    let shut = folder.run(&["build", "rooms.dxf", "-o", "shut.pvs"]).expect(0);
    let warnings: Vec<&str> =
        shut.err.lines().filter(|line| line.contains("rooms.dxf: ")).map(str::trim_start).collect();
    assert_eq!(
        warnings,
        [
            "WARN rooms.dxf: dropped 1 line without length",
            "WARN rooms.dxf: dropped 1 line that repeats another",
            "WARN rooms.dxf: ignored what is no line or curve: 1 TEXT",
            "WARN rooms.dxf: left out 1 entity on layers that are frozen or off: Chairs",
        ]
    );
    assert_eq!(folder.run(&["build", "rooms.dxf", "-o", "shut.pvs", "--quiet"]).expect(0).err, "");
    let open = ["build", "rooms.dxf", "--layers", "0,walls", "-o", "open.pvs", "--curve-deviation", "0.5"];
    folder.run(&open).expect(0);
    let sees = |table: &str| folder.run(&["explain", table, "1,3", "7,3"]).code;
    assert_eq!([sees("shut.pvs"), sees("open.pvs")], [1, 0]);
    // What the table was built with is read again; layers that are named count instead.
    let verify = |table: &str, more: &[&str]| {
        folder.run(&[&["verify", table, "rooms.dxf", "--rays", "200"][..], more].concat()).code
    };
    assert_eq!([verify("shut.pvs", &[]), verify("open.pvs", &[])], [0, 0]);
    assert_eq!(
        [verify("shut.pvs", &["--layers", "0,Walls"]), verify("open.pvs", &["--layers", "0,Walls,Door"])],
        [1, 1]
    );
    folder.run(&["view", "open.pvs", "--scene", "rooms.dxf", "-o", "page.html"]).expect(0);
    let error = folder.refused(&["build", "rooms.dxf", "--layers", "Walls,Roof", "-o", "x.pvs"]);
    assert_eq!(error, "rooms.dxf: there is no layer Roof; there are Walls, Door, Chairs, 0");
    assert!(folder.refused(&["verify", "shut.pvs", "rooms.dxf", "--layers", "Roof"]).ends_with("Chairs, 0"));
    let info = folder.run(&["info", "rooms.dxf", "--json"]).expect(0).json();
    assert_eq!((&info["kind"], &info["n_walls"], &info["n_doubled"]), (&json!("dxf"), &json!(7), &json!(1)));
    assert_eq!(info["layers"], json!(["Walls", "Door", "Chairs", "0"]));
    // No name is needed.
    folder.write("rooms", two_rooms());
    assert!(folder.run(&["info", "rooms"]).expect(0).out.starts_with("rooms: DXF plan"));
}

#[test]
fn drawings_that_cannot_be_read_are_refused_by_name() {
    let folder = Folder::new();
    folder.write("b.dxf", "AutoCAD Binary DXF\r\n\x1a\0");
    let error = folder.refused(&["build", "b.dxf", "-o", "x.pvs"]);
    assert_eq!(error, "b.dxf: this is binary DXF, which is not read: save it as text (ASCII)");
    let text = String::from_utf8(two_rooms()).unwrap();
    folder.write("cut.dxf", &text[..text.len() - 12]);
    assert!(folder.refused(&["info", "cut.dxf"]).starts_with("cut.dxf: line "));
    folder.write("a.geojson", r#"{"type": "LineString", "coordinates": [[0, 0], [4, 0]]}"#);
    let error = folder.refused(&["build", "a.geojson", "--layers", "A", "-o", "x.pvs"]);
    assert_eq!(error, "a.geojson: --layers is for DXF, and this is none");
    folder.write("c.dxf", Dxf::new().line("0", [0.0, 0.0], [1.0, 0.0]).model(&Dxf::new()));
    let error = folder.refused(&["build", "c.dxf", "--curve-deviation", "0", "-o", "x.pvs"]);
    assert_eq!(error, "c.dxf: 0 is no deviation of curves, which is a number above 0");
}

/// A plan with everything that is dropped, and a reference system.
const GRID: &str = r#"{"type":"FeatureCollection","crs": {"type": "name", "properties": {"name": "EPSG:25832"}},"features":[
{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[565000.5,5934000.25],[565008.5,5934000.25]]}},
{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[565008.5,5934000.25],[565000.5,5934000.25]]}},
{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[565000,5934000],[565000,5934000]]}}]}"#;

#[test]
fn plans_are_written_with_their_reference_system() {
    let folder = Folder::new();
    folder.write("grid.geojson", GRID);
    let run = folder.run(&["plan", "grid.geojson", "-o", "out.geojson"]).expect(0);
    assert_eq!(run.err.lines().filter(|line| line.contains("grid.geojson: dropped 1 line ")).count(), 2, "{}", run.err);
    let written = String::from_utf8(folder.read("out.geojson")).unwrap();
    assert!(written.contains(r#""crs":{"type": "name", "properties": {"name": "EPSG:25832"}}"#), "{written}");
    let file = parse_plan_file(written.as_bytes()).unwrap();
    assert_eq!(file.plan, parse_plan(GRID.as_bytes()).unwrap());
    assert!(file.warnings.is_empty());
    // Once more, nothing changes.
    folder.run(&["plan", "out.geojson", "-o", "again.geojson"]).expect(0);
    assert_eq!(folder.read("again.geojson"), written.as_bytes());
    assert!(folder.run(&["info", "out.geojson"]).expect(0).out.contains("walls          1, all parallel to an axis"));
}

#[test]
fn plans_of_drawings_and_maps_are_those_that_are_built() {
    let folder = Folder::new();
    folder.write("small.dxf", small_drawing());
    folder.write("maps.wad", wad(&["MAP01", "MAP02"]));
    for (input, more) in
        [("small.dxf", &[][..]), ("small.dxf", &["--layers", "Walls,Hidden"]), ("maps.wad", &["--map", "MAP02"])]
    {
        folder.run(&[&["plan", input, "-o", "p.geojson"], more].concat()).expect(0);
        folder.run(&[&["build", input, "-o", "a.pvs"], more].concat()).expect(0);
        folder.run(&["verify", "a.pvs", "p.geojson", "--rays", "100"]).expect(0);
    }
    let error = folder.refused(&["plan", "small.dxf", "--height", "1", "-o", "p.geojson"]);
    assert_eq!(error, "small.dxf: --height is for scenes in space, and this is none");
}

#[test]
fn a_building_is_cut_at_a_height() {
    let folder = Folder::with_tower();
    let run = folder.run(&["plan", "tower.glb", "--height", "1.2", "-o", "floor.geojson", "--json"]).expect(0);
    let plan = parse_plan(&folder.read("floor.geojson")).unwrap();
    assert_eq!(run.json()["n_walls"], json!(plan.lines().len()));
    assert_eq!((&run.json()["cut"]["height"], &run.json()["cut"]["n_flat"]), (&json!(1.2), &json!(0)));
    // The rooms of the plan see each other as those of the building do: from one room through doors to another.
    folder.run(&["build", "floor.geojson", "-o", "floor.pvs"]).expect(0);
    folder.run(&["verify", "floor.pvs", "floor.geojson", "--rays", "500"]).expect(0);
    let bounds = plan.bounds();
    assert!(bounds.min[1] < 0.0 && bounds.max[0] > 0.0, "y of the plan is -z of the building: {bounds:?}");
    let error = folder.refused(&["plan", "tower.glb", "-o", "x.geojson"]);
    assert!(
        error.starts_with("tower.glb: --height is missing: at which height is the scene cut? It is from "),
        "{error}"
    );
    let error = folder.refused(&["plan", "tower.glb", "--height", "-7.5", "-o", "x.geojson"]);
    assert!(error.starts_with("tower.glb: nothing is cut at the height -7.5: the scene is from "), "{error}");
    let error = folder.refused(&["plan", "tower.pvs", "--height", "1", "-o", "x.geojson"]);
    assert!(error.starts_with("tower.pvs: neither "), "{error}");
    assert!(!folder.path("x.geojson").exists());
}

/// A room that is 4 by 5 and 3 high with z up: where up is, is stated once, and all that follows is as for any scene.
#[test]
fn up_is_an_option_where_the_file_does_not_state_it() {
    let folder = Folder::new();
    let corners = [[0, 0, 0], [4, 0, 0], [4, 5, 0], [0, 5, 0]].map(|[x, y, _]| format!("v {x} {y} 0\nv {x} {y} 3\n"));
    let walls = [[1, 3, 4, 2], [3, 5, 6, 4], [5, 7, 8, 6], [7, 1, 2, 8]].map(|w| w.map(|k| k.to_string()).join(" "));
    folder.write("room.obj", corners.concat() + &walls.map(|wall| format!("f {wall}\n")).concat());
    let build = ["build", "room.obj", "--method", "sightlines", "-o", "room.pvs"];
    let run = folder.run(&[&build[..], &["--up", "z"]].concat()).expect(0);
    assert!(run.out.starts_with("scene          OBJ in 3D, z up, unit unknown"), "{}", run.out);
    assert_eq!(folder.run(&["info", "room.pvs", "--json"]).expect(0).json()["info"]["up"], "z");
    let floor = ["plan", "room.obj", "--height", "1", "-o", "floor.geojson", "--json"];
    let cut = folder.run(&[&floor[..], &["--up", "z"]].concat()).expect(0).json();
    let bounds = parse_plan(&folder.read("floor.geojson")).unwrap().bounds();
    assert_eq!((&cut["n_walls"], bounds.max[0] - bounds.min[0], bounds.max[1] - bounds.min[1]), (&json!(4), 4.0, 5.0));
    // The twin: without it y is taken to point up, and the plan is a section.
    let run = folder.run(&build).expect(0);
    assert!(run.out.starts_with("scene          OBJ in 3D, y up (assumed), unit unknown"), "{}", run.out);
    folder.run(&floor).expect(0);
    let bounds = parse_plan(&folder.read("floor.geojson")).unwrap().bounds();
    assert_eq!(bounds.max[1] - bounds.min[1], 3.0);
    let error = folder.refused(&["build", "floor.geojson", "--up", "z", "-o", "x.pvs"]);
    assert_eq!(error, "floor.geojson: --up is for scenes in space, and this is none");
    assert_eq!(folder.run(&["build", "room.obj", "--up", "up", "-o", "x.pvs"]).code, 2);
}
