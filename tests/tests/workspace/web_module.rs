//! The module of WebAssembly against the crates: cases of all kinds are made here, and Node compares what the module makes of them. `SIGHTLINES_WASM` is the module,
//! as `cargo xtask wasm` builds it; without it these tests do not run, and say so.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, Bakeable, bake};
use sightlines::formats::Source;
use sightlines::formats::geojson::write_plan;
use sightlines::formats::scene::{write_glb, write_obj};
use sightlines::scenes::{
    CityOptions, OfficeOptions, TowerOptions, city, doom_like, maze, office, pillared_hall, tower, turned_pillared_hall,
};
use sightlines_testkit::browser::chromium;
use sightlines_tests::data_folder;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A case: a file, and the table that the crates make of it as of bytes in memory.
fn put(folder: &Path, case: usize, file: &str, bytes: &[u8], request: Value) {
    fs::write(folder.join(file), bytes).expect("a file");
    let source = Source::Memory { name: Path::new(file), bytes, beside: None };
    let input = Bakeable::read(&source, None).unwrap_or_else(|error| panic!("{file}: {error}"));
    let parsed = BakeRequest::from_json(&request.to_string()).expect("a request");
    let table = bake(&input, &parsed).unwrap_or_else(|error| panic!("{file}: {error}")).table;
    fs::write(folder.join(format!("{case}.pvs")), table.to_bytes()).expect("a table");
    let case_file = folder.join(format!("{case}.json"));
    fs::write(case_file, json!({ "file": file, "map": null, "request": request }).to_string()).expect("a case");
}

#[test]
fn the_module_makes_the_tables_of_the_crates() {
    let Some(module) = std::env::var_os("SIGHTLINES_WASM") else {
        eprintln!("NOT RUN: SIGHTLINES_WASM names no module, so none is tested; `cargo xtask wasm` builds one");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let small = TowerOptions { floors: 1, rooms_x: 3, rooms_y: 2, ..TowerOptions::default() };
    let scene = tower(small).expect("a tower");
    let glb = write_glb(&scene).expect("a scene");
    let plan = |plan| write_plan(&plan).into_bytes();
    let city = city(CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() }).expect("a city");
    let cells = json!({ "cells": [{ "id": "a", "min": [1, 0.5, 1], "max": [2, 1.5, 2] }, { "id": "b", "min": [5, 0.5, 4], "max": [6, 1.5, 5] }] });
    let generated: Vec<(&str, Vec<u8>, Value)> = vec![
        ("office.geojson", plan(office(OfficeOptions::default()).expect("an office")), json!({})),
        ("kd.geojson", plan(maze(3, 8, 8).expect("a maze")), json!({ "subdivide": "kd", "tau": 0.5 })),
        ("cut.geojson", plan(maze(4, 6, 6).expect("a maze")), json!({ "subdivide": "triangulation" })),
        ("doom.geojson", plan(doom_like(5, 6).expect("a map")), json!({})),
        ("hall.geojson", plan(pillared_hall(1, 6, 4).expect("a hall")), json!({})),
        ("turned.geojson", plan(turned_pillared_hall(1, 5, 4).expect("a hall")), json!({ "gap": 0.0 })),
        ("tower.glb", glb.clone(), json!({})),
        ("tower.obj", write_obj(&scene).expect("a scene"), json!({})),
        ("sightlines.glb", glb.clone(), json!({ "method": "sightlines", "detail_below": 0.5 })),
        ("grid.glb", glb.clone(), json!({ "grid": [3, 1, 2] })),
        ("places.glb", glb.clone(), json!({ "n_cells": 9, "method": "line-space" })),
        ("split.glb", glb.clone(), json!({ "n_cells": 6, "method": "shafts", "split": 1 })),
        ("buffers.glb", glb.clone(), json!({ "n_cells": 6, "method": "both", "planes": 2, "texels": 32 })),
        ("eyes.glb", glb.clone(), json!({ "eye_height": [0.5, 2], "cell_size": 3 })),
        ("given.glb", glb, json!({ "cells": cells, "parts": 4 })),
        ("city.glb", write_glb(&city).expect("a scene"), json!({ "n_cells": 12 })),
    ];
    let mut n = 0;
    for (name, bytes, request) in generated {
        put(at, n, name, &bytes, request);
        n += 1;
    }
    if let Some(data) = data_folder("SIGHTLINES_DATA") {
        for (name, request) in [
            ("plans/duplex_0.geojson", json!({})),
            ("doom/freedoom1_E1M1.wad", json!({})),
            ("doom/freedoom1_E1M6.wad", json!({})),
            ("quake/e1m7.bsp", json!({})),
            ("quake/dm3.prt", json!({ "fast": true })),
            ("scenes/whale_large/whale_large.glb", json!({ "n_cells": 8 })),
        ] {
            let bytes = fs::read(data.join(name)).expect("real input");
            let name = Path::new(name).file_name().expect("a file").to_str().expect("a name");
            put(at, n, name, &bytes, request);
            n += 1;
        }
    }
    assert!(n >= 16, "{n}");
    let test = Path::new(env!("CARGO_MANIFEST_DIR")).join("../integrations/web/test/module.test.mjs");
    let mut command = Command::new("node");
    command.arg("--test").arg(test).env("SIGHTLINES_WASM", module).env("SIGHTLINES_CASES", at);
    match chromium() {
        Some(browser) => command.env("SIGHTLINES_CHROMIUM", browser),
        None => command.env_remove("SIGHTLINES_CHROMIUM"),
    };
    let output = command.output().expect("there is Node");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    println!("{text}");
    assert!(output.status.success(), "{text}");
}
