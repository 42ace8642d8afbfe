//! `strip`: what goes, what stays as it is, and what is refused.

use crate::common::Folder;
use serde_json::{Value, json};
use sightlines::formats::scene::read_scene;
use sightlines::formats::scene::write_glb;
use sightlines::scenes::cupboard;

/// A wall with a triangle behind it, and one before it.
const WALL: &str = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nv 0 0 1\nv 1 0 1\nv 0 1 1\n\
                    o wall\nf 1 2 3 4\no behind\nf 5 6 7\no before\nf 8 9 10\n";
const BEFORE_WALL: &str = "box=-0.5,-0.5,4,0.5,0.5,5";

fn names(folder: &Folder, file: &str) -> Vec<String> {
    let scene = read_scene(folder.path(file)).expect("a scene").scene;
    scene.objects().iter().filter(|o| !o.triangles.is_empty()).map(|o| o.name.clone()).collect()
}

/// The text of a GLB, and all behind it.
fn chunks(glb: &[u8]) -> (Value, Vec<u8>) {
    let len = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    (serde_json::from_slice(&glb[20..20 + len]).expect("JSON"), glb[20 + len..].to_vec())
}

fn with_gearbox() -> Folder {
    let folder = Folder::new();
    folder.run(&["generate", "gearbox", "--gears", "2", "-o", "in.glb", "-q"]).expect(0);
    folder
}

#[test]
fn what_is_hidden_goes_and_all_else_stays_byte_for_byte() {
    let folder = with_gearbox();
    let reply = folder.run(&["strip", "in.glb", "-o", "out.glb", "--report", "out.json", "--json"]).expect(0).json();
    let n = |key: &str| reply["objects"][key].as_u64().expect("a number");
    assert_eq!([n("n"), n("n_seen"), n("n_hidden"), n("n_enclosed"), n("n_undecided")], [8, 4, 4, 4, 0]);
    assert_eq!(names(&folder, "out.glb"), ["Housing", "Shaft", "Bolt 0", "Bolt 1"]);
    let [(before, buffer), (after, same)] = ["in.glb", "out.glb"].map(|name| chunks(&folder.read(name)));
    assert!(buffer == same, "buffers are as they were");
    let mut expected = before;
    for node in expected["nodes"].as_array_mut().expect("nodes") {
        if ["Gear", "Nut"].iter().any(|what| node["name"].as_str().expect("a name").starts_with(what)) {
            node.as_object_mut().expect("a node").remove("mesh");
        }
    }
    assert_eq!(after, expected);
    let report: Value = serde_json::from_slice(&folder.read("out.json")).expect("JSON");
    let parts = report["parts"].as_array().expect("parts");
    assert_eq!((parts.len(), &parts[2]["name"], &parts[2]["reason"]), (8, &json!("Gear 0"), &json!("enclosed")));
    assert!(parts[0]["witness"].is_array() && parts[0]["fate"] == "seen");
    // The same with any number of threads.
    for (out, threads) in [("a.glb", "1"), ("b.glb", "3")] {
        folder.run(&["strip", "in.glb", "-o", out, "--triangles", "--threads", threads, "-q"]).expect(0);
    }
    assert!(folder.read("a.glb") == folder.read("b.glb"));
    assert!(folder.read("a.glb").len() < folder.read("out.glb").len());
    // What is left has nothing more to go.
    let again = folder.run(&["strip", "out.glb", "-o", "c.glb", "--json"]).expect(0).json();
    assert_eq!((&again["objects"]["n_hidden"], &again["objects"]["n_seen"]), (&json!(0), &json!(4)));
    assert!(folder.read("c.glb") == folder.read("out.glb"));
}

#[test]
fn objects_can_be_flagged_kept_and_explained() {
    let folder = with_gearbox();
    let run =
        folder.run(&["strip", "in.glb", "-o", "out.glb", "--flag", "--keep", "nut*", "--explain", "*0"]).expect(0);
    assert!(
        run.out.contains("Gear 0 (object 2, ")
            && run.out.contains("hidden: a closed surface is between it and every eye"),
        "{}",
        run.out
    );
    assert!(run.out.contains("Nut 0") && run.out.contains(": kept\n") && run.out.contains("seen from "), "{}", run.out);
    let (text, _) = chunks(&folder.read("out.glb"));
    let flagged = |node: &&Value| node["extensions"]["KHR_node_visibility"]["visible"] == json!(false);
    let names: Vec<_> =
        text["nodes"].as_array().expect("nodes").iter().filter(flagged).map(|node| &node["name"]).collect();
    assert_eq!(names, ["Gear 0", "Gear 1"]);
    assert_eq!(text["extensionsUsed"], json!(["KHR_node_visibility"]));
    // It needs no output to explain.
    folder.run(&["strip", "in.glb", "--explain", "Housing"]).expect(0);
    assert!(folder.refused(&["strip", "in.glb", "--explain", "Door"]).contains("no object has such a name"));
}

#[test]
fn eyes_are_where_they_are_said_to_be() {
    let folder = Folder::with_bare_tower();
    folder.write("wall.obj", WALL);
    let hidden = |args: &[&str]| {
        let reply = folder.run(&[&["strip"], args, &["--json"]].concat()).expect(0).json();
        reply["objects"]["n_hidden"].as_u64().expect("a number")
    };
    assert_eq!(hidden(&["wall.obj", "-o", "o.obj", "--from", BEFORE_WALL]), 1);
    assert_eq!(names(&folder, "o.obj"), ["wall", "before"]);
    assert_eq!(hidden(&["wall.obj", "-o", "o.obj", "--from", BEFORE_WALL, "--from", "box=0,0,-5,1,1,-4"]), 0);
    folder.write("cells.json", r#"{"cells":[{"id":"a","min":[-0.5,-0.5,4],"max":[0.5,0.5,5]}]}"#);
    assert_eq!(hidden(&["wall.obj", "-o", "o.obj", "--from", "cells=cells.json"]), 1);
    assert_eq!(hidden(&["wall.obj", "-o", "o.obj"]), 0);
    // A way leads around the wall.
    assert_eq!(hidden(&["wall.obj", "-o", "o.obj", "--from", "walk=0,0,4"]), 0);
    // A table, and the same scene through its cells.
    hidden(&["tower.glb", "-o", "o.glb", "--from", "tower.pvs", "--effort", "0"]);
    folder.write("cupboard.glb", write_glb(&cupboard(0).expect("none").scene).expect("small"));
    assert_eq!(hidden(&["cupboard.glb", "-o", "o.glb", "--gap", "0.0625"]), 3);
}

#[test]
fn what_cannot_be_done_is_refused() {
    let folder = with_gearbox();
    folder.write("wall.obj", WALL);
    for (args, why) in [
        (&["in.glb", "-o", "out.obj"][..], "the scene is written as GLB"),
        (&["in.glb", "-o", "out.gltf", "--compact"], "written as GLB or"),
        (&["wall.obj", "-o", "out.glb"], "the OBJ scene is written as OBJ"),
        (&["wall.obj", "-o", "out.obj", "--flag"], "--flag is for glTF"),
        (&["in.glb", "-o", "out.glb", "--from", "inside"], "neither outside nor box="),
        (&["in.glb", "-o", "out.glb", "--from", "outside", "--from", "box=0,0,0,1,1,1"], "only place of eyes"),
        (&["in.glb", "-o", "out.glb", "--from", "none.pvs"], "none.pvs"),
        (&["in.glb", "-o", "out.glb", "--from", "walk"], "the file has no view volumes"),
        (&["in.glb", "-o", "out.glb", "--from", "walk=1,2"], "three comma-separated numbers"),
        (&["in.glb", "-o", "out.glb", "--gap", "0.00001"], "is too narrow for a scene"),
        (&["in.glb", "-o", "out.glb", "--gap", "-1"], "a number from 0 on"),
        (&["in.glb"], "--output"),
        (&["none.glb", "-o", "out.glb"], "none.glb"),
    ] {
        let run = folder.run(&[&["strip"], args].concat());
        assert!(run.code == 2 && run.err.contains(why), "{args:?}: {}", run.err);
    }
    assert_eq!(folder.names(), ["in.glb", "wall.obj"]);
}
