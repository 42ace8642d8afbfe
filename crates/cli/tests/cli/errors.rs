//! Bad input: one line that names the file and the place, exit code 2, and nothing written.

use crate::common::{Folder, doom_map, wad};
use sightlines::formats::doom::{ML_TWOSIDED, write_doom_map};
use sightlines::formats::wad::{LumpName, WadBuilder, WadKind};

/// Every command that reads a file says that it is missing.
#[test]
fn missing_files_are_named() {
    let folder = Folder::new();
    for args in [
        &["build", "no.wad", "-o", "out.pvs"][..],
        &["reject", "no.wad", "-o", "out.wad"],
        &["vis", "no.bsp"],
        &["query", "no.pvs", "--eye", "0,0"],
        &["walk", "no.pvs", "--random", "5"],
        &["pack", "no.pvs", "-o", "out.pvz"],
        &["relevance", "no.pvs", "-o", "out.rel"],
        &["unpack", "no.pvz", "-o", "out.pvs"],
        &["export", "no.pvs"],
        &["explain", "no.pvs", "0", "1"],
        &["draw", "no.pvs", "-o", "out.svg"],
        &["info", "no.pvs"],
    ] {
        let error = folder.refused(args);
        assert!(error.starts_with(args[1]) && error.contains("No such file"), "{error}");
    }
    assert!(folder.names().is_empty());
}

#[test]
fn files_of_the_wrong_kind_are_named() {
    let folder = Folder::with_office();
    folder.write("noise", [7u8; 1000]);
    folder.write("noise.wad", [7u8; 1000]);
    folder.write("noise.pvs", [7u8; 1000]);
    folder.write("noise.json", [7u8; 1000]);
    folder.write("empty.wad", "");
    folder.write("maps.wad", wad(&["MAP01"]));
    let build = |input: &str| folder.refused(&["build", input, "-o", "out.pvs"]);
    assert_eq!(
        build("noise"),
        "noise: neither a WAD nor a GeoJSON or DXF plan nor a GLB, glTF or OBJ nor a Quake map or portal file"
    );
    assert_eq!(
        build("office.pvs"),
        "office.pvs: neither a WAD nor a GeoJSON or DXF plan nor a GLB, glTF or OBJ nor a Quake map or portal file"
    );
    assert!(build("noise.wad").starts_with("noise.wad: "));
    assert!(build("empty.wad").starts_with("empty.wad: "));
    assert!(build("noise.json").starts_with("noise.json: line 1 column 1: "));
    let error = folder.refused(&["info", "noise"]);
    assert_eq!(
        error,
        "noise: neither a table nor a WAD nor a GeoJSON or DXF plan nor a GLB, glTF or OBJ nor a Quake map or portal file"
    );
    assert!(folder.refused(&["reject", "office.geojson", "-o", "out.wad"]).starts_with("office.geojson: "));
    assert_eq!(
        folder.refused(&["query", "noise.pvs", "--eye", "0,0"]),
        "noise.pvs: byte 0: this is no visibility table"
    );
    assert!(!folder.path("out.pvs").exists() && !folder.path("out.wad").exists());
}

/// Every command that needs a table explains how to make one.
#[test]
fn scenes_instead_of_tables_are_named_with_what_to_do() {
    let folder = Folder::with_tower();
    folder.write("plan.geojson", crate::common::maze_text(1));
    folder.write("maps.wad", wad(&["MAP01"]));
    folder.write("map.prt", crate::common::quake::rooms(2, 2).prt);
    folder.write("map.bsp", crate::common::quake::rooms(2, 2).bsp);
    let of_scene = |args: &[&str], file: &str| {
        let error = folder.refused(args);
        let table = std::path::Path::new(file).with_extension("pvs");
        let named = if file == "maps.wad" { " --map NAME" } else { "" };
        let what = format!(", not a table: build one first: sightlines build {file}{named} -o {}", table.display());
        assert!(error.starts_with(&format!("{file}: is ")) && error.ends_with(&what), "{args:?}: {error}");
    };
    for file in ["tower.glb", "plan.geojson", "maps.wad", "map.prt", "map.bsp"] {
        of_scene(&["query", file, "--eye", "1,1,1"], file);
        of_scene(&["walk", file, "--random", "5"], file);
        of_scene(&["draw", file, "-o", "out.svg"], file);
        of_scene(&["export", file], file);
        of_scene(&["pack", file, "-o", "out.pvz"], file);
        of_scene(&["relevance", file, "-o", "out.rel"], file);
        of_scene(&["unpack", file, "-o", "out.pvs"], file);
        // Portal files are explained themselves.
        if file != "map.prt" {
            of_scene(&["explain", file, "0", "1"], file);
        }
    }
    of_scene(&["verify", "tower.glb", "tower.glb"], "tower.glb");
    of_scene(&["levels", "tower.glb", "--table", "tower.glb", "-o", "lod"], "tower.glb");
    // What is no scene either is called what it is.
    folder.write("noise", [7u8; 100]);
    assert_eq!(folder.refused(&["export", "noise"]), "noise: byte 0: this is no visibility table");
    let scenes = ["map.bsp", "map.prt", "maps.wad", "noise", "plan.geojson", "tower.glb", "tower.pvs"];
    assert_eq!(folder.names(), scenes);
}

/// A table that was cut, or has a byte changed, is refused with the place.
#[test]
fn damaged_tables_are_refused() {
    let folder = Folder::with_office();
    let sound = folder.read("office.pvs");
    folder.write("cut.pvs", &sound[..sound.len() - 8]);
    let error = folder.refused(&["export", "cut.pvs", "-o", "out.json"]);
    assert!(error.starts_with("cut.pvs: byte "), "{error}");
    let mut flipped = sound.clone();
    let last = flipped.len() / 2;
    flipped[last] ^= 1;
    folder.write("flipped.pvs", &flipped);
    let error = folder.refused(&["draw", "flipped.pvs", "-o", "out.svg"]);
    assert!(error.starts_with("flipped.pvs: byte ") && error.contains("section "), "{error}");
    assert!(!folder.path("out.json").exists() && !folder.path("out.svg").exists());
}

#[test]
fn truncated_wads_are_refused_at_every_length() {
    let folder = Folder::with_wad();
    let sound = folder.read("maps.wad");
    for len in [0, 3, 11, 12, 40, sound.len() / 2, sound.len() - 1] {
        folder.write("cut.wad", &sound[..len]);
        for args in
            [&["reject", "cut.wad", "-o", "out.wad"][..], &["build", "cut.wad", "-o", "out.pvs", "--map", "MAP01"]]
        {
            let error = folder.refused(args);
            assert!(error.starts_with("cut.wad: "), "{error}");
        }
    }
    assert_eq!(folder.names(), ["cut.wad", "maps.wad"]);
}

#[test]
fn maps_that_are_not_there_are_named() {
    let folder = Folder::with_wad();
    let error = folder.refused(&["build", "maps.wad", "-o", "out.pvs", "--map", "E1M1"]);
    assert_eq!(error, "maps.wad: there is no map E1M1 in the file; there are MAP01, MAP02, MAP03");
    let error = folder.refused(&["build", "maps.wad", "-o", "out.pvs"]);
    assert_eq!(error, "maps.wad: there are 3 maps in the file; choose one with --map: MAP01, MAP02, MAP03");
    let error = folder.refused(&["reject", "maps.wad", "-o", "out.wad", "--map", "MAP01", "--map", "E1M1"]);
    assert!(error.starts_with("maps.wad: ") && error.contains("E1M1"), "{error}");
    let mut empty = WadBuilder::new(WadKind::Patch);
    empty.lump("NOTHING", b"").unwrap();
    folder.write("none.wad", empty.finish().unwrap());
    for args in [&["build", "none.wad", "-o", "out.pvs"][..], &["reject", "none.wad", "-o", "out.wad"]] {
        let error = folder.refused(args);
        assert!(error.starts_with("none.wad: ") && error.contains("maps"), "{error}");
    }
    folder.write("plan.geojson", crate::common::maze_text(1));
    let error = folder.refused(&["build", "plan.geojson", "-o", "out.pvs", "--map", "MAP01"]);
    assert_eq!(error, "plan.geojson: --map is for WADs, and this is none");
    assert_eq!(folder.names(), ["maps.wad", "none.wad", "plan.geojson"]);
}

/// Maps with something wrong inside: file, map, lump and index are named; an output that was there stays.
#[test]
fn damaged_maps_are_named_with_their_place() {
    let folder = Folder::new();
    let sound = doom_map(1);
    let mut cases = Vec::new();
    let mut map = sound.clone();
    map.lines[4].v2 = 60_000;
    cases.push((map, "LINEDEFS 4: vertex 60000"));
    let mut map = sound.clone();
    map.vertices.fill([5, 5]);
    cases.push((map, "LINEDEFS: the map is empty"));
    let mut map = sound.clone();
    map.lines[0].right = Some(50_000);
    cases.push((map, "SIDEDEFS 0: sector 50000"));
    let mut map = sound.clone();
    map.n_sectors = 0;
    cases.push((map, "SECTORS"));
    let mut map = sound.clone();
    map.lines.clear();
    cases.push((map, "LINEDEFS: the map is empty"));
    for (map, place) in cases {
        folder.write("bad.wad", write_doom_map(LumpName::new("MAP07").unwrap(), &map).unwrap());
        for (command, out) in [("build", "out.pvs"), ("reject", "out.wad")] {
            folder.write(out, "precious");
            let error = folder.refused(&[command, "bad.wad", "-o", out]);
            assert!(error.starts_with("bad.wad: map MAP07: ") && error.contains(place), "{command}: {error}");
            assert_eq!(folder.read(out), b"precious");
        }
        let before = folder.read("bad.wad");
        folder.refused(&["reject", "bad.wad", "-o", "bad.wad"]);
        assert_eq!(folder.read("bad.wad"), before);
        let reply = folder.run(&["info", "bad.wad"]).expect(0).out;
        assert!(reply.contains("cannot be used: ") && reply.contains(place), "{reply}");
    }
    assert_eq!(folder.names(), ["bad.wad", "out.pvs", "out.wad"]);
}

#[test]
fn maps_without_sectors_are_refused() {
    let folder = Folder::new();
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("MAP01", b"").unwrap().lump("LINEDEFS", &[0; 14]).unwrap().lump("SIDEDEFS", b"").unwrap();
    builder.lump("VERTEXES", &[0; 8]).unwrap();
    folder.write("bad.wad", builder.finish().unwrap());
    for args in [&["build", "bad.wad", "-o", "out"][..], &["reject", "bad.wad", "-o", "out"]] {
        assert_eq!(folder.refused(args), "bad.wad: map MAP01: SECTORS: there is no such lump");
    }
    assert_eq!(folder.names(), ["bad.wad"]);
}

#[test]
fn plans_that_cannot_be_used_are_named_with_their_place() {
    let folder = Folder::new();
    for (text, place) in [
        (r#"{"type":"LineString","coordinates":[[0,0],[NaN,1]]}"#, "line 1 column "),
        (r#"{"type":"LineString","coordinates":[[0,0],[1e999,1]]}"#, "line 1 column "),
        (r#"{"type":"LineString","coordinates":[[0,0],[1e300,1]]}"#, "position 1: coordinate"),
        (r#"{"type":"FeatureCollection","features":[]}"#, ""),
        (r#"{"type":"LineString""#, "the text ends too early"),
    ] {
        folder.write("plan.geojson", text);
        let error = folder.refused(&["build", "plan.geojson", "-o", "out.pvs"]);
        assert!(error.starts_with("plan.geojson: ") && error.contains(place), "{text}: {error}");
    }
    assert_eq!(folder.names(), ["plan.geojson"]);
}

#[test]
fn points_and_cells_that_cannot_be_are_refused() {
    let folder = Folder::with_office();
    for point in ["NaN,1", "inf,0", "1", "1,2,3,4", "1,x", "", ",", "1e300,1"] {
        let run = folder.run(&["query", "office.pvs", "--eye", point]).expect(2);
        assert!(
            run.out.is_empty() && run.err.starts_with("error: ") && run.err.contains("--eye"),
            "{point}: {}",
            run.err
        );
        let run = folder.run(&["draw", "office.pvs", "-o", "out.svg", "--eye", point]).expect(2);
        assert!(run.err.starts_with("error: "), "{point}: {}", run.err);
    }
    let error = folder.refused(&["query", "office.pvs", "--eye", "1,2,3"]);
    assert_eq!(error, "office.pvs: the table has 2 dimensions, but the point has 3 coordinates");
    for args in [
        &["draw", "office.pvs", "-o", "out.svg", "--cell", "9999"][..],
        &["explain", "office.pvs", "9999", "0"],
        &["explain", "office.pvs", "0", "9999", "--draw", "out.svg"],
    ] {
        assert!(folder.refused(args).starts_with("office.pvs: there is no cell 9999: the table has "));
    }
    for place in ["-3", "x", "1.5"] {
        assert!(
            folder
                .run(&["explain", "office.pvs", "0", place])
                .expect(2)
                .err
                .contains("neither the id of a cell nor a point")
        );
    }
    assert!(!folder.path("out.svg").exists());
}

#[test]
fn usage_is_checked() {
    let folder = Folder::with_office();
    for args in [
        &[][..],
        &["fly"],
        &["build", "office.geojson"],
        &["build", "office.geojson", "-o", "out.pvs", "--subdivide", "bsp"],
        &["build", "office.geojson", "-o", "out.pvs", "--tau", "nan"],
        &["build", "office.geojson", "-o", "out.pvs", "--tau", "-1"],
        &["build", "office.geojson", "-o", "out.pvs", "--threads", "99999999"],
        &["draw", "office.pvs", "-o", "out.svg", "--size", "3"],
        &["draw", "office.pvs", "-o", "out.svg", "--size", "99999"],
        &["draw", "office.pvs", "-o", "out.svg", "--cell", "0", "--eye", "1,1"],
        &["query", "office.pvs"],
    ] {
        let run = folder.run(args).expect(2);
        assert!(run.out.is_empty() && !run.err.is_empty(), "{args:?}");
    }
    let error = folder.refused(&["draw", "office.pvs", "-o", "out.gif"]);
    assert_eq!(error, "out.gif: the name of a picture ends in .svg or .png");
    assert_eq!(folder.names(), ["office.geojson", "office.pvs"]);
    assert!(folder.run(&["--help"]).expect(0).out.contains("Exit codes"));
    assert!(folder.run(&["--version"]).expect(0).out.starts_with("sightlines "));
}

/// Outputs that cannot be written, or that would destroy their own input.
#[test]
fn outputs_are_all_or_nothing() {
    let folder = Folder::with_office();
    folder.write("maps.wad", wad(&["MAP01"]));
    let [plan, table] = ["office.geojson", "office.pvs"].map(|name| folder.read(name));
    for args in [
        &["build", "office.geojson", "-o", "no/out.pvs"][..],
        &["reject", "maps.wad", "-o", "no/out.wad"],
        &["export", "office.pvs", "-o", "no/out.json"],
        &["pack", "office.pvs", "-o", "no/out.pvz"],
        &["relevance", "office.pvs", "-o", "no/out.rel"],
        &["walk", "office.pvs", "--random", "5", "-o", "no/out.svg"],
        &["draw", "office.pvs", "-o", "no/out.svg"],
        &["explain", "office.pvs", "0", "1", "--draw", "no/out.svg"],
        &["demo", "--out", "office.pvs/folder"],
    ] {
        let error = folder.refused(args);
        assert!(error.contains("cannot be "), "{error}");
    }
    for args in
        [&["build", "office.geojson", "-o", "office.geojson"][..], &["export", "office.pvs", "-o", "./office.pvs"]]
    {
        assert!(folder.refused(args).ends_with("the output would replace the input"));
    }
    assert_eq!([plan, table], ["office.geojson", "office.pvs"].map(|name| folder.read(name)));
    assert_eq!(folder.names(), ["maps.wad", "office.geojson", "office.pvs"]);
}

/// A two-sided line with a missing side and a self-referencing sector are no errors.
#[test]
fn odd_maps_are_taken() {
    let folder = Folder::new();
    let mut map = doom_map(2);
    let line = map.lines.iter_mut().find(|l| l.left.is_some()).expect("a door");
    (line.left, line.flags) = (None, ML_TWOSIDED);
    let line = map.lines.iter_mut().rfind(|l| l.left.is_some()).expect("a door");
    line.left = line.right;
    folder.write("odd.wad", write_doom_map(LumpName::new("MAP01").unwrap(), &map).unwrap());
    folder.run(&["build", "odd.wad", "-o", "odd.pvs"]).expect(0);
    folder.run(&["reject", "odd.wad", "-o", "out.wad"]).expect(0);
}

/// A reader of only the first line gets no error.
#[cfg(unix)]
#[test]
fn closed_pipes_are_no_error() {
    let folder = Folder::with_office();
    let program = env!("CARGO_BIN_EXE_sightlines");
    let mut child = std::process::Command::new(program)
        .args(["export", "office.pvs"])
        .current_dir(folder.path("."))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));
}
