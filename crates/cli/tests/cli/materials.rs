//! Glass, roles and options in scenes, from the file to the report and back.

use crate::common::looks::table;
use crate::common::{Folder, levels};
use sightlines::cells::{Scene, SceneObject};
use sightlines::formats::scene::{parse_glb, read_scene, write_glb};
use sightlines::geometry::Aabb;

/// A room of 8 by 4 by 3 with a pane across its middle, and a thing on either side; quads, in the order of `f`.
fn room() -> String {
    let quad = |name: &str, material: &str, p: [[f64; 3]; 4], first: usize| {
        let corners: String = p.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
        format!("o {name}\nusemtl {material}\n{corners}f {} {} {} {}\n", first, first + 1, first + 2, first + 3)
    };
    let across =
        |x: f64, low: f64, high: [f64; 2]| [[x, low, low], [x, high[0], low], [x, high[0], high[1]], [x, low, high[1]]];
    let level = |y: f64| [[0.0, y, 0.0], [8.0, y, 0.0], [8.0, y, 3.0], [0.0, y, 3.0]];
    let along = |z: f64| [[0.0, 0.0, z], [8.0, 0.0, z], [8.0, 4.0, z], [0.0, 4.0, z]];
    let quads = [
        ("west", "wall", across(0.0, 0.0, [4.0, 3.0])),
        ("east", "wall", across(8.0, 0.0, [4.0, 3.0])),
        ("floor", "wall", level(0.0)),
        ("ceiling", "wall", level(4.0)),
        ("front", "wall", along(0.0)),
        ("back", "wall", along(3.0)),
        ("pane", "glass", across(4.0, 0.0, [4.0, 3.0])),
        ("west picture", "wall", across(1.0, 1.0, [3.0, 2.0])),
        ("east picture", "wall", across(7.0, 1.0, [3.0, 2.0])),
    ];
    let all: String = (0..).zip(quads).map(|(k, (name, material, p))| quad(name, material, p, 4 * k + 1)).collect();
    format!("mtllib room.mtl\n{all}")
}

/// Objects that a point of the west sees in a table.
fn seen(folder: &Folder, table: &str) -> String {
    folder.run(&["query", table, "--eye", "2,2,1.5"]).expect(0).out
}

#[test]
fn glass_is_reported_and_hides_nothing() {
    let folder = Folder::new();
    folder.write("room.obj", room());
    folder.write("room.mtl", "newmtl wall\nd 1\nnewmtl glass\nd 0.2\n");
    let brief = folder.run(&["build", "room.obj", "--detail-below", "0", "-o", "glass.pvs"]).expect(0).out;
    assert!(brief.starts_with("scene          OBJ in 3D, y up (assumed), unit unknown: 9 objects, "), "{brief}");
    assert!(brief.lines().count() == 4 && brief.contains(" axis-aligned, 1 see-through\n"), "{brief}");
    let build = ["build", "room.obj", "--detail-below", "0", "--verbose", "-o"];
    let run = folder.run(&[&build[..], &["glass.pvs"]].concat()).expect(0);
    assert!(run.out.contains("see-through    1 object, classified by d 0.2: pane\n"), "{}", run.out);
    assert!(seen(&folder, "glass.pvs").contains("east picture"));
    assert!(
        folder
            .run(&["info", "room.obj"])
            .expect(0)
            .out
            .contains("see-through    1 object, classified by d 0.2: pane\n")
    );
    // The twin: the same pane hides if somebody says that it does.
    let run = folder.run(&[&build[..], &["wall.pvs", "--opaque", "Glass"]].concat()).expect(0);
    assert!(run.out.contains("occluder       1 object, classified by the pattern Glass: pane\n"), "{}", run.out);
    assert!(!seen(&folder, "wall.pvs").contains("east picture"));
    // The table says so, so that it is checked with the same; glass that was taken for a wall is found.
    folder.run(&["verify", "wall.pvs", "room.obj", "--rays", "2000"]).expect(0);
    folder.run(&["verify", "glass.pvs", "room.obj", "--rays", "2000"]).expect(0);
    folder.write("room.mtl", "newmtl wall\nnewmtl glass\n");
    folder.run(&[&build[..], &["blind.pvs"]].concat()).expect(0);
    folder.write("room.mtl", "newmtl wall\nnewmtl glass\nd 0.2\n");
    let found = folder.run(&["verify", "blind.pvs", "room.obj", "--rays", "2000"]).expect(1).out;
    for kind in ["changed-geometry: what hides", "hidden-object"] {
        assert!(found.contains(&format!("violation      {kind}")), "{found}");
    }
    // Without its library nobody knows what is glass.
    std::fs::remove_file(folder.path("room.mtl")).unwrap();
    let run = folder.run(&[&build[..], &["none.pvs"]].concat()).expect(0);
    assert!(run.err.contains("the material library \"room.mtl\" cannot be read"), "{}", run.err);
    assert!(run.out.contains(
        "see-through    9 objects, classified by a material of the missing room.mtl: west, east, floor, ceiling, front, …\n"
    ));
    let run = folder.run(&[&build[..], &["some.pvs", "--opaque", "wall"]].concat()).expect(0);
    assert!(run.out.contains("occluder       8 objects, classified by the pattern wall"), "{}", run.out);
    assert!(seen(&folder, "some.pvs").contains("east picture"));
    let run = folder.run(&[&build[..], &["odd.pvs", "--see-through", "door*"]].concat()).expect(0);
    assert!(run.err.contains("no object, node, mesh or material is called door*"), "{}", run.err);
}

#[test]
fn what_is_not_a_scene_has_no_glass() {
    let folder = Folder::with_wad();
    let run = folder.run(&["build", "maps.wad", "--map", "MAP01", "-o", "m.pvs", "--opaque", "x"]).expect(2);
    assert!(run.err.contains("--opaque"), "{}", run.err);
    folder.run(&["info", "maps.wad", "--see-through", "x"]).expect(2);
    folder.run(&["build", "maps.wad", "-o", "m.pvs", "--see-through", ""]).expect(2);
}

#[test]
fn pictures_and_simplified_scenes_keep_glass_apart() {
    let folder = Folder::new();
    folder.write("room.obj", room());
    folder.write("room.mtl", "newmtl wall\nnewmtl glass\nTr 0.5\n");
    let look =
        ["--method", "raycast", "--size", "32x24", "--eye", "2,2,1.5", "--look-at", "7,2,1.5", "--by-object", "-o"];
    let run = folder.run(&[&["render", "room.obj"], &look[..], &["glass.png"]].concat()).expect(0);
    assert!(run.err.contains("room.obj: see-through and not drawn: 1 object"), "{}", run.err);
    folder.run(&[&["render", "room.obj", "--opaque", "*"], &look[..], &["wall.png"]].concat()).expect(0);
    assert_ne!(folder.read("glass.png"), folder.read("wall.png"));
    // What is behind glass is not taken away, and glass stays glass.
    let simplify = ["simplify", "room.obj", "--volume=1.5,1.5,1.4,2.5,2.5,1.6", "--method", "shafts", "-o"];
    folder.run(&[&simplify[..], &["glass.glb"]].concat()).expect(0);
    folder.run(&[&simplify[..], &["wall.glb", "--opaque", "*"]].concat()).expect(0);
    let names = |name: &str| -> Vec<String> {
        let scene = read_scene(folder.path(name)).unwrap().scene;
        scene.objects().iter().map(|o| o.name.clone()).collect()
    };
    assert!(names("glass.glb").contains(&"east picture".to_owned()));
    assert!(!names("wall.glb").contains(&"east picture".to_owned()));
    let scene = parse_glb(&folder.read("glass.glb"), None).unwrap().scene;
    assert_eq!(scene.see_through().iter().map(|&k| &scene.objects()[k as usize].name).collect::<Vec<_>>(), ["pane"]);
}

/// What was see-through for a table is so for the picture that it culls, without being named again.
#[test]
fn pictures_are_culled_as_their_table_was_built() {
    let folder = Folder::new();
    folder.write("room.obj", room());
    folder.write("room.mtl", "newmtl wall\nnewmtl glass\n");
    folder.run(&["build", "room.obj", "--grid", "2,1,1", "--see-through", "pane", "-o", "table.pvs"]).expect(0);
    let view = ["--size", "32x24", "--eye", "2,2,1.5", "--look-at", "7,2,1.5"];
    let look = [&["render", "room.obj", "--method", "raycast"], &view[..], &["--by-object", "-o"]].concat();
    let warning = "see-through and not drawn: 1 object";
    let run = folder.run(&[&look[..], &["all.png"]].concat()).expect(0);
    assert!(!run.err.contains(warning), "{}", run.err);
    let run = folder.run(&[&look[..], &["culled.png", "--cull", "pvs", "--table", "table.pvs"]].concat()).expect(0);
    assert!(run.err.contains(warning), "{}", run.err);
    folder.run(&["pack", "table.pvs", "-o", "table.pvz"]).expect(0);
    let run = folder.run(&[&look[..], &["packed.png", "--cull", "pvs", "--table", "table.pvz"]].concat()).expect(0);
    assert!(run.err.contains(warning), "{}", run.err);
    assert_eq!(folder.read("culled.png"), folder.read("packed.png"));
}

#[test]
fn what_programs_may_move_is_named() {
    let folder = Folder::new();
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["KHR_interactivity"], "scenes": [{{"nodes": [0]}}],
            "nodes": [{{"name": "sun", "mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "buffers": [{{"byteLength": 36, "uri": "data:;base64,{data}"}}]}}"#
    );
    folder.write("sun.gltf", text);
    let run = folder.run(&["info", "sun.gltf"]).expect(0);
    assert!(run.err.contains("KHR_interactivity may move everything"), "{}", run.err);
    assert!(run.out.contains("see-through    1 moving object, classified by KHR_interactivity: sun\n"), "{}", run.out);
    let run = folder.run(&["info", "sun.gltf", "--still", "*"]).expect(0);
    assert!(run.out.contains("occluder       1 object, classified by the pattern *: sun\n"), "{}", run.out);
    folder
        .run(&["info", "sun.gltf", "--opaque", "*"])
        .expect(0)
        .err
        .find("1 occluder moves and hides nothing")
        .unwrap();
}

/// What was see-through for a table is so for whoever removes triangles by it, without being named again.
#[test]
fn simplification_reads_a_scene_as_its_table_was_built() {
    let folder = Folder::new();
    folder.write("room.obj", room());
    folder.write("room.mtl", "newmtl wall\nnewmtl glass\n");
    let names = |path: &str| -> Vec<String> {
        let scene = read_scene(folder.path(path)).unwrap().scene;
        scene.objects().iter().map(|o| o.name.clone()).collect()
    };
    let keeps = |pattern: &str| {
        let build = ["build", "room.obj", "--grid", "2,1,1", "--see-through", pattern, "-o", "table.pvs"];
        folder.run(&build).expect(0);
        let how = ["--table", "table.pvs", "--method", "shafts"];
        folder.run(&[&["simplify", "room.obj", "--cell", "0", "-o", "left.glb"], &how[..]].concat()).expect(0);
        folder.run(&[&["levels", "room.obj", "-o", "levels"], &how[..]].concat()).expect(0);
        let is_there = |path: &str| names(path).contains(&"east picture".to_owned());
        let n_levels = std::fs::read_dir(folder.path("levels")).unwrap().count() - 1;
        [is_there("left.glb"), (0..n_levels).all(|k| is_there(&format!("levels/level_{k}.glb")))]
    };
    assert_eq!(keeps("pane"), [true, true]);
    // The twin: an opaque pane hides it from the western half.
    assert_eq!(keeps("west picture"), [false, false]);
}

#[test]
fn scenes_of_a_file_are_chosen_by_name() {
    let folder = Folder::new();
    let node = |name: &str| format!(r#"{{"name": "{name}", "mesh": 0}}"#);
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"name": "day", "nodes": [0]}}, {{"nodes": [1]}}],
            "nodes": [{}, {}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "buffers": [{{"byteLength": 36, "uri": "data:;base64,{data}"}}]}}"#,
        node("sun"),
        node("moon")
    );
    folder.write("two.gltf", text);
    let run = folder.run(&["info", "two.gltf"]).expect(0);
    assert!(run.err.contains("the default scene, day, was read, one of 2 in the file"), "{}", run.err);
    assert!(folder.run(&["info", "two.gltf", "--scene-name", "1"]).expect(0).err.is_empty());
    // What it took the numbers for: metres, 3 units across, at the origin.
    let run = folder.run(&["info", "two.gltf"]).expect(0);
    assert!(run.out.contains("single-sided   1 triangle") && run.out.contains("size           1 by 1 by 0 metres\n"));
    let text = String::from_utf8(folder.read("two.gltf")).unwrap();
    let moved = |what: &str| text.replace(r#""name": "sun","#, &format!(r#""name": "sun", {what},"#));
    folder.write("far.gltf", moved(r#""translation": [500000, 0, 4000000]"#));
    let run = folder.run(&["info", "far.gltf"]).expect(0);
    assert!(
        run.out.contains(
            "far away       4000000 metres from the origin, where single precision has steps of 0.25 metres\n"
        )
    );
    folder.write("large.gltf", moved(r#""scale": [9000, 3000, 1]"#));
    let run = folder.run(&["info", "large.gltf"]).expect(0);
    assert!(run.out.contains("if it was modelled in millimetres, it is 9 metres: scale it by 0.001\n"), "{}", run.out);
    let run = folder.run(&["info", "two.gltf", "--scene-name", "dusk"]).expect(2);
    assert!(run.err.contains("there is no scene \"dusk\", but day, 1"), "{}", run.err);
}

/// Where viewers can be is cut into cells, unless somebody names another region; what moves is listed with its box.
#[test]
fn view_volumes_and_movers_of_a_file_are_taken() {
    let folder = Folder::new();
    folder.write("level.glb", levels::blender_with_extras());
    let grid = ["--method", "shafts", "--grid", "2,1,1"];
    let build = [&["build", "level.glb", "-o", "level.pvs"], &grid[..]].concat();
    let brief = folder.run(&build).expect(0).out;
    assert!(brief.contains("2 given cells, in the view volume of the file\n"), "{brief}");
    assert!(brief.contains(", 1 moving, 1 door, 1 view volume\n"), "{brief}");
    let run = folder.run(&[&build[..], &["-v"]].concat()).expect(0);
    let line = "viewers        in the view volume of the file: (4.5, 0, 4) to (7.5, 3, 5.5)\n";
    assert!(run.out.contains(line), "{}", run.out);
    let bounds = |name: &str| Aabb::around(table(&folder, name).cells().iter().flat_map(|cell| [cell.min, cell.max]));
    assert_eq!(bounds("level.pvs"), Aabb { min: [4.5, 0.0, 4.0], max: [7.5, 3.0, 5.5] });
    // Cells by views, too.
    let places = ["build", "level.glb", "-o", "places.pvs", "--n-cells", "8", "--method", "auto", "-v"];
    assert!(folder.run(&places).expect(0).out.contains(line));
    assert_eq!(bounds("places.pvs"), bounds("level.pvs"));
    // Of a k-d tree, what cannot be reached from there is left out, as with the option.
    let build = ["build", "level.glb", "-o"];
    folder.run(&[&build[..], &["tree.pvs"]].concat()).expect(0);
    folder.run(&[&build[..], &["same.pvs", "--view-region", "4.5,0,4,7.5,3,5.5"]].concat()).expect(0);
    assert_eq!(folder.read("tree.pvs"), folder.read("same.pvs"));
    // Who names a region, or the cells, is believed.
    let region = ["--view-region", "1,0,1,2,2,2"];
    let run = folder.run(&[&build[..], &["other.pvs", "-v"], &grid, &region].concat()).expect(0);
    assert!(!run.out.contains("viewers  "), "{}", run.out);
    assert_eq!(bounds("other.pvs"), Aabb { min: [1.0, 0.0, 1.0], max: [2.0; 3] });
    let info = folder.run(&["info", "level.glb"]).expect(0).out;
    assert!(info.contains("moving         2 objects: 1 within a box, 1 anywhere\n"), "{info}");
    let info = folder.run(&["info", "level.glb", "--json"]).expect(0).json();
    let movers = info["movers"].as_array().expect("a list");
    let is_anywhere = |mover: &serde_json::Value| mover["min"].is_null() && mover["max"].is_null();
    assert_eq!(movers.iter().map(is_anywhere).collect::<Vec<_>>(), [true, false]);
    // The box of the door: as wide around it as its diagonal, a bit more than 2.23.
    assert_eq!(movers[1]["name"], "Window glass.033");
    let low = movers[1]["min"][0].as_f64().expect("a number");
    assert!((low - (4.1 - 2.2366)).abs() < 1e-3, "{low}");
    assert_eq!(info["view_volumes"][0]["max"], serde_json::json!([7.5, 3.0, 5.5]));
}

/// A volume without room is named in all reports, and viewers may be anywhere.
#[test]
fn flat_view_volumes_are_named() {
    let folder = Folder::new();
    folder.write("flat.glb", levels::with_flat_view_volume());
    folder.write("level.glb", levels::blender_with_extras());
    let build = |file: &str, more: &str| {
        folder.run(&["build", file, "-o", "t.pvs", "--grid", "2,1,1", "--method", "shafts", more]).expect(0)
    };
    let run = build("flat.glb", "-v");
    let warning =
        "1 view volume is flat and ignored, the first is called \"Alarm-noimp.034\": viewers have no room there";
    assert!(run.err.contains(warning), "{}", run.err);
    let line = "ignored        1 flat view volume, where viewers have no room: Alarm-noimp.034\n";
    assert!(run.out.contains(line) && !run.out.contains("viewers  "), "{}", run.out);
    assert!(folder.run(&["info", "flat.glb"]).expect(0).out.contains(line));
    assert!(build("flat.glb", "--quiet").out.contains(", 1 flat view volume ignored"));
    let told = build("flat.glb", "--json").json();
    assert_eq!(told["n_ignored_view_volumes"], 1);
    assert_eq!(told["ignored_view_volumes"], serde_json::json!(["Alarm-noimp.034"]));
    // The twin: a volume with room is not.
    let run = build("level.glb", "-v");
    assert!(
        !run.err.contains("flat") && !run.out.contains("flat") && run.out.contains("viewers  "),
        "{}{}",
        run.out,
        run.err
    );
    assert_eq!(build("level.glb", "--json").json()["n_ignored_view_volumes"], 0);
}

/// What engines may draw from the front only is counted, and what of it hides from its front only: a single sheet in the middle of a room. If backs
/// are culled, what viewers in cells see of the backs of closed things is bounded.
#[test]
fn single_sides_are_counted() {
    let folder = Folder::with_tower();
    let scene = read_scene(folder.path("tower.glb")).unwrap().scene;
    let n_objects = scene.objects().len() as u32;
    let single = scene.clone().with_single_sided((0..n_objects).collect()).unwrap();
    folder.write("single.glb", write_glb(&single).unwrap());
    let build = |file: &str, more: &[&str]| folder.run(&[&["build", file, "-o", "t.pvs"], more].concat()).expect(0).out;
    let backs = |file: &str| {
        let built: serde_json::Value = serde_json::from_str(&build(file, &["--backs", "culled", "--json"])).unwrap();
        let count = |key: &str| built["backs"][key].as_u64().expect("a count");
        assert_eq!(
            built["n_single_sided_triangles"].as_u64(),
            Some(read_scene(folder.path(file)).unwrap().scene.n_triangles() as u64)
        );
        [count("n_at_most"), count("n_by_rays"), built["n_front_occluding_triangles"].as_u64().expect("a count")]
    };
    let [at_most, by_rays, n_fronts] = backs("single.glb");
    assert!(by_rays <= at_most && at_most < scene.n_triangles() as u64, "{by_rays} to {at_most}");
    // The impostor: a sheet across a room, of which both sides are in cells.
    let b = scene.bounds();
    // In single precision, as the file has it.
    let at = |u: f64, k: usize| f64::from((b.min[k] + u * (b.max[k] - b.min[k])) as f32);
    let x = at(0.3, 0);
    let corners = [[x, at(0.2, 1), at(0.2, 2)], [x, at(0.8, 1), at(0.2, 2)], [x, at(0.8, 1), at(0.3, 2)]];
    let sheet = SceneObject { name: "sheet".to_owned(), vertices: corners.to_vec(), triangles: vec![[0, 1, 2]] };
    let objects = [scene.objects(), &[sheet]].concat();
    let with = Scene::new(objects).unwrap().with_single_sided((0..=n_objects).collect()).unwrap();
    folder.write("sheet.glb", write_glb(&with).unwrap());
    let [more, met, n_more] = backs("sheet.glb");
    assert_eq!(n_more, n_fronts + 1);
    let text = build("sheet.glb", &[]);
    let line = format!(" single-sided triangles, of which {n_more} hide from their fronts only");
    assert!(text.contains(&line), "{text}");
    let text = build("sheet.glb", &["-v", "--backs", "culled"]);
    let line = format!("               from behind, viewers in cells see at most {more} of them; rays met {met}\n");
    assert!(text.contains(&line), "{text}");
    // Both sides are drawn, so nothing is said of backs, and all of them hide from both sides. The old name still works.
    let built: serde_json::Value = serde_json::from_str(&build("sheet.glb", &["--backs", "drawn", "--json"])).unwrap();
    assert_eq!((built.get("backs"), built["n_front_occluding_triangles"].as_u64()), (None, Some(0)));
    let old = folder.run(&["build", "sheet.glb", "-o", "old.pvs", "--both-sides"]).expect(0);
    assert!(old.err.contains("use --backs drawn"), "{}", old.err);
    build("sheet.glb", &["--backs", "drawn"]);
    assert_eq!(folder.read("old.pvs"), folder.read("t.pvs"));
}

/// A door that stands shut in its file is open for the table, and there is a portal that a program may close.
#[test]
fn doors_close_portals_of_their_table() {
    let folder = Folder::new();
    folder.write("level.glb", levels::with_doors());
    let build = ["build", "level.glb", "-o", "level.pvs"];
    let run = folder.run(&build).expect(0);
    assert!(run.out.lines().next().is_some_and(|line| line.contains(", 6 doors")), "{}", run.out);
    let run = folder.run(&[&build[..], &["-v"]].concat()).expect(0);
    assert!(run.out.contains("doors          6, open; 6 close portals when shut\n"), "{}", run.out);
    let doors = folder.run(&[&build[..], &["--json"]].concat()).expect(0).json()["doors"].clone();
    let portals: Vec<String> = doors
        .as_array()
        .expect("a list")
        .iter()
        .map(|door| {
            let [portal] = &door["portals"].as_array().expect("a list")[..] else { panic!("{door}") };
            portal.to_string()
        })
        .collect();
    assert_eq!(portals.len(), 6);
    // Whatever method hides beside sightlines.
    let both = folder.run(&["build", "level.glb", "-o", "both.pvs", "--method", "both", "--json"]).expect(0).json();
    assert_eq!(both["doors"], doors);
    assert!(both["cut_seconds"].as_f64() < both["seconds"].as_f64());
    // From the first room with open doors, with its own door shut, and with another one shut.
    let sees = |shut: &[&str], place: &str| {
        let closed = shut.iter().flat_map(|portal| ["--closed", portal]).collect::<Vec<_>>();
        let look = ["query", "level.pvs", "--eye", "2,1.7,2", "--method", "exact", "--json"];
        let found = folder.run(&[&look[..], &closed].concat()).expect(0).json();
        let place = folder.run(&["query", "level.pvs", "--eye", place, "--json"]).expect(0).json()["cell"].clone();
        let cells = found["visible"].as_array().unwrap_or_else(|| panic!("{found}")).clone();
        cells.contains(&place)
    };
    let (corridor, own) = ("1.5,1.7,4.5", "3.5,1.7,3");
    assert!(sees(&[], corridor) && sees(&[], own));
    assert!(!sees(&[&portals[0]], corridor) && sees(&[&portals[0]], own));
    assert!(sees(&[&portals[1]], corridor));
    folder.run(&["verify", "level.pvs", "level.glb", "--rays", "5000"]).expect(0);
}
