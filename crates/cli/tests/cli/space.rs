//! Tables of scenes in space: building, asking, exporting, drawing.

use crate::common::picture::{DRAWN, is_drawn};
use crate::common::{DEMO_TOWER, Folder};
use serde_json::{Value, json};
use sightlines::formats::scene::read_scene;
use sightlines::pvs::{CellId, Table};

fn table(folder: &Folder, name: &str) -> Table {
    Table::from_bytes(&folder.read(name)).expect("a sound table")
}

fn eye(table: &Table, cell: CellId) -> String {
    let record = &table.cells()[cell.idx()];
    let middle: Vec<String> = (0..3).map(|k| (0.5 * (record.min[k] + record.max[k])).to_string()).collect();
    middle.join(",")
}

#[test]
fn build_says_what_it_built() {
    let folder = Folder::with_tower();
    let (made, scene) = (table(&folder, "tower.pvs"), read_scene(folder.path("tower.glb")).unwrap().scene);
    let built = folder.run(&["build", "tower.glb", "-o", "again.pvs", "--json"]).expect(0).json();
    assert_eq!(folder.read("again.pvs"), folder.read("tower.pvs"));
    let number = |key: &str| built[key].as_u64().unwrap() as usize;
    assert_eq!(
        (number("dimension"), number("n_cells"), number("n_portals")),
        (3, made.n_cells(), made.portals().len())
    );
    assert_eq!((number("n_objects"), number("n_triangles")), (scene.objects().len(), scene.n_triangles()));
    assert_eq!(number("n_axial_triangles") + number("n_other_triangles"), scene.n_triangles());
    assert_eq!([&built["format"], &built["up"], &built["unit"]], ["glTF", "y", "metre"]);
    assert_eq!(built["subdivide"], "kd");
    let share = |key: &str| built["viewer"][key].as_f64().unwrap();
    assert!(["cells", "objects", "polygons"].iter().all(|key| share(key) > 0.0 && share(key) < 1.0), "{built}");
    let build = ["build", "tower.glb", "-o", "again.pvs"];
    let reply = folder.run(&build).expect(0).out;
    let [taken, method, result, worth] = reply.lines().collect::<Vec<_>>()[..] else { panic!("four lines: {reply}") };
    let (objects, triangles) = (scene.objects().len(), scene.n_triangles());
    assert!(taken.starts_with(&format!("scene          glTF in 3D, y up, in metres: {objects} objects, ")), "{taken}");
    assert!(
        taken.contains(&format!(", {triangles} triangles, {} of them axis-aligned", number("n_axial_triangles"))),
        "{taken}"
    );
    let cells = format!("{} cells, {} portals along walls", made.n_cells(), made.portals().len());
    assert_eq!(method, format!("method         sightlines; {cells}"));
    assert!(result.starts_with("wrote          again.pvs, ") && result.contains(": a viewer has "), "{result}");
    assert!(worth.starts_with("worth it       ") && worth.contains(": a viewer "), "{worth}");
    let reply = folder.run(&[&build[..], &["--verbose"]].concat()).expect(0).out;
    for line in [
        "scene          glTF in 3D, y up, in metres\n",
        "method         a k-d tree in space, exact axial stabbing of exact portals\n",
        &format!("triangles      {}: ", scene.n_triangles()),
        "a viewer has   ",
        "effort         ",
        "time           ",
    ] {
        assert!(reply.contains(line), "{line} in {reply}");
    }
}

/// Invariant: the same bytes with any number of threads; the table knows which way is up.
#[test]
fn build_is_deterministic_and_options_matter() {
    let folder = Folder::with_tower();
    let build = |args: &[&str]| {
        folder.run(&[&["build", "tower.glb", "-o", "out.pvs"][..], args].concat()).expect(0);
        table(&folder, "out.pvs")
    };
    let plain = table(&folder, "tower.pvs");
    let same = ["--threads", "1", "--method", "sightlines", "--tau", "0"];
    assert_eq!(build(&same), plain);
    assert_eq!(build(&["--threads", "2"]), plain);
    assert_eq!((plain.info_value("up"), plain.info_value("unit")), (Some("y"), Some("metre")));
    assert!(build(&["--tau", "0.6"]).n_cells() < plain.n_cells());
    let fine = build(&["--detail-below", "0"]);
    assert!(fine.info_value("detail-below") == Some("0") && fine.n_cells() >= plain.n_cells());
    // Outside the walls is a cell too if a viewer can be there.
    let outside = build(&["--view-region", "-5,0,-5,-4,2,-4"]);
    assert!(
        plain.in_dimension().unwrap().at([-4.5, 1.0, -4.5]).is_outside()
            && !outside.in_dimension().unwrap().at([-4.5, 1.0, -4.5]).is_outside()
    );
    assert!(folder.refused(&["build", "tower.glb", "-o", "out.pvs", "--max-cells", "5"]).contains("more than 5 cells"));
}

#[test]
fn scenes_and_plans_are_distinguished_by_content_and_name() {
    let folder = Folder::with_tower();
    folder.write("tower.wad", folder.read("tower.glb"));
    folder.run(&["build", "tower.wad", "-o", "out.pvs"]).expect(0);
    assert_eq!(folder.read("out.pvs"), folder.read("tower.pvs"));
    // A tent whose floor has an area, in the format without units.
    folder.write("tent.obj", "o tent\nv 0 0 0\nv 4 0 0\nv 0 0 4\nv 1 3 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let built =
        folder.run(&["build", "tent.obj", "--method", "sightlines", "-o", "tent.pvs", "--json"]).expect(0).json();
    assert_eq!(
        (&built["format"], &built["up_is_assumed"], &built["unit"]),
        (&json!("OBJ"), &json!(true), &json!(null))
    );
    assert_eq!((&built["n_axial_triangles"], &built["n_other_triangles"]), (&json!(1), &json!(3)));
    let reply = folder.run(&["info", "tent.obj"]).expect(0).out;
    assert!(reply.starts_with("tent.obj: scene in space, OBJ in 3D, y up (assumed), unit unknown\n"), "{reply}");
    // JSON that calls itself glTF is not reported as a broken plan.
    folder.write("empty.gltf", r#"{"asset": {"version": "2.0"}}"#);
    assert!(folder.refused(&["build", "empty.gltf", "-o", "out.pvs"]).contains("no triangles"));
}

#[test]
fn options_without_meaning_are_refused() {
    let folder = Folder::with_tower();
    folder.write("plan.geojson", crate::common::maze_text(1));
    for (args, error) in [
        (&["tower.glb", "--subdivide", "kd"][..], "tower.glb: --subdivide is for plans, and this is a scene in space"),
        (&["tower.glb", "--map", "MAP01"], "tower.glb: --map is for WADs, and this is none"),
        (
            &["plan.geojson", "--detail-below", "1"],
            "plan.geojson: --detail-below is for scenes in space, and this is a plan",
        ),
        (&["plan.geojson", "--max-cells", "9"], "plan.geojson: --max-cells is for scenes in space, and this is a plan"),
        (
            &["plan.geojson", "--view-region", "0,0,0,1,1,1"],
            "plan.geojson: --view-region is for scenes in space, and this is a plan",
        ),
    ] {
        assert_eq!(folder.refused(&[&["build", "-o", "out.pvs"][..], args].concat()), error);
    }
    for region in ["1,2,3", "0,0,0,1,1,nan", "0,0,0,1,-1,1", "a,b,c,d,e,f"] {
        let run = folder.run(&["build", "tower.glb", "-o", "out.pvs", "--view-region", region]).expect(2);
        assert!(run.err.contains("--view-region"), "{region}: {}", run.err);
    }
    for option in [["--detail-below", "-1"], ["--detail-below", "inf"], ["--max-cells", "0"]] {
        folder.run(&[&["build", "tower.glb", "-o", "out.pvs"][..], &option].concat()).expect(2);
    }
    assert!(!folder.path("out.pvs").exists());
}

#[test]
fn query_and_export_tell_what_the_table_says() {
    let folder = Folder::with_tower();
    let made = table(&folder, "tower.pvs");
    let export = folder.run(&["export", "tower.pvs"]).expect(0).json();
    assert_eq!(export["dimension"], 3);
    for (i, object) in made.objects().iter().enumerate() {
        assert_eq!(export["objects"][i], json!({"id": i, "name": object.name, "min": object.min, "max": object.max}));
    }
    for cell in (0..made.n_cells() as u32).map(CellId) {
        let objects = made.visible_objects(cell);
        assert!(
            objects.is_sorted()
                && export["cell_objects"][cell.idx()] == json!(objects.iter().map(|o| o.0).collect::<Vec<_>>())
        );
        if cell.idx() % 10 == 0 {
            let found = folder.run(&["query", "tower.pvs", "--eye", &eye(&made, cell), "--json"]).expect(0).json();
            assert_eq!((&found["cell"], &found["cells"]), (&json!(cell.0), &json!([cell.0])));
            assert_eq!(found["visible"], export["visible"][cell.idx()]);
            let ids: Vec<_> = found["objects"].as_array().unwrap().iter().map(|o| o["id"].clone()).collect();
            assert_eq!(json!(ids), export["cell_objects"][cell.idx()]);
        }
    }
    let reply = folder.run(&["query", "tower.pvs", "--eye", &eye(&made, CellId(0))]).expect(0).out;
    assert!(reply.contains("is in cell 0\nsees ") && reply.contains("floor0/"), "{reply}");
    assert!(folder.run(&["query", "tower.pvs", "--eye", "1e4,0,0"]).expect(1).out.contains("outside every cell"));
    assert!(folder.refused(&["query", "tower.pvs", "--eye", "1,2"]).contains("3 dimensions"));
}

#[test]
fn info_knows_scenes_and_their_tables() {
    let folder = Folder::with_tower();
    let reply = folder.run(&["info", "tower.glb", "--json"]).expect(0).json();
    let scene = read_scene(folder.path("tower.glb")).unwrap().scene;
    assert_eq!((&reply["kind"], &reply["n_triangles"]), (&json!("scene"), &json!(scene.n_triangles())));
    assert_eq!((&reply["min"], &reply["max"]), (&json!(scene.bounds().min), &json!(scene.bounds().max)));
    let reply = folder.run(&["info", "tower.pvs"]).expect(0).out;
    assert!(
        reply.starts_with("tower.pvs: visibility table in 3D") && reply.contains("of the volume on average"),
        "{reply}"
    );
    assert!(reply.contains("up             y\n") && reply.contains("portals        exact\n"), "{reply}");
}

#[test]
fn draw_makes_floor_plans_and_isometric_views() {
    let folder = Folder::with_tower();
    let made = table(&folder, "tower.pvs");
    let (at, cell) = (eye(&made, CellId(9)), &made.cells()[9]);
    let draw = |out: &str, args: &[&str]| {
        folder.run(&[&["draw", "tower.pvs", "--size", "300", "-o", out][..], args].concat()).expect(0);
        folder.read(out)
    };
    let svg = |args: &[&str]| String::from_utf8(draw("out.svg", args)).unwrap();
    // The height is that of the eye or of the middle of the cell.
    let height = (0.5 * (cell.min[1] + cell.max[1])).to_string();
    let by_eye = svg(&["--eye", &at]);
    assert!(by_eye.contains(&format!("sees at height {height}</title>")) && by_eye.contains("<circle"), "{by_eye}");
    assert_eq!(svg(&["--cell", "9"]), svg(&["--cell", "9", "--height", &height, "--up", "y"]));
    let plan = svg(&["--height", "1"]);
    assert!(plan.contains("<title>Cells at height 1</title>") && plan != svg(&["--height", "1", "--up", "z"]));
    // The tops of boxes: whose visibility is not shown, looked from, seen, seen from elsewhere in the cell, not seen.
    let tops = |svg: &str| {
        let colours = ["#eef2f6", "#ff9a52", "#b4d9fa", "#e1effc", "#f3f4f6"];
        colours.map(|colour| svg.matches(&format!("Z\" fill=\"{colour}\"/>")).count())
    };
    assert_eq!(tops(&svg(&["--isometric"])), [made.n_cells(), 0, 0, 0, 0]);
    let lower = svg(&["--isometric", "--height", "1"]);
    assert!((1..made.n_cells()).contains(&tops(&lower)[0]));
    let whole = ["--isometric", "--height", "1000"];
    let seen = svg(&[&whole[..], &["--cell", "9"]].concat());
    let n_seen = made.visible(CellId(9)).count();
    assert_eq!(tops(&seen), [0, 1, n_seen - 1, 0, made.n_cells() - n_seen]);
    // Without a height it is cut at that of the eye or of the middle of the cell.
    let cut = svg(&["--isometric", "--cell", "9"]);
    assert_eq!(cut, svg(&["--isometric", "--cell", "9", "--height", &height]));
    assert!(tops(&cut).iter().sum::<usize>() < made.n_cells());
    // What the viewer sees is drawn over what their cell sees, so nothing is missing.
    let by_eye = svg(&[&whole[..], &["--eye", &at]].concat());
    assert_eq!(tops(&by_eye)[1..4].iter().sum::<usize>(), n_seen);
    assert!(by_eye.contains("seen from elsewhere in that cell") && !seen.contains("elsewhere"));
    for args in [&["--eye", &at[..]][..], &["--isometric", "--cell", "9"]] {
        let drawn = draw(&format!("one.{DRAWN}"), args);
        assert!(is_drawn(&drawn) && drawn == draw(&format!("two.{DRAWN}"), args));
    }
    assert_eq!(folder.run(&["draw", "tower.pvs", "-o", "no.svg", "--eye", "1e4,0,0"]).expect(1).err, "");
    assert!(!folder.path("no.svg").exists());
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let folder = Folder::with_tower();
    let office = Folder::with_office();
    folder.write("office.pvs", office.read("office.pvs"));
    let refused = |args: &[&str]| folder.refused(&[&["draw", "-o", "out.svg"][..], args].concat());
    let error = refused(&["tower.pvs"]);
    assert!(error.starts_with("tower.pvs: ") && error.contains("needs --height (cells reach from "), "{error}");
    let error = refused(&["tower.pvs", "--height", "99"]);
    assert!(error.starts_with("tower.pvs: there is no cell at height 99: the cells reach from "), "{error}");
    assert!(refused(&["tower.pvs", "--isometric", "--height=-99"]).contains("no cell at height -99"));
    assert!(refused(&["tower.pvs", "--cell", "9999"]).contains("no cell 9999"));
    assert!(refused(&["tower.pvs", "--eye", "1,1"]).contains("3 dimensions"));
    for option in [&["--height", "1"][..], &["--isometric"], &["--up", "z"]] {
        let error = refused(&[&["office.pvs"][..], option].concat());
        assert_eq!(error, format!("office.pvs: {} is for scenes in space, and this is the table of a plan", option[0]));
    }
    folder.run(&["draw", "tower.pvs", "-o", "out.svg", "--height", "nan"]).expect(2);
    assert!(!folder.path("out.svg").exists());
}

/// The line is drawn from above and from the side, within the picture; what blocks all lines has no line.
#[test]
fn explanations_in_space_are_drawn() {
    let folder = Folder::with_tower();
    let made = table(&folder, "tower.pvs");
    let (mut n_lines, mut n_walls) = (0, 0);
    for (a, b) in some_pairs(made.n_cells() as u32, 13) {
        let run = folder.run(&["explain", "tower.pvs", &a.to_string(), &b.to_string(), "--draw", "why.svg", "--json"]);
        let (svg, json) = (String::from_utf8(folder.read("why.svg")).unwrap(), run.json());
        let titles: Vec<&str> = svg.split("<title>").skip(1).filter_map(|text| text.split("</title>").next()).collect();
        assert!(
            titles.iter().any(|title| title.starts_with("from above")) && titles.contains(&"from the side and above")
        );
        assert_eq!(titles.contains(&"a line of sight"), json["answer"] == "visible" && !json["ends"].is_null());
        assert_eq!(titles.contains(&"what blocks every line"), json["answer"] == "hidden" && json["connected"] == true);
        n_lines += usize::from(titles.contains(&"a line of sight"));
        n_walls += usize::from(titles.contains(&"what blocks every line"));
    }
    assert!(n_lines > 2 && n_walls > 2, "{n_lines}, {n_walls}");
}

/// Invariant: what `explain` says of two cells is what the table says; lines pass their portals in order,
/// and proofs name walls.
#[test]
fn explain_agrees_with_tables_in_space() {
    let folder = Folder::with_tower();
    folder.run(&["build", "tower.glb", "-o", "loose.pvs", "--tau", "0.6"]).expect(0);
    let (mut n_seen, mut n_hidden) = (0, 0);
    for (name, step) in [("tower.pvs", 7), ("loose.pvs", 13)] {
        let made = table(&folder, name);
        for (a, b) in some_pairs(made.n_cells() as u32, step) {
            let run = folder.run(&["explain", name, &a.to_string(), &b.to_string(), "--json"]);
            let sees = made.sees(CellId(a), CellId(b));
            assert_eq!(run.code, i32::from(!sees), "{name}: cells {a} and {b}: {}", run.out);
            let reply = run.json();
            assert_eq!((&reply["from"], &reply["to"], &reply["listed"]), (&json!(a), &json!(b), &json!(sees)));
            match reply["answer"].as_str().unwrap() {
                "same" => assert_eq!(a, b),
                "visible" => {
                    n_seen += 1;
                    check_line(&made, &reply);
                }
                "hidden" => {
                    n_hidden += 1;
                    check_proof(&reply);
                }
                other => panic!("{other}"),
            }
        }
    }
    assert!(n_seen > 50 && n_hidden > 50, "{n_seen} seen, {n_hidden} hidden");
}

fn some_pairs(n_cells: u32, step: usize) -> impl Iterator<Item = (u32, u32)> {
    (0..n_cells).step_by(step).flat_map(move |a| (a..n_cells).step_by(step).map(move |b| (a, b)))
}

fn point(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|k| value[k].as_f64().unwrap_or_else(|| panic!("{value} is no point")))
}

/// The portals lead from the first cell into the last one, each point lies on its portal, and the line
/// begins and ends inside of the two cells.
fn check_line(table: &Table, reply: &Value) {
    let list = |key: &str| reply[key].as_array().unwrap().clone();
    let (portals, cells, points) = (list("portals"), list("cells"), list("points"));
    assert!(portals.len() == cells.len() && cells.len() == points.len() && cells.last() == Some(&reply["to"]));
    let mut here = reply["from"].clone();
    for ((portal, cell), at) in portals.iter().zip(cells).zip(points) {
        let portal = &table.portals()[portal.as_u64().unwrap() as usize];
        assert!(portal.cells.map(|c| json!(c.0)).contains(&here) && portal.cells.map(|c| json!(c.0)).contains(&cell));
        for (k, p) in point(&at).into_iter().enumerate() {
            let [low, high] = [f64::min, f64::max].map(|f| portal.points.iter().map(|p| p[k]).reduce(f).unwrap());
            assert!(low - 1e-9 <= p && p <= high + 1e-9, "{at} is on {portal:?}");
        }
        here = cell;
    }
    assert!(reply["line"]["point"].is_array() && reply["line"]["direction"].is_array());
    if let Some(ends) = reply["ends"].as_array() {
        for (end, cell) in ends.iter().zip(["from", "to"]) {
            let cell = &table.cells()[reply[cell].as_u64().unwrap() as usize];
            assert!((0..3).all(|k| cell.min[k] <= point(end)[k] && point(end)[k] <= cell.max[k]), "{reply}");
        }
    }
}

/// Walls are flat, and as often in the tree as printed; unless nothing joins the cells.
fn check_proof(reply: &Value) {
    if reply["connected"] == json!(false) {
        return;
    }
    let walls = reply["walls"].as_array().unwrap();
    assert!(!walls.is_empty() && reply["n_blockers"].as_u64().unwrap() >= walls.len() as u64, "{reply}");
    let flat = |w: &Value| (0..3).filter(|&k| w["min"][k] == w["max"][k]).count() == 1;
    assert!(walls.iter().all(flat), "{reply}");
    let n_nodes: u64 = walls.iter().map(|w| w["n_nodes"].as_u64().unwrap()).sum();
    let text = reply["proof"].to_string();
    assert_eq!((&reply["n_nodes"], text.matches("\"wall\":").count() as u64), (&json!(n_nodes), n_nodes));
    assert_eq!(reply["n_contradictions"], json!(text.matches("[{\"row\":").count()));
}

#[test]
fn explain_speaks_in_space() {
    let folder = Folder::with_tower();
    let made = table(&folder, "tower.pvs");
    let sees = |b: &u32| made.sees(CellId(0), CellId(*b));
    let ids = 0..made.n_cells() as u32;
    let (seen, hidden) = (ids.clone().rfind(sees).unwrap().to_string(), ids.clone().rfind(|b| !sees(b)).unwrap());
    let reply = folder.run(&["explain", "tower.pvs", "0", &seen]).expect(0).out;
    assert!(
        reply.starts_with(&format!("cell 0 sees cell {seen} through ")) && reply.contains("along the line from ("),
        "{reply}"
    );
    let hidden = hidden.to_string();
    let reply = folder.run(&["explain", "tower.pvs", "0", &hidden]).expect(1).out;
    assert!(
        reply.contains("every line meets one ") && reply.contains("  wall x") && reply.contains("the proof has "),
        "{reply}"
    );
    assert!(!folder.run(&["explain", "tower.pvs", "0", &hidden, "--proofs", "0"]).expect(1).out.contains("  wall"));
    // Points are cells too, and a cell sees itself.
    let reply = folder.run(&["explain", "tower.pvs", &eye(&made, CellId(0)), "0"]).expect(0).out;
    assert_eq!(reply, "both are in cell 0, and a cell sees itself\n");
    assert!(folder.run(&["explain", "tower.pvs", "1e4,0,0", "0"]).expect(1).out.contains("outside every cell"));
    // Given up at once: the answer of the table is reported as such. A single wall in the way takes no program.
    let reply = folder.run(&["explain", "tower.pvs", "0", &seen, "--max-programs", "0"]).expect(0).out;
    assert!(
        reply.contains("in 0 linear programs; see --max-programs\nthe table assumes that they see each"),
        "{reply}"
    );
    let at_once =
        |b: u32| folder.run(&["explain", "tower.pvs", "0", &b.to_string(), "--max-programs", "0"]).expect(1).out;
    let reply = ids.filter(|b| !sees(b)).map(at_once).find(|reply| reply.contains("see --max-programs"));
    assert!(reply.is_some_and(|reply| reply.ends_with("the table says that they do not see each other\n")));
}

#[test]
fn explain_refuses_what_it_cannot_use() {
    let folder = Folder::with_tower();
    let office = Folder::with_office();
    folder.write("office.pvs", office.read("office.pvs"));
    assert_eq!(
        folder.refused(&["explain", "tower.pvs", "0", "1", "--max-visits", "9"]),
        "tower.pvs: --max-visits is for plans, and this is the table of a scene in space"
    );
    assert_eq!(
        folder.refused(&["explain", "office.pvs", "0", "1", "--max-programs", "9"]),
        "office.pvs: --max-programs is for scenes in space, and this is the table of a plan"
    );
    assert!(folder.refused(&["explain", "tower.pvs", "0", "9999"]).contains("no cell 9999"));
    assert!(folder.refused(&["explain", "tower.pvs", "0", "1,1"]).contains("3 dimensions"));
    folder.write("bare.pvs", table(&folder, "tower.pvs").strip_geometry().to_bytes());
    let error = folder.refused(&["explain", "bare.pvs", "0", "1"]);
    assert!(error.starts_with("bare.pvs: the table has no "), "{error}");
}

#[test]
fn towers_are_generated_in_any_size() {
    let folder = Folder::new();
    let generate = |args: &[&str]| {
        let json = folder.run(&[&["generate", "tower", "-o", "t.glb", "--json"][..], args].concat()).expect(0).json();
        (json, folder.read("t.glb"))
    };
    let (low, bytes) = generate(&["--floors", "2", "--rooms-x", "3", "--rooms-y", "2", "--furniture", "0"]);
    assert_eq!((&low["n_floors"], &low["n_bytes"]), (&json!(2), &json!(bytes.len())));
    let scene = read_scene(folder.path("t.glb")).unwrap();
    assert_eq!(
        (&low["n_triangles"], &low["n_objects"]),
        (&json!(scene.info.n_triangles), &json!(scene.info.n_objects))
    );
    let small = ["--floors", "2", "--rooms-x", "3", "--rooms-y", "2"];
    assert!(generate(&small).0["n_triangles"].as_u64() > low["n_triangles"].as_u64(), "furniture has triangles");
    let other = [&small[..], &["--furniture", "0", "--seed", "2"]].concat();
    assert_ne!(generate(&other).1, bytes);
    let closed = [&small[..], &["--furniture", "0", "--no-windows", "--wall-thickness", "0.5"]].concat();
    assert_ne!(generate(&closed).1, bytes);
    let before = folder.read("t.glb");
    let error = folder.refused(&["generate", "tower", "-o", "t.glb", "--floors", "257"]);
    assert_eq!(error, "floors is 257, but must be from 1 to 256");
    assert!(
        folder.refused(&["generate", "tower", "-o", "t.glb", "--wall-thickness", "7"]).contains("wall thickness 7")
    );
    assert_eq!(folder.read("t.glb"), before);
}

#[test]
fn the_demo_builds_a_tower() {
    let [(text, one), (json, two)] = &*DEMO_TOWER;
    let (reply, json) = (&text.out, json.json());
    let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    let pictures = ["cells", "floor", "seen"].iter().flat_map(|n| ["png", "svg"].map(|k| format!("tower-{n}.{k}")));
    let pictures = pictures.filter(|name| cfg!(feature = "png") || !name.ends_with(".png"));
    let expected: Vec<String> = pictures.chain(["tower.glb", "tower.pvs", "view.html"].map(str::to_owned)).collect();
    assert_eq!(names, expected);
    assert!(names.iter().all(|name| reply.contains(name)), "{reply}");
    assert!(reply.contains("of the polygons; the rest is hidden"), "{reply}");
    let share = json["built"]["viewer"]["polygons"].as_f64().unwrap();
    assert!(share > 0.0 && share < 1.0, "{share}");
    assert_eq!(one.len(), two.len());
    for (one, two) in one.iter().zip(two) {
        assert!(one == two, "{} and {}", one.0, two.0);
    }
}
