//! `simplify` and `levels`: scenes with fewer triangles, what they may be used for, and what is refused.

use crate::common::{Folder, levels, names, one_floor};
use serde_json::{Value, json};
use sightlines::cells::Scene;
use sightlines::formats::levels::read_levels_index;
use sightlines::formats::scene::{parse_glb, read_scene};
use std::collections::BTreeSet;

/// A box in the small tower.
const VOLUME: &str = "1,0.5,1,2,1.5,2";

/// A wall with a triangle behind it, and one before it; and a box from where the wall hides the one.
const WALL: &str = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nv 0 0 1\nv 1 0 1\nv 0 1 1\n\
                    o wall\nusemtl red\nf 1 2 3 4\no behind\nf 5 6 7\no before\nf 8 9 10\n";
const BEFORE_WALL: &str = "-0.5,-0.5,4,0.5,0.5,5";

/// The triangles of all objects, by name, with the bits of their corners.
fn triangles(scene: &Scene) -> BTreeSet<(String, [[u64; 3]; 3])> {
    let of = |o: &sightlines::cells::SceneObject| -> Vec<_> {
        o.corners().map(|t| (o.name.clone(), t.map(|p| p.map(f64::to_bits)))).collect()
    };
    scene.objects().iter().flat_map(of).collect()
}

fn simplified(folder: &Folder, out: &str, more: &[&str]) -> Value {
    let args = ["simplify", "tower.glb", "-o", out, "--json", "-q"];
    folder.run(&[&args[..], more].concat()).expect(0).json()
}

#[test]
fn what_is_hidden_goes_and_the_rest_stays() {
    let folder = Folder::with_bare_tower();
    let reply = simplified(&folder, "o.glb", &["--volume", VOLUME, "--report"]);
    let n = |key: &str| reply[key].as_u64().unwrap_or_else(|| panic!("{key}: {reply}"));
    assert_eq!(n("n_before"), n("n_hidden") + n("n_left"));
    assert!(n("n_hidden") > 0 && n("n_left") > 0, "{reply}");
    assert_eq!(
        (&reply["bound"], &reply["occluder"], &reply["method"]),
        (&json!(0.0), &json!(true), &json!("multifocal"))
    );
    assert_eq!(
        (&reply["report"]["changed"], &reply["report"]["worst"], &reply["report"]["estimate"]),
        (&json!(0.0), &json!(0.0), &json!(0.0))
    );
    assert_eq!(reply["report"]["n_rays"], json!(1_000_000));
    let [before, after] = ["tower.glb", "o.glb"].map(|name| read_scene(folder.path(name)).unwrap());
    assert_eq!(after.info.simplified.map(|s| s.occluder), Some(true));
    assert_eq!(after.info.n_triangles as u64, n("n_left"));
    assert!(triangles(&after.scene).is_subset(&triangles(&before.scene)));
    // It lies inside of the original, so it may be built from; from there nothing more is hidden.
    folder.run(&["build", "o.glb", "-o", "o.pvs", "-q"]).expect(0);
    let again = folder.run(&["simplify", "o.glb", "--volume", VOLUME, "-o", "o.glb", "--json", "-q"]).expect(0).json();
    assert_eq!(again["n_before"], reply["n_left"]);

    // The same bytes with any number of threads; nothing else is left behind.
    for (out, threads) in [("a.glb", "1"), ("b.glb", "3")] {
        simplified(&folder, out, &["--volume", VOLUME, "--budget", "0.001", "--threads", threads]);
    }
    assert!(folder.read("a.glb") == folder.read("b.glb"));
    assert_eq!(folder.names(), ["a.glb", "b.glb", "o.glb", "o.pvs", "tower.glb", "tower.pvs"]);

    // More eyes see more, and less is hidden from all of them.
    let both = simplified(&folder, "c.glb", &["--volume", VOLUME, "--volume", "4,0.5,1,5,1.5,2"]);
    assert!(both["n_left"].as_u64() >= reply["n_left"].as_u64());
    let nobody = simplified(&folder, "c.glb", &["--volume", VOLUME, "--method", "none"]);
    assert_eq!((&nobody["n_hidden"], &nobody["n_left"]), (&json!(0), &reply["n_before"]));
    // The rays of a report are quick in a scene of a few triangles.
    folder.write("wall.obj", WALL);
    let text = folder.run(&["simplify", "wall.obj", "--volume", BEFORE_WALL, "-o", "c.glb", "--report"]).expect(0).out;
    for line in [
        "eyes           in a box; hidden by multifocal\n",
        "promised       0.0 %",
        "measured       0.0 % of 1000000 rays",
        "lies inside of the original",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
}

#[test]
fn budgets_are_kept_and_moved_scenes_hide_nothing() {
    let folder = Folder::with_tower();
    let reply = simplified(&folder, "m.glb", &["--volume", VOLUME, "--budget", "0.02", "--collapse", "1", "--report"]);
    let share = |key: &str| reply[key].as_f64().unwrap();
    assert!(share("bound") <= 0.02 && reply["report"]["changed"].as_f64().unwrap() <= share("bound"), "{reply}");
    let hidden = simplified(&folder, "h.glb", &["--volume", VOLUME]);
    assert!(reply["n_left"].as_u64() < hidden["n_left"].as_u64());
    assert!(reply["n_new"].as_u64() > Some(0), "{reply}");
    assert_eq!(reply["occluder"], json!(false));
    assert_eq!(read_scene(folder.path("m.glb")).unwrap().info.simplified.map(|s| s.occluder), Some(false));
    let says = "m.glb: the scene was simplified and its triangles were moved, so that it may hide what can be seen: use the \
                original that it was made from";
    let render = ["render", "m.glb", "--eye", "1,1,1", "--look-at", "2,1,2", "--method", "raycast", "-o", "m.png"];
    for args in [
        &["build", "m.glb", "-o", "m.pvs"][..],
        &["build", "m.glb", "-o", "m.pvs", "--method", "multifocal", "--grid", "1,1,1"],
        &["multifocal", "m.glb", "--volume", VOLUME, "--plane", "z=20", "-o", "m.png"],
        &[&render[..], &["--cull", "pvs", "--table", "tower.pvs"]].concat(),
        &["simplify", "m.glb", "--volume", VOLUME, "-o", "n.glb"],
        &["levels", "m.glb", "--table", "tower.pvs", "-o", "n"],
    ] {
        assert_eq!(folder.refused(args), says, "{args:?}");
    }
    // It may be looked at.
    folder.run(&[&render[..], &["--size", "16x16"]].concat()).expect(0);
    folder.run(&["info", "m.glb"]).expect(0);
}

#[test]
fn cells_of_a_table_are_views_too() {
    let folder = Folder::new();
    folder.write("rooms.obj", three_rooms());
    folder.run(&["build", "rooms.obj", "-o", "rooms.pvs", "-q"]).expect(0);
    let simplified = |more: &[&str]| {
        let args = ["simplify", "rooms.obj", "-o", "t.glb", "--json", "-q", "--table", "rooms.pvs", "--cell", "0,1"];
        folder.run(&[&args[..], more].concat()).expect(0).json()
    };
    let by_table = simplified(&["--method", "none", "--report"]);
    // The table in the last room, and the wall behind it.
    assert!(by_table["n_hidden"].as_u64() >= Some(4) && by_table["n_left"].as_u64() > Some(0), "{by_table}");
    assert_eq!(by_table["report"]["changed"], json!(0.0));
    let by_both = simplified(&[]);
    assert!(by_both["n_hidden"].as_u64() >= by_table["n_hidden"].as_u64());
}

/// Three closed rooms in a row, with a table in the last one.
fn three_rooms() -> String {
    let mut text = String::new();
    for (name, [min, max]) in [
        ("wall", [[0, 0, 0], [0, 3, 4]]),
        ("wall", [[4, 0, 0], [4, 3, 4]]),
        ("wall", [[8, 0, 0], [8, 3, 4]]),
        ("wall", [[12, 0, 0], [12, 3, 4]]),
        ("side", [[0, 0, 0], [12, 3, 0]]),
        ("side", [[0, 0, 4], [12, 3, 4]]),
        ("floor", [[0, 0, 0], [12, 0, 4]]),
        ("ceiling", [[0, 3, 0], [12, 3, 4]]),
        ("table", [[10, 1, 1], [11, 1, 3]]),
    ] {
        let [u, v] = match (0..3).find(|&k| min[k] == max[k]) {
            Some(0) => [1, 2],
            Some(1) => [0, 2],
            _ => [0, 1],
        };
        text += &format!("o {name}\n");
        for (far_u, far_v) in [(false, false), (true, false), (true, true), (false, true)] {
            let mut corner: [i32; 3] = min;
            for (axis, is_far) in [(u, far_u), (v, far_v)] {
                corner[axis] = if is_far { max[axis] } else { min[axis] };
            }
            text += &format!("v {} {} {}\n", corner[0], corner[1], corner[2]);
        }
        text += "f -4 -3 -2 -1\n";
    }
    text
}

/// A closed room with a floor of many squares, turned about z, in single precision.
fn room(degrees: f64) -> String {
    let (s, c) = degrees.to_radians().sin_cos();
    let vertex = |x: f64, y: f64, z: f64| {
        let [x, y, z] = [c * x - s * y, s * x + c * y, z].map(|x| f64::from(x as f32));
        format!("v {x} {y} {z}\n")
    };
    let grid = (0..25u32).map(|k| vertex(f64::from(k % 5) * 2.0, f64::from(k / 5) * 1.25, 0.0));
    let ceiling = [[0.0, 0.0], [8.0, 0.0], [8.0, 5.0], [0.0, 5.0]].map(|[x, y]| vertex(x, y, 3.0));
    let vertices: String = grid.chain(ceiling).collect();
    let squares: String = (0..16u32)
        .map(|k| {
            let a = k / 4 * 5 + k % 4 + 1;
            format!("f {a} {} {}\nf {a} {} {}\n", a + 1, a + 6, a + 6, a + 5)
        })
        .collect();
    format!("{vertices}o room\n{squares}f 26 29 28 27\nf 1 26 27 5\nf 5 27 28 25\nf 25 28 29 21\nf 21 29 26 1\n")
}

/// What is flat along a frame is so only nearly with the corners of the file: merged, it must not hide. The twins: not merged, and of a room that needs no
/// frame, it may.
#[test]
fn what_is_merged_along_a_frame_hides_nothing() {
    let folder = Folder::new();
    for (name, degrees) in [("turned", 20.0), ("upright", 0.0)] {
        let [obj, pvs, glb] = ["obj", "pvs", "glb"].map(|ending| format!("{name}.{ending}"));
        folder.write(&obj, room(degrees));
        folder.run(&["build", &obj, "-o", &pvs, "--gap", "1e-4", "-q"]).expect(0);
        for flat in [true, false] {
            let args =
                ["simplify", &obj, "--table", &pvs, "--cell", "0", "--method", "none", "-o", &glb, "--json", "-q"];
            let reply = folder.run(&[&args[..], if flat { &["--flat"] } else { &[] }].concat()).expect(0).json();
            assert_eq!(reply["n_merged"].as_u64() > Some(0), flat, "{name}: {reply}");
            let may_hide = !flat || name == "upright";
            assert_eq!(reply["occluder"], json!(may_hide), "{name}: {reply}");
            let said = read_scene(folder.path(&glb)).unwrap().info.simplified.map(|s| s.occluder);
            assert_eq!(said, Some(may_hide), "{name}");
        }
    }
}

#[test]
fn objs_lose_their_materials_and_nothing_else() {
    let folder = Folder::new();
    folder.write("s.obj", WALL.replace("before", "before-mirror"));
    let args = ["simplify", "s.obj", "--volume", BEFORE_WALL, "-o", "s.glb"];
    assert!(folder.run(&args).expect(2).err.contains("the scene has mirrors (1)"));
    let run = folder.run(&[&args[..], &["--ignore-mirrors"]].concat()).expect(0);
    assert!(run.err.contains("s.obj: of an OBJ, triangles and names are kept; materials are not"), "{}", run.err);
    let after = read_scene(folder.path("s.glb")).unwrap();
    let names: Vec<&str> = after.scene.objects().iter().map(|o| o.name.as_str()).collect();
    assert_eq!((names, after.scene.mirrors(), after.info.n_triangles), (vec!["wall", "before-mirror"], &[1][..], 3));
}

/// An OBJ of decimals that are no numbers of single precision, as most are: a wall with a square behind it, and one of glass before it.
fn decimals(far: f64) -> String {
    let [low, high] = [far - 9.1, far + 9.1];
    format!(
        "v {low} -9.1 0.1\nv {high} -9.1 0.1\nv {high} 9.1 0.1\nv {low} 9.1 0.1\nv {far} 0 -1.3\nv {} 0 -1.3\nv {far} 1 -1.3\n\
         v {far} 0.7 1\nv {} 0.7 1\nv {far} 1.7 1e-1\no the wall # 1\nf 1 2 3 4\no behind\nf 5 6 7\no glass\nf 8 9 10\n",
        far + 1.0,
        far + 0.3,
    )
}

/// As OBJ, coordinates are those of the input; as GLB they are rounded, which is said.
#[test]
fn decimals_are_kept_or_rounded_aloud() {
    let folder = Folder::new();
    for (far, most) in [(0.0, 1e-6), (430_000.0, 1e-6)] {
        folder.write("d.obj", decimals(far));
        let volume = format!("--volume={},-0.5,4,{},0.5,5", far - 0.5, far + 0.5);
        let run = |out: &str, more: &[&str]| {
            let args = ["simplify", "d.obj", &volume, "-o", out, "--see-through", "glass", "-q"];
            folder.run(&[&args[..], more].concat()).expect(0)
        };
        let read = |name: &str| read_scene(folder.path(name)).unwrap();
        let before = read("d.obj").scene;
        let of = |scene: &Scene, k: usize| scene.objects()[k].clone();
        let wanted = Scene::new(vec![of(&before, 0), of(&before, 2)]).unwrap().with_see_through(vec![1]).unwrap();

        let exact = run("e.obj", &["--json"]).json();
        assert!(exact.get("rounded").is_none() && exact["occluder"] == json!(true), "{exact}");
        assert!(!run("e.obj", &[]).out.contains("rounded"));
        let after = read("e.obj");
        assert_eq!(after.scene, wanted);
        assert_eq!(after.info.simplified.map(|s| s.occluder), Some(true));
        // An impostor has one bit of one coordinate flipped.
        let text = String::from_utf8(folder.read("e.obj")).unwrap();
        let flipped = text.replacen("-9.1 0.1", "-9.1 0.10000000000000002", 1);
        assert_ne!(text, flipped);
        folder.write("f.obj", flipped);
        assert_ne!(read("f.obj").scene, wanted);

        let rounded = run("r.glb", &["--json"]).json();
        let after = read("r.glb");
        let pairs = |scene: &Scene| -> Vec<f64> {
            scene.objects().iter().flat_map(|o| o.vertices.iter().flatten().copied()).collect()
        };
        let changes = || pairs(&after.scene).into_iter().zip(pairs(&wanted)).map(|(a, b)| (a - b).abs());
        let (n, largest) = (changes().filter(|x| *x > 0.0).count(), changes().fold(0.0, f64::max));
        assert_eq!(pairs(&after.scene).len(), pairs(&wanted).len());
        assert!(n > 0 && largest > 0.0 && largest < most, "{n} {largest:e}");
        assert_eq!(rounded["rounded"], json!({"n_coordinates": n, "largest": largest}));
        assert_eq!(rounded["bound"], json!(0.0));
        // What was moved, however little, must not hide.
        assert_eq!(rounded["occluder"], json!(false));
        assert_eq!(after.info.simplified.map(|s| s.occluder), Some(false));
        let line = format!("rounded        {n} coordinates to single precision, by at most {largest:.3e} units, ");
        assert!(run("r.glb", &[]).out.contains(&line), "{line}");
        assert!(folder.refused(&["build", "r.glb", "-o", "r.pvs"]).contains("its triangles were moved"));
        folder.run(&["build", "e.obj", "-o", "e.pvs", "-q"]).expect(0);
    }
    // A name says how to write.
    for (name, says) in [("d", "give a name that ends in .glb or .obj"), ("d.obj.txt", "ends in .glb or .obj")] {
        let error = folder.refused(&["simplify", "d.obj", "--volume=0,0,0,1,1,1", "-o", name]);
        assert!(error.contains(says), "{error}");
        assert!(!folder.path(name).exists());
    }
    // A number beyond single precision has none near it; as OBJ it is kept.
    folder.write("d.obj", decimals(0.0).replace("-1.3", "-1e39").replace("-9.1", "-1e39"));
    let args = ["simplify", "d.obj", "--volume=-0.5,-0.5,4,0.5,0.5,5", "--method", "none", "-q", "-o"];
    let error = folder.run(&[&args[..], &["h.glb"]].concat()).expect(2).err;
    assert!(error.contains("d.obj: object 0, vertex 0: -1e39 is not a number of single precision"), "{error}");
    folder.run(&[&args[..], &["h.obj"]].concat()).expect(0);
}

/// Levels are GLB, and say what they round; those that were moved by it do not hide.
#[test]
fn levels_of_decimals_are_rounded_aloud() {
    let folder = Folder::new();
    folder.write("room.obj", room(0.0).replace("1.25", "1.3"));
    folder.run(&["build", "room.obj", "-o", "room.pvs", "-q"]).expect(0);
    let args = ["levels", "room.obj", "--table", "room.pvs", "--method", "none", "-o", "l", "-q"];
    let reply = folder.run(&[&args[..], &["--json"]].concat()).expect(0).json();
    assert!(reply["rounded"]["n_coordinates"].as_u64() > Some(0), "{reply}");
    assert!(reply["rounded"]["largest"].as_f64().is_some_and(|x| x > 0.0 && x < 1e-6), "{reply}");
    assert!(folder.run(&args).expect(0).out.contains("rounded        "));
    let index = read_levels_index(folder.path("l/index.json")).unwrap();
    for level in &index.levels {
        let said = parse_glb(&folder.read(&format!("l/{}", level.file)), None).unwrap().info.simplified;
        assert_eq!((level.occluder, said.map(|s| s.occluder)), (false, Some(false)));
    }
}

#[test]
fn bad_input_is_refused() {
    let folder = Folder::with_bare_tower();
    folder.write("other.glb", one_floor(1, 1));
    folder.write("word.glb", "word");
    let refused = |args: &[&str], what: &str| {
        let run = folder.run(&[args, &["-q"]].concat()).expect(2);
        assert!(run.err.contains(what), "{args:?}: {}", run.err);
        assert!(run.out.is_empty());
    };
    let of = |more: &[&str], what: &str| refused(&[&["simplify", "tower.glb", "-o", "no.glb"], more].concat(), what);
    of(&["--volume", "2,0,0,1,1,1"], "the lower corner is above the upper one: 2 is more than 1");
    of(&["--volume", "0,0,0,1,1,NaN"], "not a finite number");
    for budget in ["-0.1", "1.5", "NaN", "x"] {
        of(&["--volume", VOLUME, "--budget", budget], "not a number from 0 to 1");
    }
    of(&[], "--volume");
    of(&["--table", "tower.pvs"], "--cell");
    of(&["--volume", VOLUME, "--table", "tower.pvs", "--cell", "0"], "cannot be used with");
    of(&["--table", "tower.pvs", "--cell", "99999"], "tower.pvs: the table has no cell 99999; it has ");
    of(&["--table", "none.pvs", "--cell", "0"], "none.pvs: ");
    of(&["--volume", VOLUME, "--texels", "8192", "--planes", "256"], "bytes for each thread");
    refused(
        &["simplify", "other.glb", "-o", "no.glb", "--table", "tower.pvs", "--cell", "0"],
        "tower.pvs: the table is of another scene: ",
    );
    refused(&["simplify", "tower.glb", "-o", "no.obj", "--volume", VOLUME], "give a name that ends in .glb");
    refused(&["simplify", "tower.glb", "-o", "no.ply", "--volume", VOLUME], "give a name that ends in .glb or .obj");
    refused(&["simplify", "tower.pvs", "-o", "no.glb", "--volume", VOLUME], "tower.pvs: neither a GLB nor");
    refused(&["simplify", "word.glb", "-o", "no.glb", "--volume", VOLUME], "word.glb: the glTF text cannot be read");
    refused(&["simplify", "tower.glb", "-o", "no/such/o.glb", "--volume", VOLUME], "no/such/o.glb: cannot be written");
    let levels = |more: &[&str], what: &str| {
        refused(&[&["levels", "tower.glb", "-o", "no", "--method", "none"], more].concat(), what)
    };
    levels(&[], "--table");
    levels(&["--table", "tower.pvs", "--memory", "10"], "10 bytes are too few: a level for all cells takes ");
    levels(&["--table", "tower.pvs", "--budget", "2"], "not a number from 0 to 1");
    refused(&["levels", "other.glb", "-o", "no", "--table", "tower.pvs"], "tower.pvs: the table is of another scene: ");
    refused(&["levels", "tower.glb", "-o", "tower.glb", "--table", "tower.pvs"], "tower.glb: cannot be made");
    std::fs::create_dir(folder.path("full")).unwrap();
    folder.write("full/letter.txt", "dear");
    refused(
        &["levels", "tower.glb", "-o", "full", "--table", "tower.pvs"],
        "the folder has \"letter.txt\" in it, which is no level",
    );
    assert_eq!(folder.names(), ["full", "other.glb", "tower.glb", "tower.pvs", "word.glb"]);
}

#[test]
fn levels_are_written_and_walked_with() {
    let folder = Folder::with_bare_tower();
    let args = [
        "levels",
        "tower.glb",
        "--table",
        "tower.pvs",
        "--budget",
        "0.001",
        "--collapse",
        "0",
        "--method",
        "none",
        "--json",
        "-q",
    ];
    let reply = folder.run(&[&args[..], &["-o", "l"]].concat()).expect(0).json();
    let index = read_levels_index(folder.path("l/index.json")).unwrap();
    let n_cells = folder.run(&["info", "tower.pvs", "--json"]).expect(0).json()["n_cells"].as_u64().unwrap();
    assert_eq!((index.cells.len() as u64, index.budget), (n_cells, 0.001));
    assert_eq!(reply["n_levels"], json!(index.levels.len()));
    let scene = read_scene(folder.path("tower.glb")).unwrap();
    assert_eq!(index.n_triangles as usize, scene.info.n_triangles);
    let mut files: Vec<String> = index.levels.iter().map(|level| level.file.clone()).collect();
    files.insert(0, "index.json".to_owned());
    files.sort();
    assert_eq!(names(&folder.path("l")), files);
    for level in &index.levels {
        assert!(level.bound <= 0.001 && level.n_triangles < index.n_triangles);
        let read = parse_glb(&folder.read(&format!("l/{}", level.file)), None).unwrap();
        assert_eq!(read.info.n_triangles as u64, level.n_triangles);
        assert_eq!(read.info.simplified.map(|s| s.occluder), Some(level.occluder));
    }
    // The same bytes again, over what is there, by another number of threads.
    folder.run(&[&args[..], &["-o", "m", "--threads", "3"]].concat()).expect(0);
    folder.run(&[&args[..], &["-o", "m", "--threads", "1"]].concat()).expect(0);
    for file in &files {
        assert!(folder.read(&format!("l/{file}")) == folder.read(&format!("m/{file}")), "{file}");
    }
    // Less memory makes fewer levels, and a folder of levels is replaced as a whole.
    let bytes: u64 = index.levels.iter().map(|level| level.n_bytes).sum();
    let half = (bytes / 2).to_string();
    folder.run(&[&args[..], &["-o", "m", "--memory", &half]].concat()).expect(0);
    let less = read_levels_index(folder.path("m/index.json")).unwrap();
    assert!(less.levels.len() < index.levels.len());
    assert_eq!(names(&folder.path("m")).len(), less.levels.len() + 1);
    assert!(less.levels.iter().map(|level| level.n_bytes).sum::<u64>() <= bytes / 2);

    let walk = ["walk", "tower.pvs", "--random", "60", "--method", "cell-to-cell", "--levels"];
    let walked = folder.run(&[&walk[..], &["l", "--json"]].concat()).expect(0).json();
    let drawn = &walked["levels"];
    assert_eq!(drawn["without"], json!(index.n_triangles));
    assert!(drawn["with_mean"].as_f64().unwrap() < index.n_triangles as f64, "{drawn}");
    assert!(drawn["n_with_level"].as_u64() > Some(0), "{drawn}");
    let text = folder.run(&[&walk[..], &["l"]].concat()).expect(0).out;
    assert!(text.contains("with levels on average"), "{text}");
    // Levels of another table, and none.
    folder.write("other.glb", one_floor(1, 1));
    folder.run(&["build", "other.glb", "-o", "other.pvs", "-q"]).expect(0);
    let error = folder.refused(&["walk", "other.pvs", "--random", "9", "--levels", "l"]);
    assert!(error.starts_with("l/index.json: the levels are for another table: the index has "), "{error}");
    let error = folder.refused(&["walk", "tower.pvs", "--random", "9", "--levels", "none"]);
    assert!(error.starts_with("none/index.json: "), "{error}");
    folder.write("l/index.json", "{\"sightlines_levels\": 1,\n \"triangles\": x}");
    let error = folder.refused(&["walk", "tower.pvs", "--random", "9", "--levels", "l"]);
    assert_eq!(error, "l/index.json: line 2 column 15: expected value");
}

/// What is promised for every eye is promised for those that see no back of a single-sided face, and said so where there are some.
#[test]
fn promises_name_the_eyes_that_they_are_for() {
    let folder = Folder::new();
    folder.write("both.glb", levels::blender());
    folder.write("single.glb", levels::scan(true));
    let promise = |scene: &str, command: &[&str]| {
        let args = [&[command[0], scene], &command[1..], &["-o", "out.glb"]].concat();
        let line = |out: &str| out.lines().find(|line| line.starts_with("promised")).expect("a promise").to_owned();
        let json = folder.run(&[&args[..], &["--json"]].concat()).expect(0).json();
        (line(&folder.run(&args).expect(0).out), json["single_sided"].as_bool().expect("a truth value"))
    };
    let volume = ["simplify", "--volume=1.5,1.5,1.5,2.5,1.9,2.5", "--method", "none"];
    let (both, is_single) = promise("both.glb", &volume);
    assert!(both.contains("for every eye; ") && !is_single, "{both}");
    let (single, is_single) = promise("single.glb", &[&volume[..], &["--backs", "culled"]].concat());
    assert!(single.contains("for every eye that sees the back of no single-sided face; ") && is_single, "{single}");
    for more in [&[][..], &["--backs", "drawn"]] {
        let (drawn, is_single) = promise("single.glb", &[&volume[..], more].concat());
        assert!(drawn.contains("for every eye; ") && !is_single, "{drawn}");
    }
}
