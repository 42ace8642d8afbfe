//! `build --method auto`: what is chosen, why, and that nothing is looser than by default.

use crate::common::Folder;
use crate::common::quake::row_of_leafs;
use serde_json::Value;
use sightlines::formats::quake::BspFormat;

/// A room with walls that are turned about the upright axis, and a screen in it that hides a crate.
fn slanted() -> String {
    let turn = |x: f64, y: f64, z: f64| format!("v {} {} {}\n", 0.8 * x - 0.6 * z, y, 0.6 * x + 0.8 * z);
    let mut text = String::new();
    let mut n = 0;
    let mut block = |name: &str, min: [f64; 3], max: [f64; 3]| {
        text.push_str(&format!("o {name}\n"));
        for i in 0..8 {
            let at = |k: usize| if i >> k & 1 == 0 { min[k] } else { max[k] };
            text.push_str(&turn(at(0), at(1), at(2)));
        }
        for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
            text.push_str(&format!("f {} {} {} {}\n", a + n, b + n, c + n, d + n));
        }
        n += 8;
    };
    block("screen", [-6.0, -6.0, 4.0], [6.0, 6.0, 4.5]);
    block("crate", [-0.5, -0.5, 9.0], [0.5, 0.5, 10.0]);
    block("lamp", [-0.25, -0.25, 2.0], [0.25, 0.25, 2.5]);
    text
}

fn objects_seen(folder: &Folder, table: &str) -> u64 {
    let export = folder.run(&["export", table]).expect(0).json();
    let rows = export["cell_objects"].as_array().expect("rows of objects");
    rows.iter().map(|row| row.as_array().expect("a row").len() as u64).sum()
}

fn method(answer: &Value) -> &str {
    answer["auto"]["method"].as_str().expect("the choice is printed")
}

#[test]
fn axial_scenes_ask_sightlines_alone() {
    let folder = Folder::with_tower();
    let answer = folder.run(&["build", "tower.glb", "--method", "auto", "-o", "auto.pvs", "--json"]).expect(0).json();
    assert_eq!(method(&answer), "sightlines");
    assert!(answer["auto"]["facts"]["axial_share"].as_f64().expect("a share") > 0.9, "{answer}");
    assert_eq!(folder.read("auto.pvs"), folder.read("tower.pvs"), "the default's table, byte for byte");
    let build = ["build", "tower.glb", "--method", "auto", "-o", "auto.pvs"];
    let text = folder.run(&build).expect(0).out;
    assert!(text.contains("\nmethod         sightlines (") && text.contains("perpendicular to an axis"), "{text}");
    let text = folder.run(&[&build[..], &["-v"]].concat()).expect(0).out;
    assert!(text.starts_with("chosen         sightlines\n") && text.contains("perpendicular to an axis"), "{text}");
}

#[test]
fn slanted_scenes_take_line_space_for_given_cells_and_sheets_for_their_own() {
    let folder = Folder::new();
    folder.write("slanted.obj", slanted());
    let cells = r#"{"cells":[{"id":"here","min":[-0.5,-0.5,-0.5],"max":[0.5,0.5,0.5]}]}"#;
    folder.write("cells.json", cells);
    let build = |words: &[&str], out: &str| {
        let words = [&["build", "slanted.obj", "--cells", "cells.json", "-o", out, "--json"][..], words].concat();
        folder.run(&words).expect(0).json()
    };
    let answer = build(&["--method", "auto"], "auto.pvs");
    assert_eq!(method(&answer), "sightlines and line space");
    let own = ["build", "slanted.obj", "--method", "auto", "--n-cells", "4", "-o", "own.pvs", "--json"];
    assert_eq!(method(&folder.run(&own).expect(0).json()), "sightlines and sheets");
    build(&[], "default.pvs");
    assert!(folder.read("default.pvs") == folder.read("auto.pvs"), "nothing said is auto");
    build(&["--method", "sightlines"], "lines.pvs");
    build(&["--method", "both"], "both.pvs");
    let [auto, lines, both] = ["auto.pvs", "lines.pvs", "both.pvs"].map(|table| objects_seen(&folder, table));
    assert!(auto <= both && auto < lines, "{both} {auto} {lines}");
    assert_eq!((auto, lines), (2, 3), "the crate is behind the screen");
}

#[test]
fn any_input_has_a_choice() {
    let folder = Folder::with_office();
    let answer = folder.run(&["build", "office.geojson", "--method", "auto", "-o", "a.pvs", "--json"]).expect(0).json();
    assert_eq!((method(&answer), &answer["auto"]["facts"]), ("sightlines", &Value::Null));
    assert_eq!(folder.read("a.pvs"), folder.read("office.pvs"));
    let map = row_of_leafs(BspFormat::Bsp29);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    for input in ["map.bsp", "map.prt"] {
        let answer = folder.run(&["build", input, "--method", "auto", "-o", "map.pvs", "--json"]).expect(0).json();
        assert_eq!(method(&answer), "sightlines", "{input}");
    }
    // Other methods mean nothing there, as ever.
    let refused = folder.refused(&["build", "office.geojson", "--method", "both", "-o", "b.pvs"]);
    assert!(refused.contains("--method"), "{refused}");
}
