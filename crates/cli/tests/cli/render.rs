//! What one eye sees: the methods agree, culling changes nothing, the printed numbers are those of the pictures, and what cannot be drawn is
//! refused in one line.

use crate::common::Folder;
use crate::common::looks::table;
use crate::common::picture::Picture;
use serde_json::Value;
use sightlines::pvs::{ObjectId, Table};
use sightlines::report::{MARK, NOWHERE, face_colour};
use std::collections::BTreeSet;

/// Three bars, each with one end in front of the next one.
const CYCLE: &str = "v -3 -2 6\nv -3 -1 6\nv 3 -1.5 3\nv 2 -3 6\nv 3 -3 6\nv 0 3 3\nv 1 3 6\nv 1 2 6\nv -2.5 -3 3\n\
                     f 1 2 3\nf 4 5 6\nf 7 8 9\n";
/// From the middle of a room of the small tower, slightly aside, so that no ray runs along a wall.
const ROOM: [&str; 6] = ["--eye", "1.3,1.61,1.9", "--look-at", "6.1,1.17,2.3", "--size", "96x72"];
const FRONT: [&str; 6] = ["--eye", "0,0,0", "--look-at", "0,0,1", "--size", "96x72"];
/// Those that are exact.
const EXACT: [&str; 6] = ["newell", "schumacker", "bsp", "bsp-front", "zbuffer", "raycast"];

fn with_cycle() -> Folder {
    let folder = Folder::new();
    folder.write("cycle.obj", CYCLE);
    folder
}

/// Draws `out.png` and gives what was printed as JSON.
fn render(folder: &Folder, scene: &str, view: &[&str], more: &[&str]) -> Value {
    let args = [&["render", scene, "-o", "out.png", "--json"][..], view, more].concat();
    folder.run(&args).expect(0).json()
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is a count"))
}

/// JSON without what is never the same twice.
fn without_times(mut value: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.retain(|key, _| !key.ends_with("seconds"));
                map.values_mut().for_each(strip);
            }
            Value::Array(list) => list.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

#[test]
fn exact_methods_draw_the_same_picture_in_the_colours_of_faces() {
    let tower = Folder::with_tower();
    let cycle = with_cycle();
    let mut n = 0;
    for (folder, scene, view) in [(&tower, "tower.glb", ROOM), (&cycle, "cycle.obj", FRONT)] {
        let mut first: Option<Vec<u8>> = None;
        for method in EXACT {
            let info = render(folder, scene, &view, &["--method", method]);
            let made = folder.read("out.png");
            let picture = Picture::decode(&folder.read("out.png"));
            assert_eq!(picture.size, [96, 72]);
            let row = &info["pictures"][0];
            assert_eq!(number(&row["covered"]) as usize, picture.pixels.len() - picture.count(NOWHERE), "{method}");
            let known: BTreeSet<[u8; 3]> = (0..number(&info["n_faces"]) as u32).map(face_colour).collect();
            assert!(picture.pixels.iter().all(|p| *p == NOWHERE || known.contains(p)), "{method}");
            assert!(first.is_none_or(|first| first == made), "{scene} by {method}");
            first = Some(made);
            n += 1;
        }
    }
    assert_eq!(n, 2 * EXACT.len());
}

/// The bars hide each other all round, so whatever the painter draws last is wrong somewhere; no other method is.
#[test]
fn the_painter_is_wrong_and_the_sheet_marks_where() {
    let folder = with_cycle();
    let info = render(&folder, "cycle.obj", &FRONT, &["--compare"]);
    let sheet = Picture::decode(&folder.read("out.png"));
    let rows = info["pictures"].as_array().expect("rows");
    let mut wrong = 0;
    for row in rows {
        let method = row["method"].as_str().expect("a name");
        let n = number(&row["wrong"]);
        wrong += n as usize;
        assert_eq!(number(&row["in_doubt"]), 0, "{method}");
        assert_eq!(n > 0, method == "painter", "{method}: {n} wrong");
    }
    // A sheet without errors has the mark in its legend only; the rims of what is wrong are less than all of it.
    render(&folder, "cycle.obj", &FRONT, &["--compare", "--method", "newell"]);
    let n_legend = Picture::decode(&folder.read("out.png")).count(MARK);
    assert!(n_legend > 0 && (1..=wrong).contains(&(sheet.count(MARK) - n_legend)), "{n_legend}, {wrong}");
    // Of the painter's own picture as many pixels are unlike.
    render(&folder, "cycle.obj", &FRONT, &["--method", "painter"]);
    let painted = Picture::decode(&folder.read("out.png"));
    render(&folder, "cycle.obj", &FRONT, &["--method", "raycast"]);
    assert_eq!(painted.differs(&Picture::decode(&folder.read("out.png"))), wrong);
    // The impostor: one changed pixel is a difference.
    let mut changed = painted.clone();
    changed.pixels[7][1] ^= 1;
    assert_eq!(changed.differs(&painted), 1);
}

#[test]
fn all_methods_are_compared_or_those_that_are_named() {
    let folder = with_cycle();
    let names = |more: &[&str]| -> Vec<String> {
        let info = render(&folder, "cycle.obj", &FRONT, &[&["--compare"], more].concat());
        let name = |row: &Value| row["method"].as_str().expect("a name").to_owned();
        info["pictures"].as_array().expect("rows").iter().map(name).collect()
    };
    let all = names(&[]);
    assert_eq!(all.len(), 11, "{all:?}");
    assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
    for method in ["painter", "newell", "zbuffer", "zbuffer-f32-reversed", "zbuffer-u24", "raycast"] {
        assert!(all.iter().any(|name| name == method), "{all:?}");
    }
    assert_eq!(names(&["--method", "zbuffer,painter", "--depth", "f32"]), ["zbuffer-f32", "painter", "raycast"]);
    assert_eq!(names(&["--method", "raycast,painter"]), ["raycast", "painter"]);
}

#[test]
fn two_runs_give_the_same() {
    let folder = Folder::with_tower();
    let more = ["--compare", "--cull", "frustum,backface"];
    let first = (without_times(render(&folder, "tower.glb", &ROOM, &more)), folder.read("out.png"));
    let second = (without_times(render(&folder, "tower.glb", &ROOM, &more)), folder.read("out.png"));
    assert!(first == second);
}

/// What is left out by the view and by the table is more than nothing, and no pixel misses it.
#[test]
fn the_view_and_the_table_change_no_pixel() {
    let folder = Folder::with_tower();
    folder.run(&["pack", "tower.pvs", "-o", "tower.pvz"]).expect(0);
    let whole = render(&folder, "tower.glb", &ROOM, &["--method", "zbuffer"]);
    let picture = folder.read("out.png");
    assert_eq!(whole["culled"], serde_json::json!([]));
    let ways: [(&str, &[&str]); 4] = [
        ("frustum", &[]),
        ("frustum,hierarchical-z", &[]),
        ("pvs", &["--table", "tower.pvs"]),
        ("pvs,frustum", &["--table", "tower.pvz"]),
    ];
    for (cull, table) in ways {
        for method in ["zbuffer", "bsp-front", "raycast"] {
            let more = [&["--method", method, "--cull", cull], table].concat();
            let info = render(&folder, "tower.glb", &ROOM, &more);
            assert!(folder.read("out.png") == picture, "{cull} for {method}");
            let gone: Vec<u64> =
                info["culled"].as_array().expect("ways").iter().map(|g| number(&g["n_faces"])).collect();
            assert!(gone.len() == cull.split(',').count() && gone.iter().all(|&n| n > 0), "{cull}: {gone:?}");
            assert_eq!(number(&info["n_drawn"]) + gone.iter().sum::<u64>(), number(&whole["n_drawn"]), "{cull}");
        }
    }
    let info = render(&folder, "tower.glb", &ROOM, &["--compare", "--cull", "pvs", "--table", "tower.pvs"]);
    assert!(exact_rows(&info).iter().all(|row| row["wrong"] == 0));
}

/// The rows of those methods that are exact.
fn exact_rows(info: &Value) -> Vec<&Value> {
    let exact = |row: &&Value| EXACT.contains(&row["method"].as_str().expect("a name"));
    let rows: Vec<&Value> = info["pictures"].as_array().expect("rows").iter().filter(exact).collect();
    assert_eq!(rows.len(), EXACT.len());
    rows
}

/// The impostor: a table that hides what is seen. All methods miss the same pixels, and those of the ray caster as well.
#[test]
fn a_table_that_hides_too_much_is_noticed() {
    let folder = Folder::with_tower();
    let mut parts = table(&folder, "tower.pvs").into_parts();
    let seen = parts.objects_seen.as_mut().expect("a table of a scene has objects");
    for (cell, touching) in parts.cell_objects.iter().enumerate() {
        for object in 0..parts.objects.len() {
            seen.set(cell, object, touching.contains(&ObjectId(object as u32)));
        }
    }
    folder.write("blind.pvs", Table::new(parts).expect("a sound table, though a wrong one").to_bytes());
    let info = render(&folder, "tower.glb", &ROOM, &["--compare", "--cull", "pvs", "--table", "blind.pvs"]);
    let wrong: BTreeSet<u64> = exact_rows(&info).into_iter().map(|row| number(&row["wrong"])).collect();
    assert!(wrong.len() == 1 && !wrong.contains(&0), "{wrong:?}");
}

/// Only what lies between two depths is seen, by all methods alike.
#[test]
fn near_and_far_cut_for_all_methods() {
    let folder = with_cycle();
    let covered = |more: &[&str]| -> BTreeSet<u64> {
        let info = render(&folder, "cycle.obj", &FRONT, &[&["--compare"], more].concat());
        assert!(exact_rows(&info).iter().all(|row| row["wrong"] == 0));
        exact_rows(&info).iter().map(|row| number(&row["covered"])).collect()
    };
    let [all, some, none] =
        [&[][..], &["--near", "3.5", "--far", "5"], &["--near", "6.5"]].map(|more| covered(more).into_iter().collect());
    let [all, some, none]: [Vec<u64>; 3] = [all, some, none];
    assert!(all.len() == 1 && some.len() == 1 && none == [0], "{all:?} {some:?} {none:?}");
    assert!(0 < some[0] && some[0] < all[0], "{all:?} {some:?}");
}

/// From behind a bar, and from outside every cell.
#[test]
fn back_faces_go_and_outside_of_all_cells_nothing_does() {
    let folder = with_cycle();
    let behind = ["--eye", "0,0,9", "--look-at", "0,0,1", "--size", "64x64", "--method", "raycast"];
    let [front, back] = [&FRONT[..], &behind].map(|view| {
        let more: &[&str] = if view.contains(&"raycast") { &[] } else { &["--method", "raycast"] };
        let info = render(&folder, "cycle.obj", view, &[more, &["--cull", "backface"]].concat());
        number(&info["culled"][0]["n_faces"])
    });
    assert_eq!(front + back, 3, "what shows its back from here shows its front from there");
    let tower = Folder::with_tower();
    let far = ["--eye", "-50,90,-70", "--look-at", "4,1,2", "--method", "zbuffer", "--cull", "pvs"];
    let args = [&["render", "tower.glb", "-o", "out.png", "--json", "--table", "tower.pvs"][..], &far].concat();
    let run = tower.run(&args).expect(0);
    assert!(run.err.contains("tower.pvs: the eye is outside every cell, where everything may be seen"), "{}", run.err);
    assert_eq!(run.json()["culled"][0]["n_faces"], 0);
}

#[test]
fn objects_have_colours_too() {
    let folder = Folder::with_tower();
    let info = render(&folder, "tower.glb", &ROOM, &["--method", "zbuffer", "--by-object"]);
    let picture = Picture::decode(&folder.read("out.png"));
    let known: BTreeSet<[u8; 3]> = (0..number(&info["n_objects"]) as u32).map(face_colour).collect();
    let seen: BTreeSet<[u8; 3]> = picture.pixels.iter().copied().filter(|p| *p != NOWHERE).collect();
    assert!(seen.len() > 1 && seen.is_subset(&known));
}

#[test]
fn results_are_printed() {
    let folder = with_cycle();
    let run =
        folder.run(&[&["render", "cycle.obj", "-o", "a.png", "--method", "zbuffer"][..], &FRONT].concat()).expect(0);
    let lines: Vec<&str> = run.out.lines().collect();
    assert_eq!(lines[..2], ["cycle.obj: 3 faces of 1 object, 96 x 72 pixels", "to draw        3 faces"]);
    assert_eq!(lines[2], "drawn          by zbuffer: 3 faces, 3 fragments, 0 splits");
    assert!(lines[3].starts_with("tests          depth "), "{}", lines[3]);
    assert!(
        lines[4].starts_with("pixels         ") && lines[4].contains(" % covered, each written 1."),
        "{}",
        lines[4]
    );
    assert!(lines[5].starts_with("time           ") && lines[5].ends_with(" to draw"), "{}", lines[5]);
    assert_eq!(lines[6..], ["wrote          a.png"]);
    let args = ["render", "cycle.obj", "-o", "b.png", "--compare", "--method", "painter", "--cull", "frustum"];
    let run = folder.run(&[&args[..], &FRONT].concat()).expect(0);
    let lines: Vec<Vec<&str>> = run.out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines[1][..6], ["left", "out", "0", "faces", "by", "frustum,"]);
    assert_eq!(lines[3][..3], ["no", "method", "wrong"]);
    assert_eq!([lines[4][..2].to_vec(), lines[5][..3].to_vec()], [vec!["1", "painter"], vec!["2", "raycast", "0"]]);
    assert_eq!(folder.names(), ["a.png", "b.png", "cycle.obj"]);
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let folder = Folder::with_tower();
    folder.write("cycle.obj", CYCLE);
    folder.write("named.obj", format!("o bar\n{CYCLE}"));
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    folder.write("maze.geojson", crate::common::maze_text(1));
    folder.run(&["build", "cycle.obj", "-o", "cycle.pvs"]).expect(0);
    folder.run(&["build", "maze.geojson", "-o", "maze.pvs"]).expect(0);
    folder.write("picture.png", CYCLE);
    let before = folder.names();
    let way = |scene: &str, eye: &str, at: &str, more: &[&str]| {
        folder.refused(&[&["render", scene, "--eye", eye, "--look-at", at, "--method", "zbuffer"][..], more].concat())
    };
    let out = ["-o", "out.png"];
    let with = |more: &[&str]| way("cycle.obj", "0,0,0", "0,0,1", &[&out[..], more].concat());
    let missing = way("none.obj", "0,0,0", "0,0,1", &out);
    assert!(missing.starts_with("none.obj: "), "{missing}");
    let nowhere = way("cycle.obj", "0,0,0", "0,0,1", &["-o", "no/such/folder.png"]);
    assert!(nowhere.starts_with("no/such/folder.png: "), "{nowhere}");
    assert_eq!(
        way("points.obj", "0,0,0", "0,0,1", &out),
        "points.obj: no triangles (0 objects, 0 triangles without area)"
    );
    assert_eq!(way("maze.geojson", "0,0,0", "0,0,1", &out), "maze.geojson: neither a GLB nor a glTF nor an OBJ scene");
    assert_eq!(way("tower.pvs", "0,0,0", "0,0,1", &out), "tower.pvs: neither a GLB nor a glTF nor an OBJ scene");
    assert_eq!(
        way("cycle.obj", "0,0,0", "0,0,1", &["-o", "out.svg"]),
        "out.svg: the picture is written as PNG; give a name that ends in .png"
    );
    let blind =
        "--look-at: the eye looks nowhere: what it looks at is where it is, or straight up or down, or not finite";
    assert_eq!(way("cycle.obj", "0,0,0", "0,5,0", &out), blind);
    assert_eq!(way("cycle.obj", "1,2,3", "1,2,3", &out), blind);
    assert_eq!(with(&["--up", "0,0,2"]), blind);
    assert_eq!(with(&["--fov", "180"]), "--fov: the angle of view is not between 0 and 180 degrees");
    assert_eq!(with(&["--fov", "NaN"]), "--fov: the angle of view is not between 0 and 180 degrees");
    for size in ["0x480", "640x0", "16385x1"] {
        assert_eq!(with(&["--size", size]), "--size: a picture has from 1 to 16384 pixels along each side");
    }
    for depths in [["--near", "-1"], ["--near", "NaN"], ["--far", "0"], ["--near", "inf"], ["--far", "NaN"]] {
        assert_eq!(with(&depths), "--near, --far: the nearest depth is not at least 0 and less than the farthest");
    }
    assert_eq!(with(&["--method", "raycast"]), "--method: several methods are drawn with --compare only; name one");
    let sheet = with(&["--compare", "--size", "16384x16384"]);
    assert!(sheet.starts_with("--size: 6 pictures of 16384 by 16384 pixels make a sheet of more than "), "{sheet}");
    assert_eq!(with(&["--cull", "pvs"]), "--cull pvs: this needs a table of the scene: name it with --table");
    assert_eq!(with(&["--table", "cycle.pvs"]), "--table: the table is not used: add --cull pvs");
    let asked =
        |scene: &str, table: &str| way(scene, "0,0,0", "0,0,1", &["-o", "out.png", "--cull", "pvs", "--table", table]);
    assert_eq!(asked("cycle.obj", "maze.pvs"), "maze.pvs: does not go with cycle.obj: the table is of a plan");
    let other = asked("tower.glb", "cycle.pvs");
    assert!(other.starts_with("cycle.pvs: does not go with tower.glb: the table has 1 objects, the scene "), "{other}");
    let name = asked("named.obj", "cycle.pvs");
    assert!(name.starts_with("cycle.pvs: does not go with named.obj: object 0 is called "), "{name}");
    folder.write("moved.obj", CYCLE.replace("v 0 3 3", "v 0 9 3"));
    let moved = asked("moved.obj", "cycle.pvs");
    assert!(moved.starts_with("cycle.pvs: does not go with moved.obj: object 0, "), "{moved}");
    std::fs::remove_file(folder.path("moved.obj")).expect("it was written");
    let none = asked("cycle.obj", "none.pvs");
    assert!(none.starts_with("none.pvs: "), "{none}");
    // The output would replace what it is made from.
    let args = ["render", "cycle.obj", "--eye", "0,0,0", "--look-at", "0,0,1", "--method", "bsp"];
    std::fs::copy(folder.path("cycle.pvs"), folder.path("table.png")).expect("the folder can be written");
    let same = folder.refused(&[&args[..], &["-o", "table.png", "--cull", "pvs", "--table", "table.png"]].concat());
    assert_eq!(same, "table.png: the output would replace the input");
    std::fs::remove_file(folder.path("table.png")).expect("it was written");
    assert_eq!(
        way("picture.png", "0,0,0", "0,0,1", &["-o", "picture.png"]),
        "picture.png: the output would replace the input"
    );
    assert_eq!(
        folder.refused(&[&args[..], &out, &["--depth", "f32"]].concat()),
        "--depth: this is the format of a z-buffer, and none is drawn: add --method zbuffer"
    );
    assert_eq!(folder.names(), before);
}

/// What the arguments' own words refuse: exit code 2, and the reason is named.
#[test]
fn bad_arguments_are_refused() {
    let folder = with_cycle();
    let plain = ["--eye", "0,0,0", "--look-at", "0,0,1", "--method", "bsp"];
    let cases: [(&[&str], &str); 9] = [
        (
            &["--eye", "0,0", "--look-at", "0,0,1", "--method", "bsp"],
            "a point in space is three comma-separated numbers",
        ),
        (&["--eye", "0,NaN,0", "--look-at", "0,0,1", "--method", "bsp"], "coordinate NaN is not a finite number"),
        (&["--eye", "0,0,0", "--look-at", "0,inf,1", "--method", "bsp"], "coordinate inf is not a finite number"),
        (&["--eye", "0,0,0", "--look-at", "0,0,x", "--method", "bsp"], "'x' is not a number"),
        (&["--look-at", "0,0,1", "--method", "bsp"], "--eye <X,Y,Z>"),
        (&["--eye", "0,0,0", "--look-at", "0,0,1"], "--method <NAME"),
        (&["--eye", "0,0,0", "--look-at", "0,0,1", "--method", "magic"], "invalid value 'magic'"),
        (&[&plain[..], &["--size", "640"]].concat(), "a size is two whole numbers, such as 640x480"),
        (&[&plain[..], &["--up", "0,0,0"]].concat(), "the vector has no length"),
    ];
    for (args, reason) in cases {
        let run = folder.run(&[&["render", "cycle.obj", "-o", "a.png"], args].concat()).expect(2);
        assert!(run.out.is_empty() && run.err.contains(reason), "{args:?}: {}", run.err);
    }
    assert_eq!(folder.names(), ["cycle.obj"]);
}
