//! Worlds in tiles: what changed is baked again and nothing else, with the bytes of a bake from nothing.

use crate::common::{Folder, names};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A city of 3 x 3 blocks, each a tile: those at a corner are not near all others.
fn world() -> Folder {
    world_of_cells(12)
}

/// As [`world`], with each cell of so many.
fn world_of_cells(step: usize) -> Folder {
    let folder = Folder::new();
    folder.run(&["generate", "world", "--blocks", "3", "--per-tile", "1", "-o", "city"]).expect(0);
    thin(&folder, step);
    folder
}

/// Leaves of the cells of each tile in `city` one of so many: a few are enough.
pub(crate) fn thin(folder: &Folder, step: usize) {
    edit(folder, "city/world.json", |plan| {
        for tile in plan["tiles"].as_array_mut().unwrap() {
            let name = tile["cells"].as_str().unwrap().to_owned();
            edit(folder, &format!("city/{name}"), |cells| {
                let few: Vec<Value> = cells["cells"].as_array().unwrap().iter().step_by(step).cloned().collect();
                cells["cells"] = Value::from(few);
            });
        }
    });
}

fn edit(folder: &Folder, name: &str, change: impl FnOnce(&mut Value)) {
    let mut value: Value = serde_json::from_slice(&folder.read(name)).unwrap();
    change(&mut value);
    folder.write(name, value.to_string());
}

/// With the quickest method; another one is in [`worlds_are_asked_and_checked`].
const BUILD: [&str; 6] = ["tiles", "build", "city/world.json", "--method", "shafts", "-o"];

fn build(folder: &Folder, out: &str) -> Value {
    folder.run(&[&BUILD[..], &[out, "--json"]].concat()).expect(0).json()
}

fn counts(built: &Value) -> [u64; 3] {
    ["n_baked", "n_far_only", "n_kept"].map(|name| built[name].as_u64().unwrap())
}

/// The files in a folder.
fn files(folder: &Folder, out: &str) -> BTreeMap<String, Vec<u8>> {
    names(&folder.path(out)).into_iter().map(|name| (name.clone(), folder.read(&format!("{out}/{name}")))).collect()
}

/// The world has the files of one that was baked from nothing.
fn assert_same(folder: &Folder) {
    let [out, fresh] = ["out", "fresh"].map(|name| files(folder, name));
    let others: Vec<&String> =
        out.keys().chain(fresh.keys()).filter(|name| out.get(*name) != fresh.get(*name)).collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn what_changes_is_baked_again_and_nothing_else() {
    let folder = world();
    assert_eq!(counts(&build(&folder, "out")), [9, 0, 0]);
    let first = files(&folder, "out");
    assert_eq!(first.len(), 1 + 3 * 9);
    assert_eq!(counts(&build(&folder, "out")), [0, 0, 9]);
    assert!(files(&folder, "out") == first, "nothing was to be done");

    // A house becomes glass. All tables state how scenes were read, so all tiles are baked again.
    let glass = ["--see-through", "block_0_0/house_3"];
    let out = folder.run(&[&BUILD[..], &["out", "--json"], &glass].concat()).expect(0).json();
    assert_eq!(counts(&out)[2], 0);
    assert_eq!(counts(&build(&folder, "out")), [9, 0, 0]);
    assert!(files(&folder, "out") == first);

    // Another scene in the place of one: the block and the three nearby.
    let corner = folder.read("city/0_0.glb");
    folder.write("city/0_0.glb", folder.read("city/2_2.glb"));
    edit(&folder, "city/world.json", |plan| plan["tiles"][0]["at"] = json!([-104, 0, -104]));
    let [baked, far, kept] = counts(&build(&folder, "out"));
    assert_eq!(baked, 4);
    // Whether others look again depends on the box around it.
    assert_eq!(far + kept, 5);
    build(&folder, "fresh");
    assert_same(&folder);

    // It comes back: so do the bytes.
    folder.write("city/0_0.glb", corner);
    edit(&folder, "city/world.json", |plan| drop(plan["tiles"][0].as_object_mut().unwrap().remove("at")));
    build(&folder, "out");
    assert!(files(&folder, "out") == first);

    // A tile is taken away: those nearby are baked again, and all others forget it.
    let mut last = Value::Null;
    edit(&folder, "city/world.json", |plan| last = plan["tiles"].as_array_mut().unwrap().pop().unwrap());
    let built = build(&folder, "out");
    assert_eq!((counts(&built), built["n_removed"].as_u64()), ([3, 5, 0], Some(4)));
    std::fs::remove_dir_all(folder.path("fresh")).unwrap();
    build(&folder, "fresh");
    assert_same(&folder);
    // And added again.
    edit(&folder, "city/world.json", |plan| plan["tiles"].as_array_mut().unwrap().push(last));
    assert_eq!(counts(&build(&folder, "out")), [4, 5, 0]);
    assert!(files(&folder, "out") == first);
    folder.run(&["tiles", "check", "out"]).expect(0);
}

#[test]
fn worlds_are_asked_and_checked() {
    let folder = world_of_cells(8);
    let build = BUILD.map(|word| if word == "shafts" { "line-space" } else { word });
    folder.run(&[&build[..], &["out"]].concat()).expect(0);
    // In a street, on the border of two tiles.
    let seen = folder.run(&["tiles", "query", "out", "--eye", "42,1.7,44", "--json"]).expect(0).json();
    assert_eq!(seen["tiles"], json!(["0_0"]));
    let own = seen["seen"]["0_0"]["objects"].as_array().unwrap();
    assert!(own.contains(&json!(0)) && own.len() >= 3, "{seen}");
    let whole =
        |seen: &Value| seen["seen"].as_object().unwrap().values().filter(|of| of["whole"] == json!(true)).count();
    assert!((1..7).contains(&whole(&seen)), "{seen}");
    let text = folder.run(&["tiles", "query", "out", "--eye", "42,1.7,44"]).expect(0).out;
    assert!(text.starts_with("42,1.7,44 is in 0_0\n0_0 "), "{text}");
    // In a house, and where there is no tile.
    for eye in ["20,1.7,20", "1e6,0,0"] {
        let outside = folder.run(&["tiles", "query", "out", "--eye", eye]).expect(1).out;
        assert!(outside.contains("is outside every cell: everything may be visible"), "{outside}");
    }
    let checked = folder.run(&["tiles", "check", "out", "--json"]).expect(0).json();
    assert_eq!((checked["n_tiles"].as_u64(), checked["n_cells"].as_u64()), (Some(9), Some(9 * 9)));

    // Damage, a file that is missing, and one of another bake.
    let of_tile = |end: &str| {
        let name = names(&folder.path("out")).into_iter().find(|name| name.starts_with("1_1-") && name.ends_with(end));
        format!("out/{}", name.unwrap())
    };
    for end in [".pvz", ".near", ".far"] {
        let name = of_tile(end);
        let bytes = folder.read(&name);
        let mut damaged = bytes.clone();
        let middle = bytes.len() / 2;
        damaged[middle] ^= 1;
        folder.write(&name, &damaged);
        assert!(folder.refused(&["tiles", "check", "out"]).contains(&name[4..]), "{name}");
        std::fs::remove_file(folder.path(&name)).unwrap();
        assert!(folder.refused(&["tiles", "check", "out"]).contains(&name[4..]), "{name}");
        folder.write(&name, &bytes);
    }
    let other = names(&folder.path("out")).into_iter().find(|name| name.starts_with("2_2-") && name.ends_with(".near"));
    folder.write(&of_tile(".near"), folder.read(&format!("out/{}", other.unwrap())));
    let error = folder.refused(&["tiles", "check", "out"]);
    assert!(error.contains("this is not of the bake that the index of the world names"), "{error}");
}

/// Killed again and again, a bake of a world goes on from the tiles that are done, and ends with the same bytes.
#[test]
fn worlds_survive_being_killed() {
    let folder = world();
    build(&folder, "whole");
    let args = [&BUILD[..], &["out", "--threads", "1", "-q"]].concat();
    let n_files = || std::fs::read_dir(folder.path("out")).map_or(0, Iterator::count);
    let mut n_killed = 0;
    for k in 1..=6 {
        let mut program = Command::new(env!("CARGO_BIN_EXE_sightlines"));
        program.args(&args).current_dir(folder.path(".")).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = program.spawn().unwrap();
        // There are 28 files in the end. A little after some more are there, or a name that one is written under:
        while n_files() < 4 * k && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis((k * 7 % 5) as u64));
        let _ = child.kill();
        n_killed += u32::from(!child.wait().unwrap().success());
    }
    let built = build(&folder, "out");
    let mut left_over = files(&folder, "out");
    // A name that a file was written under is removed by whoever writes that file later.
    left_over.retain(|name, _| !name.starts_with('.'));
    assert!(left_over == files(&folder, "whole"), "{:?}", left_over.keys());
    assert!(n_killed >= 4 && counts(&built)[2] >= 4, "{n_killed}: {built}");
}

/// The tiles of a world as shards of a job.
#[test]
fn worlds_are_shared() {
    let folder = world();
    build(&folder, "whole");
    let plan = ["job", "plan", "-o", "job", "--shards", "5", "--json"];
    let planned = folder.run(&[&plan[..], &BUILD, &["out"]].concat()).expect(0).json();
    assert_eq!(planned["phase"], json!("tiles"), "{planned}");
    folder.run(&["job", "shard", "job", "3"]).expect(0);
    folder.run(&["job", "merge", "job"]).expect(3);
    folder.run(&["job", "submit", "job", "--workers", "2"]).expect(0);
    assert!(files(&folder, "out") == files(&folder, "whole"));
    let refused = folder.refused(&["job", "plan", "-o", "other", "tiles", "check", "out"]);
    assert!(refused.contains("of tiles, only tiles build can be shared"), "{refused}");
}

#[test]
fn wrong_worlds_are_refused() {
    let folder = world();
    let plan: Value = serde_json::from_slice(&folder.read("city/world.json")).unwrap();
    let refused = |change: &dyn Fn(&mut Value), more: &[&str]| {
        let mut other = plan.clone();
        change(&mut other);
        folder.write("city/other.json", other.to_string());
        let error = folder.refused(&[&["tiles", "build", "city/other.json", "-o", "bad"][..], more].concat());
        assert!(!folder.path("bad/world.json").exists());
        error
    };
    let error = refused(&|plan| plan["tiles"][1]["name"] = json!("0_0"), &[]);
    assert!(error.contains("city/other.json: tile 1: tile 0 has the name \"0_0\" too"), "{error}");
    let error = refused(&|plan| plan["tiles"][1]["scene"] = json!("none.glb"), &[]);
    assert!(error.contains("city/none.glb: "), "{error}");
    let error = refused(&|plan| plan["tiles"][1]["at"] = json!([1e300, 0, 0]), &[]);
    assert!(error.contains("tile 1: \"at\" has a coordinate that cannot be used"), "{error}");
    let error = refused(&|_| {}, &["--cells", "city/0_0.cells.json"]);
    assert!(error.contains("--cells is not for worlds"), "{error}");
    folder.write("city/z.obj", "# up is assumed\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
    let error = refused(&|plan| plan["tiles"][1] = json!({"name": "z", "scene": "z.obj"}), &[]);
    assert!(error.contains("city/z.obj: ") && error.contains("the same axes and units"), "{error}");
    folder.write("out", "a file");
    let error = folder.refused(&[&BUILD[..], &["out"]].concat());
    assert!(error.contains("out: cannot be made"), "{error}");
}
