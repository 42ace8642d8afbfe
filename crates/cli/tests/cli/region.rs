//! `build --method multifocal`, with cells from a file or a grid.

use crate::common::{Folder, small_tower};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// For each cell of an export, by name, the objects that it may see.
fn seen_by_name(export: &Value) -> Vec<(String, BTreeSet<u64>)> {
    let cells = export["cells"].as_array().unwrap().iter().zip(export["cell_objects"].as_array().unwrap());
    let of = |(cell, objects): (&Value, &Value)| {
        let objects = objects.as_array().unwrap().iter().map(|o| o.as_u64().unwrap()).collect();
        (cell["name"].as_str().unwrap_or_default().to_owned(), objects)
    };
    cells.map(of).collect()
}

fn city(folder: &Folder) {
    folder.write("scene.glb", small_tower());
}

#[test]
fn names_of_given_cells_are_in_the_export_and_every_method_runs() {
    let folder = Folder::new();
    city(&folder);
    let cells = json!({"cells": [
        {"id": "low", "min": [1.0, 0.5, 1.0], "max": [2.0, 1.5, 2.0]},
        {"id": "Flur \"2\"", "min": [4.0, 0.5, 4.0], "max": [5.0, 1.5, 5.0]},
    ]});
    folder.write("cells.json", cells.to_string());
    let mut counts = Vec::new();
    for method in ["sightlines", "multifocal", "both", "shafts", "line-space"] {
        let args = ["build", "scene.glb", "--method", method, "--cells", "cells.json", "-o", "t.pvs", "--json"];
        let reply = folder.run(&args).expect(0).json();
        assert_eq!((&reply["n_cells"], &reply["subdivide"]), (&json!(2), &json!("boxes")), "{reply}");
        let export = folder.run(&["export", "t.pvs"]).expect(0).json();
        let seen = seen_by_name(&export);
        assert_eq!(seen.iter().map(|s| s.0.as_str()).collect::<Vec<_>>(), ["low", "Flur \"2\""]);
        counts.push(seen.iter().map(|s| s.1.len()).sum::<usize>());
    }
    let [lines, region, both, ..] = counts[..] else { panic!("five methods") };
    assert!(both <= lines && both <= region && both > 0, "{counts:?}");
    let grid = ["build", "scene.glb", "--method", "multifocal", "--grid", "2,1,2", "-o", "g.pvs"];
    let text = folder.run(&grid).expect(0).out;
    assert!(text.lines().count() == 4 && text.contains("; 4 given cells\n"), "{text}");
    let text = folder.run(&[&grid[..], &["-v"]].concat()).expect(0).out;
    assert!(text.contains("cells          4, with names\n"), "{text}");
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let folder = Folder::with_office();
    city(&folder);
    folder.write("bad.json", r#"{"cells":[{"id":"a","min":[1,0,0],"max":[0,1,1]}]}"#);
    let refused = |args: &[&str], what: &str| {
        let run = folder.run(&[args, &["-o", "no.pvs"]].concat()).expect(2);
        assert!(run.err.contains(what), "{}", run.err);
        assert!(!folder.path("no.pvs").exists());
    };
    refused(&["build", "scene.glb", "--cells", "bad.json"], "bad.json: line 1 column");
    refused(&["build", "scene.glb", "--cells", "none.json"], "none.json: ");
    refused(&["build", "scene.glb", "--grid", "0,1,1"], "not three numbers from 1 on");
    refused(&["build", "scene.glb", "--grid", "9000,9000,1"], "a grid of 9000 x 9000 x 1 view cells");
    refused(&["build", "scene.glb", "--grid", "2,2,2", "--stab-trees"], "--stab-trees is for cells with portals");
    refused(&["build", "office.geojson", "--method", "multifocal"], "--method is for scenes in space");
    // The mistake is the option, not its value.
    refused(&["build", "office.geojson", "--grid", "4,4"], "only scenes in space have a grid");
    refused(&["build", "office.geojson", "--cells", "none.json"], "--cells is for scenes in space");
    refused(&["build", "scene.glb", "--method", "multifocal", "--texels", "0"], "0 is not in 1..=8192");
    refused(&["build", "scene.glb", "--method", "multifocal", "--texels", "8192"], "bytes for each thread");
}

/// What rays hit first is never reported hidden, by any method.
#[test]
fn real_scenes_hide_nothing_that_was_seen() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("!! SKIPPED: SIGHTLINES_DATA is not set");
        return;
    };
    let scenes = Path::new(&data).join("scenes");
    let mut n = 0;
    for (name, every) in [("delft", 6), ("sponza", 8), ("pandora", 8), ("whale_large", 2)] {
        let read = |file: &str| -> Value {
            serde_json::from_slice(&std::fs::read(scenes.join(name).join(file)).expect("the file is there")).unwrap()
        };
        let witnesses =
            std::fs::read_dir(scenes.join(name)).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
        let seen = read(&witnesses.filter(|f| f.starts_with("seen_")).max().expect("there is a table of witnesses"));
        let wanted: Vec<&Value> = seen["seen"].as_array().unwrap().iter().step_by(every).collect();
        let all = read(seen["cells"].as_str().unwrap());
        let of = |id: &Value| all["cells"].as_array().unwrap().iter().find(|c| c["id"] == *id).expect("a known cell");
        let cells: Vec<&Value> = wanted.iter().map(|w| of(&w["id"])).collect();
        let folder = Folder::new();
        folder.write("cells.json", json!({ "cells": cells }).to_string());
        let scene = scenes.join(name).join(format!("{name}.glb"));
        let scene = scene.to_str().unwrap();
        // Buffers look past walls of one side.
        let args =
            ["build", scene, "--method", "multifocal", "--cells", "cells.json", "--backs", "drawn", "-o", "t.pvs"];
        folder.run(&args).expect(0);
        let listed = seen_by_name(&folder.run(&["export", "t.pvs"]).expect(0).json());
        let n_objects = seen["n_objects"].as_u64().unwrap() as usize;
        let (mut reported, mut witnessed) = (0, 0);
        for (witness, (id, objects)) in wanted.iter().zip(&listed) {
            assert_eq!(witness["id"].as_str().unwrap(), id);
            for object in witness["objects"].as_array().unwrap() {
                assert!(objects.contains(&object.as_u64().unwrap()), "{name}: cell {id} does not see object {object}");
                witnessed += 1;
            }
            reported += objects.len();
        }
        println!("{name}: {reported} reported, {witnessed} witnessed, of {}", n_objects * listed.len());
        // The twin: much is hidden.
        assert!(reported < n_objects * listed.len() * 95 / 100, "{name}");
        n += listed.len();
    }
    assert!(n > 20, "{n} cells");
}

/// Parts of objects, from the build to the query, packed or not; the impostor is a table that does not have them.
#[test]
fn parts_of_objects_go_from_build_to_query() {
    let folder = Folder::new();
    city(&folder);
    let build = ["build", "scene.glb", "--grid", "3,1,3", "-o", "t.pvs"];
    let whole = folder.run(&[&build[..], &["--json"]].concat()).expect(0).json();
    let reply = folder.run(&[&build[..], &["--parts", "5", "--json"]].concat()).expect(0).json();
    let share = |of: &Value| of["viewer"]["polygons"].as_f64().unwrap();
    assert!(whole["n_parts"].is_null() && reply["n_parts"].as_u64().unwrap() > 10, "{reply}");
    assert!(share(&reply) < 0.95 * share(&whole), "{} of {}", share(&reply), share(&whole));
    let text = folder.run(&["info", "t.pvs"]).expect(0).out;
    assert!(text.contains(&format!(", the large ones in {} parts\n", reply["n_parts"])), "{text}");
    folder.run(&["verify", "t.pvs", "scene.glb", "--rays", "2000", "--pairs", "200"]).expect(0);
    folder.run(&["pack", "t.pvs", "-o", "t.pvz"]).expect(0);
    folder.run(&["unpack", "t.pvz", "-o", "again.pvs"]).expect(0);
    assert!(folder.read("again.pvs") == folder.read("t.pvs"));
    let eye = ["--eye", "1.2,1,1.2", "--json"];
    let [plain, packed] =
        ["t.pvs", "t.pvz"].map(|table| folder.run(&[&["query", table], &eye[..]].concat()).expect(0).json());
    assert_eq!(plain, packed);
    let objects = plain["objects"].as_array().unwrap();
    let n_ranges = objects.iter().filter_map(|o| o["triangles"].as_array()).map(Vec::len).sum::<usize>();
    assert!(n_ranges >= objects.iter().filter(|o| !o["triangles"].is_null()).count() && n_ranges > 0, "{plain}");
    let refused = |args: &[&str], what: &str| {
        let run = folder.run(&[&["build", "scene.glb", "--parts", "5"], args, &["-o", "no.pvs"]].concat()).expect(2);
        assert!(run.err.contains(what), "{}", run.err);
    };
    refused(&["--certify"], "--parts is for tables alone, and this is a bake with proofs or stab trees");
}
