//! Building, asking, exporting, drawing and explaining tables.

use crate::common::picture::{DRAWN, is_drawn};
use crate::common::{DEMO, Folder, doom_map, maze_text, wad};
use serde_json::{Value, json};
use sightlines::pvs::{CellId, Table};

fn office_table(folder: &Folder) -> Table {
    Table::from_bytes(&folder.read("office.pvs")).expect("a sound table")
}

fn eye(cell: &sightlines::pvs::CellRecord) -> String {
    format!("{},{}", 0.5 * (cell.min[0] + cell.max[0]), 0.5 * (cell.min[1] + cell.max[1]))
}

#[test]
fn build_says_what_it_built() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let built = folder.run(&["build", "office.geojson", "-o", "again.pvs", "--json"]).expect(0).json();
    assert_eq!(built["n_cells"], table.n_cells());
    assert_eq!(built["n_portals"], table.portals().len());
    assert_eq!(built["n_bytes"], folder.read("again.pvs").len());
    assert_eq!((&built["subdivide"], &built["map"], &built["out"]), (&json!("kd"), &Value::Null, &json!("again.pvs")));
    let build = ["build", "office.geojson", "-o", "again.pvs"];
    let reply = folder.run(&build).expect(0).out;
    let cells = format!("{} cells, {} portals", table.n_cells(), table.portals().len());
    assert_eq!(reply.lines().count(), 3, "{reply}");
    assert!(reply.starts_with("plan           a plan"), "{reply}");
    assert!(reply.contains(&format!("\nmethod         a k-d tree, exact planar stabbing; {cells}\n")), "{reply}");
    assert!(reply.contains("\nwrote          again.pvs, ") && reply.contains(" of the floor on average\n"), "{reply}");
    let reply = folder.run(&[&build[..], &["--verbose"]].concat()).expect(0).out;
    assert!(
        reply.starts_with("wrote again.pvs, ")
            && reply.contains("\nmethod         a k-d tree in the plane, ")
            && reply.contains(&format!("cells          {}", table.n_cells()))
    );
    assert_eq!(folder.names(), ["again.pvs", "office.geojson", "office.pvs"]);
}

/// Invariant: the same input and options give the same bytes, whatever the number of threads.
#[test]
fn build_is_deterministic() {
    let folder = Folder::with_office();
    folder.write("map.wad", wad(&["MAP01"]));
    for (input, how) in [("office.geojson", "kd"), ("office.geojson", "triangulation"), ("map.wad", "auto")] {
        let build = |out: &str, threads: &str| {
            folder.run(&["build", input, "-o", out, "--subdivide", how, "--threads", threads]).expect(0);
            folder.read(out)
        };
        let one = build("one.pvs", "1");
        assert!(one == build("two.pvs", "2") && one == build("all.pvs", "0"), "{input} by {how}");
    }
    // The impostor: options that matter change the bytes.
    folder.run(&["build", "office.geojson", "-o", "t.pvs", "--subdivide", "triangulation"]).expect(0);
    assert_ne!(folder.read("t.pvs"), folder.read("office.pvs"));
}

#[test]
fn build_takes_the_map_that_is_named_or_the_only_one() {
    let folder = Folder::with_wad();
    let named = folder.run(&["build", "maps.wad", "--map", "map03", "-o", "3.pvs", "--json"]).expect(0).json();
    assert_eq!((&named["map"], &named["subdivide"]), (&json!("MAP03"), &json!("triangulation")));
    assert!(named["n_groups"].as_u64().unwrap() > 1);
    folder.write("one.wad", wad(&["MAP01"]));
    assert_eq!(folder.run(&["build", "one.wad", "-o", "1.pvs", "--json"]).expect(0).json()["map"], "MAP01");
    // The content counts, not the name.
    folder.write("plan.wad", maze_text(3));
    folder.run(&["build", "plan.wad", "-o", "maze.pvs"]).expect(0);
}

#[test]
fn walls_that_do_not_block_are_reported() {
    let folder = Folder::with_wad();
    let args = ["build", "maps.wad", "--map", "MAP01", "-o", "kd.pvs", "--subdivide", "kd"];
    let run = folder.run(&args).expect(0);
    assert!(run.err.contains("do not block sight"), "{}", run.err);
    let quiet: Vec<&str> = args.into_iter().chain(["--quiet"]).collect();
    assert_eq!(folder.run(&quiet).expect(0).err, "");
}

#[test]
fn query_tells_what_the_table_says() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let mut objects_seen = 0;
    for (i, cell) in table.cells().iter().enumerate() {
        let found = folder.run(&["query", "office.pvs", "--eye", &eye(cell), "--json"]).expect(0).json();
        let id = CellId(i as u32);
        let visible: Vec<u32> = table.visible(id).map(|c| c.0).collect();
        assert_eq!((&found["cell"], &found["cells"]), (&json!(i), &json!([i])));
        assert_eq!(found["visible"], json!(visible));
        let objects: Vec<u64> =
            found["objects"].as_array().unwrap().iter().map(|o| o["id"].as_u64().unwrap()).collect();
        assert_eq!(json!(objects), json!(table.visible_objects(id).iter().map(|o| o.0).collect::<Vec<_>>()));
        objects_seen += objects.len();
    }
    assert!(objects_seen > 0, "an office has furniture");
    let reply = folder.run(&["query", "office.pvs", "--eye", &eye(&table.cells()[0])]).expect(0).out;
    assert!(reply.contains("is in cell 0\nsees "), "{reply}");
}

#[test]
fn points_may_begin_with_a_minus() {
    let folder = Folder::with_office();
    let outside = folder.run(&["query", "office.pvs", "--eye", "-1.5,2"]).expect(1);
    assert_eq!(outside.out, "the point (-1.5, 2) is outside every cell\n");
    let outside = folder.run(&["query", "--eye=-1.5,-2e0", "office.pvs", "--json"]).expect(1).json();
    assert_eq!(
        (&outside["cell"], &outside["visible"], &outside["eye"]),
        (&Value::Null, &json!([]), &json!([-1.5, -2.0]))
    );
    let outside = folder.run(&["explain", "office.pvs", "-1,-2", "0", "--json"]).expect(1).json();
    assert_eq!(outside, json!({"version": 3, "answer": "outside", "place": "point (-1, -2)"}));
    // Inside, too: a room around the origin.
    folder.write("room.geojson", r#"{"type":"LineString","coordinates":[[-2,-2],[2,-2],[2,2],[-2,2],[-2,-2]]}"#);
    folder.run(&["build", "room.geojson", "-o", "room.pvs"]).expect(0);
    assert_eq!(folder.run(&["query", "room.pvs", "--eye", "-1,-1", "--json"]).expect(0).json()["cell"], 0);
    assert_eq!(folder.run(&["explain", "room.pvs", "-1,-1", "-1,1.5", "--json"]).expect(0).json()["answer"], "same");
    folder.run(&["draw", "room.pvs", "-o", "room.svg", "--eye", "-1,-1"]).expect(0);
}

#[test]
fn export_is_the_table_as_the_contract_says() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let printed = folder.run(&["export", "office.pvs"]).expect(0);
    folder.run(&["export", "office.pvs", "-o", "office.json"]).expect(0);
    assert_eq!(folder.read("office.json"), printed.out.as_bytes());
    let json = printed.json();
    let keys = ["format", "version", "dimension", "cells", "portals", "visible", "objects", "cell_objects"];
    let places: Vec<usize> = keys.iter().map(|k| printed.out.find(&format!("\"{k}\":")).expect("the key")).collect();
    assert!(places.is_sorted() && json.as_object().unwrap().len() == keys.len());
    assert_eq!(
        (&json["format"], &json["version"], &json["dimension"]),
        (&json!("sightlines-export"), &json!(1), &json!(2))
    );
    for (i, cell) in table.cells().iter().enumerate() {
        let expected =
            json!({"id": i, "min": cell.min[..2], "max": cell.max[..2], "polygon": cell.polygon, "group": cell.group});
        assert_eq!(json["cells"][i], expected);
        assert_eq!(json["visible"][i], json!(table.visible(CellId(i as u32)).map(|c| c.0).collect::<Vec<_>>()));
        assert_eq!(
            json["cell_objects"][i],
            json!(table.visible_objects(CellId(i as u32)).iter().map(|o| o.0).collect::<Vec<_>>())
        );
    }
    for (i, portal) in table.portals().iter().enumerate() {
        let points: Vec<_> = portal.points.iter().map(|p| &p[..2]).collect();
        assert_eq!(json["portals"][i], json!({"id": i, "cells": portal.cells.map(|c| c.0), "points": points}));
    }
    for (i, object) in table.objects().iter().enumerate() {
        let expected = json!({"id": i, "name": object.name, "min": object.min[..2], "max": object.max[..2]});
        assert_eq!(json["objects"][i], expected);
    }
    let lengths = ["cells", "portals", "visible", "objects"].map(|k| json[k].as_array().unwrap().len());
    assert_eq!(lengths, [table.n_cells(), table.portals().len(), table.n_cells(), table.objects().len()]);
}

/// Invariant: what `explain` says of two cells is what the table says, and its line passes its portals.
#[test]
fn explain_agrees_with_the_table() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let (mut n_seen, mut n_hidden) = (0, 0);
    for b in 0..table.n_cells() as u32 {
        let run = folder.run(&["explain", "office.pvs", "1", &b.to_string(), "--json"]);
        let sees = table.sees(CellId(1), CellId(b));
        assert_eq!(run.code, i32::from(!sees), "cells 1 and {b}: {}", run.out);
        let reply = run.json();
        assert_eq!((&reply["from"], &reply["to"], &reply["listed"]), (&json!(1), &json!(b), &json!(sees)));
        match reply["answer"].as_str().unwrap() {
            "same" => assert_eq!(b, 1),
            "visible" => {
                n_seen += 1;
                check_line(&table, &reply);
            }
            "hidden" => {
                n_hidden += 1;
                let ways = reply["blocked"].as_array().unwrap();
                assert!(ways.len() as u64 == reply["n_blocked"].as_u64().unwrap().min(3), "{reply}");
                assert!(ways.iter().all(|way| !way["lefts"].as_array().unwrap().is_empty()), "{reply}");
            }
            other => panic!("{other}"),
        }
    }
    assert!(n_seen > 3 && n_hidden > 3, "{n_seen} seen, {n_hidden} hidden");
}

/// The portals lead from the first cell into the last one, and each point lies on its portal.
fn check_line(table: &Table, reply: &Value) {
    let list = |key: &str| reply[key].as_array().unwrap().clone();
    let (portals, cells, points) = (list("portals"), list("cells"), list("points"));
    assert!(portals.len() == cells.len() && cells.len() == points.len() && cells.last() == Some(&reply["to"]));
    let mut here = reply["from"].clone();
    for ((portal, cell), point) in portals.iter().zip(cells).zip(points) {
        let portal = &table.portals()[portal.as_u64().unwrap() as usize];
        assert!(portal.cells.map(|c| json!(c.0)).contains(&here) && portal.cells.map(|c| json!(c.0)).contains(&cell));
        for k in 0..2 {
            let (p, [a, b]) = (point[k].as_f64().unwrap(), [portal.points[0][k], portal.points[1][k]]);
            assert!(a.min(b) - 1e-9 <= p && p <= a.max(b) + 1e-9, "{point} is on {portal:?}");
        }
        here = cell;
    }
    assert!(["a", "b", "c"].iter().all(|k| reply["line"][k].is_string()));
}

#[test]
fn explain_speaks_and_draws() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let sees = |b: &u32| table.sees(CellId(0), CellId(*b));
    let ids = 0..table.n_cells() as u32;
    let (far, hidden) =
        (ids.clone().rfind(sees).unwrap().to_string(), ids.clone().find(|b| !sees(b)).unwrap().to_string());
    let seen = folder.run(&["explain", "office.pvs", "0", &far, "--draw", "line.svg"]).expect(0).out;
    assert!(
        seen.starts_with(&format!("cell 0 sees cell {far} through ")) && seen.contains("a x + b y + c = 0"),
        "{seen}"
    );
    assert!(String::from_utf8(folder.read("line.svg")).unwrap().contains("<circle"));
    let picture = format!("why.{DRAWN}");
    let why = folder.run(&["explain", "office.pvs", "0", &hidden, "--draw", &picture]).expect(1).out;
    assert!(why.contains("does not see") && why.contains("no line separates these points"), "{why}");
    assert!(is_drawn(&folder.read(&picture)));
    let given_up = folder.run(&["explain", "office.pvs", "0", &hidden, "--max-visits", "0"]).expect(1).out;
    assert!(given_up.contains("given up") && given_up.contains("do not see each other"), "{given_up}");
}

#[test]
fn cells_that_nothing_joins_are_explained() {
    let folder = Folder::new();
    let square = |x: i32| format!("[[[{x},0],[{},0],[{},2],[{x},2]]]", x + 2, x + 2);
    let rooms = format!(r#"{{"type":"MultiPolygon","coordinates":[{},{}]}}"#, square(0), square(5));
    folder.write("rooms.geojson", rooms);
    folder.run(&["build", "rooms.geojson", "-o", "rooms.pvs", "--subdivide", "triangulation"]).expect(0);
    let reply = folder.run(&["explain", "rooms.pvs", "1,1", "6,1"]).expect(1).out;
    assert!(reply.contains("no way through portals joins them"), "{reply}");
}

#[test]
fn draw_makes_pictures_of_both_kinds() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    folder.run(&["draw", "office.pvs", "-o", "plan.svg"]).expect(0);
    folder.run(&["draw", "office.pvs", "-o", "cell.SVG", "--cell", "0"]).expect(0);
    let at = eye(&table.cells()[0]);
    let svg = |name: &str| String::from_utf8(folder.read(name)).unwrap();
    assert!(svg("plan.svg").starts_with("<svg ") && svg("plan.svg") != svg("cell.SVG"));
    // Nothing to draw from outside.
    let outside = folder.run(&["draw", "office.pvs", "-o", "no.svg", "--eye", "-9,-9"]).expect(1);
    assert_eq!(outside.out, "the point (-9, -9) is outside every cell\n");
    assert!(!folder.path("no.svg").exists());
    let args = ["draw", "office.pvs", "-o", "eye.png", "--eye", &at, "--size", "300"];
    if !cfg!(feature = "png") {
        let refused = folder.refused(&args);
        let command = "`cargo install --path crates/cli --features png`";
        assert!(
            refused.starts_with("eye.png: PNG is not part of this build") && refused.contains(command),
            "{refused}"
        );
        assert!(!folder.path("eye.png").exists());
        return;
    }
    folder.run(&args).expect(0);
    let png = folder.read("eye.png");
    let side = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
    assert!(png.starts_with(b"\x89PNG") && side(16).max(side(20)) == 300);
}

#[test]
fn info_knows_each_kind_of_file() {
    let folder = Folder::with_office();
    let table = office_table(&folder);
    let info = |file: &str| folder.run(&["info", file, "--json"]).expect(0).json();
    let reply = info("office.pvs");
    assert_eq!((&reply["kind"], &reply["n_cells"]), (&json!("table"), &json!(table.n_cells())));
    assert_eq!(reply["info"]["subdivide"], "kd");
    let reply = info("office.geojson");
    assert_eq!((&reply["kind"], &reply["axial"], &reply["min"]), (&json!("geojson"), &json!(true), &json!([0.0, 0.0])));
    folder.write("maps.wad", wad(&["MAP01", "MAP02"]));
    let reply = info("maps.wad");
    let map = |i: usize| &reply["maps"][i];
    assert_eq!((&reply["kind"], reply["maps"].as_array().unwrap().len()), (&json!("pwad"), 2));
    assert_eq!((&map(0)["name"], &map(0)["n_sectors"]), (&json!("MAP01"), &json!(doom_map(1).n_sectors)));
    assert_eq!((&map(0)["reject"], &map(1)["reject"]), (&json!("none"), &json!("hand-made")));
    for (file, start) in
        [("office.pvs", "visibility table in 2D"), ("office.geojson", "GeoJSON plan"), ("maps.wad", "PWAD with ")]
    {
        let out = folder.run(&["info", file]).expect(0).out;
        assert!(out.starts_with(&format!("{file}: {start}")), "{out}");
    }
}

#[test]
fn the_demo_writes_what_it_names() {
    let folder = Folder::new();
    let reply = folder.run(&["demo"]).expect(0).out;
    let names = crate::common::names(&folder.path("sightlines-demo"));
    let all = ["plan.geojson", "plan.png", "plan.pvs", "plan.svg", "seen-little.png", "seen-little.svg"];
    let expected: Vec<_> = all.into_iter().filter(|name| cfg!(feature = "png") || !name.ends_with(".png")).collect();
    assert_eq!(names[..expected.len()], expected);
    assert_eq!(names.len(), if cfg!(feature = "png") { 11 } else { 7 });
    assert!(names.iter().all(|name| reply.contains(name.as_str())), "{reply}");
    for word in ["cells", "portals", "visible pairs", "time", "of the floor on average"] {
        assert!(reply.contains(word), "{word} in {reply}");
    }
    assert_eq!(reply.contains("memory"), cfg!(target_os = "linux"));
    let json = folder.run(&["demo", "--out", "other", "--seed", "2", "--json"]).expect(0).json();
    assert_eq!((&json["seed"], &json["folder"]), (&json!(2), &json!("other")));
    let share = json["built"]["mean_floor_share"].as_f64().unwrap();
    assert!(share > 0.0 && share < 1.0, "{share}");
    let [one, two] = ["sightlines-demo/plan.pvs", "other/plan.pvs"].map(|name| folder.read(name));
    assert_ne!(one, two, "another seed gives another office");
    let again = &DEMO.1;
    assert_eq!(again.len(), names.len());
    for (name, bytes) in again {
        assert!(*bytes == folder.read(&format!("sightlines-demo/{name}")), "{name}");
    }
}
