//! Checking tables against their scenes.

use crate::common::picture::{DRAWN, is_drawn};
use crate::common::quake::{Map, rooms, row_of_leafs};
use crate::common::{Folder, levels, wad};
use serde_json::Value;
use sightlines::formats::quake::BspFormat;
use sightlines::geometry::Random;
use sightlines::pvs::{CellId, Table};

/// A pair of cells that see each other and share no portal, hidden from each other; the pair.
fn flip(folder: &Folder, from: &str, to: &str, seed: u64) -> [u32; 2] {
    let table = Table::from_bytes(&folder.read(from)).expect("a sound table");
    let (n, mut random) = (table.n_cells(), Random::new(seed));
    let joined = |a: u32, b: u32| table.portals().iter().any(|p| [[a, b], [b, a]].contains(&p.cells.map(|c| c.0)));
    let is_seen_apart = |&[a, b]: &[u32; 2]| a < b && table.sees(CellId(a), CellId(b)) && !joined(a, b);
    let drawn = (0..1_000_000).map(|_| [random.below(n) as u32, random.below(n) as u32]);
    let [a, b] = { drawn }.find(is_seen_apart).expect("some cells see each other and share no portal");
    let mut parts = table.into_parts();
    parts.rows.set(a as usize, b as usize, false);
    parts.rows.set(b as usize, a as usize, false);
    folder.write(to, Table::new(parts).expect("symmetric").to_bytes());
    [a, b]
}

fn verify(folder: &Folder, args: &[&str], code: i32) -> Value {
    folder.run(&[&["verify", "--json", "--rays", "5000", "--pairs", "2000"], args].concat()).expect(code).json()
}

/// Invariant: what `build` writes is true to what it was built from; with one pair flipped it is not, and the pair is named.
fn build_and_flip(folder: &Folder, scene: &str, options: &[&str], of_map: &[&str]) {
    folder.run(&[&["build", scene, "-o", "t.pvs"][..], of_map, options].concat()).expect(0);
    let good = verify(folder, &[&["t.pvs", scene], of_map].concat(), 0);
    assert_eq!((&good["is_true"], &good["n_violations"]), (&Value::Bool(true), &Value::from(0)), "{scene} {options:?}");
    let n_rays = good["n_rays"].as_u64().expect("a count");
    assert!(n_rays > 2_500 && good["cells"]["n_confirmed"].as_u64() > Some(0), "{scene}: {n_rays} rays");
    let pair = flip(folder, "t.pvs", "flipped.pvs", 1);
    let bad = verify(folder, &[&["flipped.pvs", scene], of_map].concat(), 1);
    let of_cells: Vec<&Value> =
        bad["violations"].as_array().expect("a list").iter().filter(|v| v["kind"] == "hidden-cell").collect();
    assert_eq!(of_cells.len(), 1, "{scene} {options:?}: {bad}");
    assert_eq!(of_cells[0]["cells"], Value::from(pair.to_vec()), "{scene} {options:?}");
    assert!(of_cells[0]["segment"][1][2].is_f64());
}

#[test]
fn plans_are_checked() {
    let folder = Folder::with_office();
    for how in ["kd", "triangulation"] {
        build_and_flip(&folder, "office.geojson", &["--subdivide", how], &[]);
    }
    build_and_flip(&folder, "office.geojson", &["--stab-trees"], &[]);
}

#[test]
fn maps_of_a_wad_are_checked() {
    let folder = Folder::with_wad();
    build_and_flip(&folder, "maps.wad", &[], &["--map", "MAP01"]);
    // The table of another map is noticed, whatever else.
    folder.run(&["build", "maps.wad", "--map", "MAP03", "-o", "3.pvs"]).expect(0);
    assert_eq!(verify(&folder, &["3.pvs", "maps.wad", "--map", "MAP01"], 1)["is_true"], false);
    let error = folder.refused(&["verify", "3.pvs", "maps.wad"]);
    assert!(error.contains("there are 3 maps in the file"), "{error}");
}

#[test]
fn scenes_in_space_are_checked() {
    let folder = Folder::with_tower();
    build_and_flip(&folder, "tower.glb", &[], &[]);
    let small = ["--method", "multifocal", "--grid", "3,1,3", "--planes", "2", "--texels", "32", "--occluders", "30"];
    build_and_flip(&folder, "tower.glb", &small, &[]);
    build_and_flip(&folder, "tower.glb", &["--grid", "3,1,3"], &[]);
}

fn written(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder
}

#[test]
fn quake_maps_are_checked() {
    for format in BspFormat::ALL {
        let folder = written(&row_of_leafs(format));
        folder.run(&["build", "map.bsp", "-o", "t.pvs"]).expect(0);
        let good = verify(&folder, &["t.pvs", "map.bsp"], 0);
        assert_eq!(good["is_true"], true, "{format:?}");
        // A table without positions, and the map that it does not name.
        folder.run(&["build", "map.prt", "-o", "p.pvs"]).expect(0);
        let error = folder.refused(&["verify", "p.pvs", "map.bsp"]);
        assert_eq!(
            error,
            "p.pvs: is no table of map.bsp: the table was made of a portal file alone: give that file, not the map"
        );
    }
    let folder = written(&rooms(4, 4));
    build_and_flip(&folder, "map.prt", &[], &[]);
}

#[test]
fn packed_tables_are_checked() {
    let folder = Folder::with_office();
    folder.run(&["pack", "office.pvs", "-o", "office.pvz"]).expect(0);
    assert_eq!(verify(&folder, &["office.pvz", "office.geojson"], 0)["is_true"], true);
    flip(&folder, "office.pvs", "wrong.pvs", 5);
    folder.run(&["pack", "wrong.pvs", "-o", "wrong.pvz"]).expect(0);
    assert_eq!(verify(&folder, &["wrong.pvz", "office.geojson"], 1)["is_true"], false);
}

/// Invariant: the same seed gives the same answer, whatever the number of threads; the time apart.
#[test]
fn answers_are_the_same_with_any_number_of_threads() {
    let folder = Folder::with_office();
    flip(&folder, "office.pvs", "wrong.pvs", 9);
    for (table, code) in [("office.pvs", 0), ("wrong.pvs", 1)] {
        let with = |threads: &str, seed: &str| {
            let mut reply = verify(&folder, &[table, "office.geojson", "--threads", threads, "--seed", seed], code);
            reply["seconds"] = Value::Null;
            reply
        };
        assert_eq!(with("1", "7"), with("3", "7"), "{table}");
        assert_ne!(with("1", "7"), with("1", "8"), "{table}: another seed, other rays");
    }
}

#[test]
fn the_text_lists_what_was_checked() {
    let folder = Folder::with_office();
    let reply = folder.run(&["verify", "office.pvs", "office.geojson", "--rays", "2000"]).expect(0).out;
    for line in [
        "checked        office.pvs against office.geojson\n",
        "rays           2000 in random",
        "result         nothing found",
    ] {
        assert!(reply.contains(line), "{reply}");
    }
    let [a, b] = flip(&folder, "office.pvs", "wrong.pvs", 2);
    let drawn = format!("ray.{DRAWN}");
    for picture in ["ray.svg", &drawn] {
        let reply = folder.run(&["verify", "wrong.pvs", "office.geojson", "--draw", picture]).expect(1).out;
        assert!(
            reply.contains(&format!(
                "hidden-cell: cells {a} and {b} are hidden from each other, but nothing is between ("
            )),
            "{reply}"
        );
        assert!(reply.contains(&format!("picture        {picture}\n")), "{reply}");
    }
    assert!(is_drawn(&folder.read(&drawn)));
    assert!(String::from_utf8(folder.read("ray.svg")).expect("text").contains("<svg"));
    // Nothing is drawn where nothing was found.
    folder.run(&["verify", "office.pvs", "office.geojson", "--draw", "none.svg"]).expect(0);
    assert!(!folder.path("none.svg").exists());
}

/// Without rays and proofs, the output states that only the structure was checked.
#[test]
fn what_was_not_checked_is_listed() {
    let folder = Folder::with_office();
    const NONE: [&str; 6] = ["--rays", "0", "--pairs", "0", "--segments", "0"];
    let none = [&["verify", "office.pvs", "office.geojson"][..], &NONE].concat();
    let reply = folder.run(&none).expect(0).out;
    assert!(reply.contains("rays           none\n") && reply.contains("only the structure was checked"), "{reply}");
    assert!(!reply.contains("nothing found"), "{reply}");
    let checked = |args: &[&str]| {
        let reply =
            folder.run(&[&["verify", "--json", "office.pvs", "office.geojson"], args].concat()).expect(0).json();
        let list = ["random_rays", "random_segments", "aimed_rays", "proofs"]
            .map(|what| reply["checked"][what].as_bool().expect("said"));
        (list, reply["is_true"].as_bool())
    };
    assert_eq!(checked(&NONE), ([false; 4], Some(true)));
    assert_eq!(checked(&["--rays", "100", "--pairs", "0", "--segments", "0"]).0, [true, false, false, false]);
    assert_eq!(checked(&["--rays", "0", "--pairs", "0", "--segments", "5"]).0, [false, true, false, false]);
    assert_eq!(checked(&["--rays", "0", "--pairs", "5", "--segments", "0"]).0, [false, false, true, false]);
    for some in [["--rays", "0"], ["--pairs", "0"]] {
        let reply = folder.run(&[&["verify", "office.pvs", "office.geojson"][..], &some].concat()).expect(0).out;
        assert!(reply.contains("nothing found that contradicts the table"), "{reply}");
    }
    // Proofs are something.
    folder.run(&["build", "office.geojson", "-o", "office.pvs", "--certify"]).expect(0);
    assert_eq!(checked(&NONE), ([false, false, false, true], Some(true)));
    // Those of another table are nothing.
    folder.run(&["build", "office.geojson", "-o", "office.pvs", "--subdivide", "triangulation"]).expect(0);
    assert_eq!(checked(&NONE).0, [false; 4]);
    folder.run(&["build", "office.geojson", "-o", "office.pvs"]).expect(0);
    // A pair that is wrong and not looked at goes unnoticed, which is why it has to be said.
    flip(&folder, "office.pvs", "wrong.pvs", 3);
    let none = [&["verify", "wrong.pvs", "office.geojson"][..], &NONE].concat();
    let reply = folder.run(&none).expect(0).out;
    assert!(reply.contains("only the structure was checked"), "{reply}");
}

#[test]
fn rays_in_space_are_drawn_on_the_floor_where_they_begin() {
    let folder = Folder::with_tower();
    // Not every pair is found: some are seen through slits only.
    flip(&folder, "tower.pvs", "wrong.pvs", 1);
    folder.run(&["verify", "wrong.pvs", "tower.glb", "--draw", "ray.svg"]).expect(1);
    assert!(String::from_utf8(folder.read("ray.svg")).expect("text").contains("at height"));
}

#[test]
fn what_cannot_be_checked_is_refused() {
    let folder = Folder::with_tower();
    folder.write("maze.geojson", crate::common::maze_text(3));
    folder.write("junk.pvs", b"junk");
    folder.write("map.wad", wad(&["MAP01"]));
    let refused = |args: &[&str]| folder.refused(&[&["verify"], args].concat());
    let error = refused(&["tower.pvs", "maze.geojson"]);
    assert_eq!(error, "tower.pvs: is no table of maze.geojson: the table has 3 dimensions, the scene 2");
    assert!(refused(&["tower.glb", "tower.glb"]).starts_with("tower.glb: "));
    assert!(refused(&["junk.pvs", "tower.glb"]).starts_with("junk.pvs: "));
    assert!(refused(&["none.pvs", "tower.glb"]).starts_with("none.pvs: "));
    assert!(refused(&["tower.pvs", "none.glb"]).starts_with("none.glb: "));
    assert!(refused(&["tower.pvs", "tower.glb", "--map", "MAP01"]).starts_with("tower.glb: --map is for WADs"));
    assert!(refused(&["tower.pvs", "tower.glb", "--prt", "x.prt"]).contains("--prt is for Quake maps"));
    assert!(refused(&["tower.pvs", "tower.glb", "--draw", "x.jpg"]).contains("ends in .svg or .png"));
    folder.write("map.prt", rooms(2, 2).prt);
    folder.run(&["build", "map.prt", "-o", "p.pvs"]).expect(0);
    assert!(refused(&["p.pvs", "map.prt", "--draw", "x.svg"]).contains("does not say where its cells are"));
    assert_eq!(
        refused(&["tower.pvs", "map.prt"]),
        "tower.pvs: is no table of map.prt: the table is of no Quake map, but the scene is one"
    );
    assert_eq!(
        refused(&["p.pvs", "tower.glb"]),
        "p.pvs: is no table of tower.glb: the table is of a Quake map, but the scene is none"
    );
}

/// Invariant: tables of real scenes are true to them.
#[test]
fn real_tables_are_true() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(std::path::PathBuf::from) else {
        eprintln!("SKIPPED real_tables_are_true: SIGHTLINES_DATA is not set");
        return;
    };
    assert!(data.is_dir(), "SIGHTLINES_DATA names no folder: {}", data.display());
    let folder = Folder::new();
    let scenes =
        ["plans/duplex_1.geojson", "plans/mlstruct_fp_test_0.geojson", "doom/freedoom1_E1M1.wad", "quake/e1m1.bsp"];
    for scene in scenes {
        let scene = data.join(scene).display().to_string();
        folder.run(&["build", &scene, "-o", "t.pvs", "--quiet"]).expect(0);
        // Rays through a map for Quake take most of the time.
        let few = ["--rays", "5000", "--pairs", "500", "--segments", "46"];
        let of =
            |table: &str, rc| folder.run(&[&["verify", "--json", table, &scene][..], &few].concat()).expect(rc).json();
        let reply = of("t.pvs", 0);
        assert!(reply["cells"]["n_confirmed"].as_u64() > Some(100), "{scene}: {}", reply["cells"]);
        flip(&folder, "t.pvs", "flipped.pvs", 4);
        assert_eq!(of("flipped.pvs", 1)["is_true"], false, "{scene}");
    }
}

/// A scene that was changed since by one coordinate is named at once, for plain and packed tables, plans and scenes; rays tell whether it matters.
#[test]
fn scenes_that_were_changed_are_named() {
    let folder = Folder::with_tower();
    let changed = |kind: &str| format!("violation      changed-geometry: {kind} is not as when the table was made: ");
    let only = "not as when the table was made\n               nothing else was found that contradicts the table\n";
    let scene = sightlines::formats::scene::parse_glb(&folder.read("tower.glb"), None).expect("a tower").scene;
    let info = folder.run(&["info", "tower.pvs"]).expect(0).out;
    let digests = scene.digest();
    assert!(info.contains(&format!("digests        {:032x} of what hides\n", digests.hiding)), "{info}");
    assert!(info.contains(&format!("               {:032x} of what can be seen\n", digests.seen)), "{info}");
    // A corner of a chair that does not touch the box around it, by a thousandth.
    let mut objects = scene.objects().to_vec();
    let bounds = |object: usize| objects[object].bounds();
    let inner = (0..objects.len()).find_map(|k| {
        let b = bounds(k);
        let is_inner = |p: &&[f64; 3]| (0..3).any(|i| b.min[i] < p[i] && p[i] < b.max[i]);
        objects[k].vertices.iter().position(|p| is_inner(&p)).map(|vertex| (k, vertex))
    });
    let (object, vertex) = inner.expect("a corner inside of a box");
    let b = bounds(object);
    let axis = (0..3).find(|&i| {
        (b.min[i]..b.max[i]).contains(&objects[object].vertices[vertex][i])
            && b.min[i] < objects[object].vertices[vertex][i]
    });
    objects[object].vertices[vertex][axis.expect("found before")] += 1.0 / 1024.0;
    let moved = sightlines::cells::Scene::new(objects).expect("a scene");
    folder.write("moved.glb", sightlines::formats::scene::write_glb(&moved).expect("single precision"));
    folder.run(&["pack", "tower.pvs", "-o", "tower.pvz"]).expect(0);
    for table in ["tower.pvs", "tower.pvz"] {
        let same = folder.run(&["verify", table, "tower.glb", "--rays", "2000", "--pairs", "100", "--segments", "1"]);
        assert!(!same.expect(0).out.contains("changed"));
        let run = folder.run(&["verify", table, "moved.glb", "--rays", "2000", "--pairs", "100", "--segments", "1"]);
        let out = run.expect(1).out;
        assert!(["what hides", "what can be seen"].iter().all(|kind| out.contains(&changed(kind))), "{out}");
    }
    // A triangle that faces the other way hides the same, and no ray tells.
    let mut objects = scene.objects().to_vec();
    objects[0].triangles[0].swap(1, 2);
    let turned = sightlines::cells::Scene::new(objects).expect("a scene");
    folder.write("turned.glb", sightlines::formats::scene::write_glb(&turned).expect("single precision"));
    let few = ["--rays", "2000", "--pairs", "100", "--segments", "1"];
    let out = folder.run(&[&["verify", "tower.pvs", "turned.glb"][..], &few].concat()).expect(1).out;
    assert!(out.contains(&changed("what can be seen")) && !out.contains(&changed("what hides")), "{out}");
    assert!(out.contains(only), "{out}");
    // What removes faces that a table hides takes no other scene.
    let error = folder.run(&["levels", "moved.glb", "-o", "levels", "--table", "tower.pvs"]).expect(2).err;
    assert!(error.contains("tower.pvs: the table is of another scene: it was made of other geometry"), "{error}");
    // A table along axes of its own is compared before the scene is taken along them.
    folder.write("building.glb", levels::bim());
    folder.run(&["build", "building.glb", "-o", "shut.pvs", "--gap", "25"]).expect(0);
    let other = ["levels", "building.glb", "-o", "levels", "--table", "shut.pvs", "--see-through", "*Door*"];
    let error = folder.run(&other).expect(2).err;
    assert!(error.contains("shut.pvs: the table is of another scene: it was made of other geometry"), "{error}");
    // Of a plan nothing but a wall hides; tables of older programs have no digests, and say so.
    let folder = Folder::with_office();
    let plan = String::from_utf8(folder.read("office.geojson")).expect("text");
    let moved = plan.replacen("12.0", "12.001", 1);
    let moved = if moved == plan { plan.replacen(".5", ".501", 1) } else { moved };
    assert_ne!(moved, plan);
    folder.write("moved.geojson", moved);
    let out = folder.run(&["verify", "office.pvs", "moved.geojson", "--json"]).expect(1).json();
    assert_eq!(out["violations"][0]["kind"], "changed-geometry");
    let table = Table::from_bytes(&folder.read("office.pvs")).expect("a table").with_digest(None);
    folder.write("old.pvs", table.to_bytes());
    let out = folder.run(&["verify", "old.pvs", "office.geojson"]).expect(0).out;
    assert!(
        out.contains("digests        none in the table: whether the scene has changed since is not known\n"),
        "{out}"
    );
}
