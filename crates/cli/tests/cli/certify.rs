//! `build --certify`, and `verify` with the proofs that it wrote.

use crate::common::Folder;
use crate::common::quake::{rooms, row_of_leafs};
use serde_json::{Value, json};
use sightlines::formats::quake::BspFormat;
use sightlines::pvs::{CellId, Table};

/// Writes the table of `t.pvs` with another answer for a pair.
fn flip(folder: &Folder, a: u32, b: u32) {
    let table = Table::from_bytes(&folder.read("t.pvs")).expect("a sound table");
    let bit = !table.sees(CellId(a), CellId(b));
    let mut parts = table.into_parts();
    parts.rows.set(a as usize, b as usize, bit);
    parts.rows.set(b as usize, a as usize, bit);
    folder.write("flipped.pvs", Table::new(parts).expect("symmetric").to_bytes());
}

/// Invariant: what `build --certify` writes is proven whole, in a way that `verify` finds by itself; each wrong pair is caught by
/// the proofs alone, whichever way it is wrong.
fn build_and_flip(folder: &Folder, scene: &str, of_map: &[&str], step: usize, n_undecided: u64) {
    let built =
        folder.run(&[&["build", scene, "-o", "t.pvs", "--certify", "--json"], of_map].concat()).expect(0).json();
    assert_eq!(built["proofs"], "t.cert");
    assert_eq!(built["n_proof_bytes"], json!(folder.read("t.cert").len()));
    let few = ["--rays", "0", "--pairs", "0", "--json"];
    let good = folder.run(&[&["verify", "t.pvs", scene, "--strict"], of_map, &few].concat()).expect(0).json();
    let proofs = &good["proofs"];
    assert_eq!((&proofs["n_violations"], &proofs["is_true"]), (&json!(0), &json!(true)), "{proofs}");
    // A pair that the search could not decide about counts as visible, and has no line.
    assert_eq!(
        (&proofs["n_unproven_hidden"], &proofs["n_unproven_hidden_objects"]),
        (&json!(0), &json!(0)),
        "{proofs}"
    );
    assert!(proofs["n_unproven_visible"].as_u64().is_some_and(|n| n <= n_undecided), "{proofs}");
    assert_eq!(proofs["n_bare_walls"], 0, "{proofs}");
    assert!(proofs["n_walls"].as_u64() > Some(10) && proofs["n_hidden"].as_u64() > Some(10), "{proofs}");
    let table = Table::from_bytes(&folder.read("t.pvs")).expect("a sound table");
    let n = table.n_cells() as u32;
    let pairs: Vec<[u32; 2]> = (0..n).flat_map(|a| (a + 1..n).map(move |b| [a, b])).collect();
    for &[a, b] in pairs.iter().step_by(pairs.len() / step + 1) {
        flip(folder, a, b);
        let args = [&["verify", "flipped.pvs", scene, "--proofs", "t.cert"], of_map, &few].concat();
        // A scene in space may show too much.
        if table.dimension() == 3 && !table.sees(CellId(a), CellId(b)) {
            let more = folder.run(&args).expect(0).json();
            let excess = ["n_excess", "n_violations"].map(|key| more["proofs"][key].as_u64());
            assert_eq!(excess, [proofs["n_excess"].as_u64().map(|n| n + 1), Some(0)], "{}", more["proofs"]);
            continue;
        }
        let bad = folder.run(&args).expect(1).json();
        let reply: &Value = &bad["proofs"]["violations"];
        assert_eq!(reply.as_array().map(Vec::len), Some(1), "{reply}");
        assert!(reply[0].as_str().is_some_and(|text| text.starts_with(&format!("cells {a} and {b} "))), "{reply}");
    }
}

#[test]
fn plans_are_proven() {
    build_and_flip(&Folder::with_office(), "office.geojson", &[], 6, 0);
    build_and_flip(&Folder::with_wad(), "maps.wad", &["--map", "MAP01"], 3, 0);
}

#[test]
fn scenes_in_space_are_proven() {
    build_and_flip(&Folder::with_tower(), "tower.glb", &[], 3, 2);
}

/// Rooms in rows, with windows between them at places that differ.
#[test]
fn quake_maps_are_proven() {
    let folder = Folder::new();
    folder.write("map.prt", &rooms(4, 3).prt);
    prove_and_flip(&folder, "map.prt");
    let map = row_of_leafs(BspFormat::ALL[0]);
    folder.write("row.bsp", &map.bsp);
    folder.write("row.prt", &map.prt);
    folder.run(&["build", "row.bsp", "-o", "t.pvs", "--certify"]).expect(0);
    let out = folder.run(&["verify", "t.pvs", "row.bsp", "--strict"]).expect(0).out;
    assert!(out.contains("\n               6 visible pairs and 0 hidden pairs proven\n"), "{out}");
}

/// As [`build_and_flip`], but no walls are looked for in a map.
fn prove_and_flip(folder: &Folder, scene: &str) {
    let built = folder.run(&["build", scene, "-o", "t.pvs", "--certify", "--json"]).expect(0).json();
    assert_eq!((&built["proofs"], &built["n_proof_bytes"]), (&json!("t.cert"), &json!(folder.read("t.cert").len())));
    let few = ["--rays", "0", "--pairs", "0", "--json"];
    let good = folder.run(&[&["verify", "t.pvs", scene, "--strict"][..], &few].concat()).expect(0).json();
    let proofs = &good["proofs"];
    let unproven = ["n_violations", "n_unproven_hidden", "n_unproven_visible"].map(|key| proofs[key].as_u64());
    assert_eq!(unproven, [Some(0); 3], "{proofs}");
    assert!(proofs["n_hidden"].as_u64() > Some(10) && proofs["n_visible"].as_u64() > Some(10), "{proofs}");
    let n = Table::from_bytes(&folder.read("t.pvs")).expect("a sound table").n_cells() as u32;
    for [a, b] in (0..n).map(|a| [a, (a * 5 + 1) % n]).filter(|[a, b]| a < b) {
        flip(folder, a, b);
        let args = [&["verify", "flipped.pvs", scene, "--proofs", "t.cert"][..], &few].concat();
        let reply = &folder.run(&args).expect(1).json()["proofs"]["violations"];
        assert_eq!(reply.as_array().map(Vec::len), Some(1), "{reply}");
        assert!(reply[0].as_str().is_some_and(|text| text.starts_with(&format!("cells {a} and {b} "))), "{reply}");
    }
}

/// Proofs beside a table that was built again are not held against it, unless they are requested.
#[test]
fn stale_proofs_are_recognized() {
    let folder = Folder::with_office();
    folder.run(&["build", "office.geojson", "-o", "t.pvs", "--certify"]).expect(0);
    let map = rooms(4, 3);
    folder.write("map.prt", &map.prt);
    folder.run(&["build", "map.prt", "-o", "t.pvs"]).expect(0);
    let verify = ["verify", "t.pvs", "map.prt", "--rays", "0", "--pairs", "0"];
    let out = folder.run(&verify).expect(0).out;
    assert!(out.contains("t.cert is stale: ") && out.contains("build the table with --certify again"), "{out}");
    let json = folder.run(&[&verify[..], &["--strict", "--json"]].concat()).expect(1).json();
    assert_eq!((&json["proofs"]["is_stale"], &json["proofs"]["is_true"]), (&json!(true), &json!(false)));
    let error = folder.refused(&[&verify[..], &["--proofs", "t.cert"]].concat());
    assert!(error.contains("the proofs are for a plan"), "{error}");
    // Of the same kind.
    folder.write("other.prt", &rooms(3, 3).prt);
    folder.run(&["build", "other.prt", "-o", "t.pvs", "--certify"]).expect(0);
    folder.run(&["build", "map.prt", "-o", "t.pvs"]).expect(0);
    assert!(folder.run(&verify).expect(0).out.contains("t.cert is stale: "));
    let bad = folder.run(&[&verify[..], &["--proofs", "t.cert", "--json"]].concat()).expect(1).json();
    assert_eq!((&bad["proofs"]["is_stale"], &bad["proofs"]["n_violations"]), (&json!(false), &json!(1)));
}

#[test]
fn the_text_has_the_counts() {
    let folder = Folder::with_office();
    let out = folder.run(&["build", "office.geojson", "-o", "t.pvs", "--certify=p.bin"]).expect(0).out;
    assert!(out.contains("\nproofs         p.bin, "), "{out}");
    assert!(folder.path("p.bin").exists() && !folder.path("t.cert").exists());
    let out = folder.run(&["verify", "t.pvs", "office.geojson", "--proofs", "p.bin"]).expect(0).out;
    for line in ["proofs         p.bin, ", "hidden pairs proven\n", "walls          ", "proofs say     nothing"] {
        assert!(out.contains(line), "{line}: {out}");
    }
    // Without proofs the output does not mention them.
    let out = folder.run(&["verify", "t.pvs", "office.geojson"]).expect(0).out;
    assert!(!out.contains("proofs"), "{out}");
}

#[test]
fn what_cannot_be_proven_or_checked_is_refused() {
    let folder = Folder::with_tower();
    let error = folder.refused(&["build", "tower.glb", "-o", "t.pvs", "--certify=tower.glb"]);
    assert!(error.contains("tower.glb"), "{error}");
    let error = folder.refused(&["build", "tower.glb", "-o", "t.pvs", "--certify=t.pvs"]);
    assert!(error.contains("t.pvs"), "{error}");
    folder.run(&["build", "tower.glb", "-o", "t.pvs"]).expect(0);
    let verify = ["verify", "t.pvs", "tower.glb", "--rays", "0", "--pairs", "0"];
    let error = folder.refused(&[&verify[..], &["--strict"]].concat());
    assert!(error.contains("--strict is for tables with proofs"), "{error}");
    let error = folder.refused(&[&verify[..], &["--proofs", "none.cert"]].concat());
    assert!(error.contains("none.cert"), "{error}");
    let error = folder.refused(&[&verify[..], &["--proofs", "tower.glb"]].concat());
    assert!(error.contains("these are no proofs of a table"), "{error}");
}

/// What a from-region method hides is proven where walls hide it as well; the rest is counted by `build` and `verify`, and refused by `--strict`
/// alone.
#[test]
fn what_regions_hide_is_proven_or_counted() {
    let folder = Folder::with_bare_tower();
    // The method alone, of which the walls prove all; and with a pair less, as if it had hidden it.
    let build = ["build", "tower.glb", "--method", "both", "-o", "t.pvs", "--certify"];
    let built = folder.run(&[&build[..], &["--json"]].concat()).expect(0).json();
    assert_eq!((&built["unproven"]["n_hidden"], &built["proofs"]), (&json!(0), &json!("t.cert")), "{built}");
    assert_eq!(built["unproven"]["n_hidden_objects"], 0, "{built}");
    let text = folder.run(&build).expect(0).out;
    assert!(
        text.contains("\nunproven       0 hidden pairs and ") && !text.contains("of a cell and an object"),
        "{text}"
    );
    let few = ["--rays", "0", "--pairs", "0"];
    folder.run(&[&["verify", "t.pvs", "tower.glb", "--strict"][..], &few].concat()).expect(0);
    let table = Table::from_bytes(&folder.read("t.pvs")).expect("a sound table");
    let apart =
        |b: &u32| table.sees(CellId(0), CellId(*b)) && !table.portals().iter().any(|p| p.cells.contains(&CellId(*b)));
    let seen = (1..table.n_cells() as u32).find(|b| table.sees(CellId(0), CellId(*b)));
    let other = (1..table.n_cells() as u32).rev().find(apart).or(seen).expect("a cell that is seen");
    flip(&folder, 0, other);
    let verify = [&["verify", "flipped.pvs", "tower.glb", "--proofs", "t.cert"][..], &few].concat();
    let answer = folder.run(&[&verify[..], &["--strict", "--json"]].concat()).expect(1).json();
    let proofs = &answer["proofs"];
    assert_eq!((&proofs["n_unproven_hidden"], &proofs["n_violations"]), (&json!(1), &json!(0)), "{proofs}");
    assert_eq!(proofs["n_hidden_past_portals"], 1, "{proofs}");
}

/// About cells without portals there are no proofs: all is counted, in words and for programs, and an old file is not taken for theirs.
#[test]
fn cells_without_portals_are_counted_as_unproven() {
    let folder = Folder::with_bare_tower();
    folder.run(&["build", "tower.glb", "-o", "t.pvs", "--certify"]).expect(0);
    let grid = ["build", "tower.glb", "--method", "both", "--grid", "3,2,3", "-o", "t.pvs", "--certify"];
    let run = folder.run(&grid).expect(0);
    assert!(run.err.contains("no proofs are written: there are none about cells without portals"), "{}", run.err);
    assert!(run.out.contains("\nproofs         none: ") && run.out.contains("\nunproven       all "), "{}", run.out);
    let built = folder.run(&[&grid[..], &["--json"]].concat()).expect(0).json();
    assert!(built["proofs"].is_null() && built["unproven"]["n_hidden_past_portals"] == 0, "{built}");
    let counts = ["n_hidden", "n_visible", "n_hidden_objects"].map(|key| built["unproven"][key].as_u64());
    assert_eq!(counts[0].zip(counts[1]).map(|(hidden, visible)| hidden + visible), Some(18 * 17 / 2), "{built}");
    assert!(counts.iter().all(|n| *n > Some(0)), "{built}");
    // The proofs that are there are those of the table before.
    let verify = ["verify", "t.pvs", "tower.glb", "--rays", "1000", "--json"];
    let answer = folder.run(&verify).expect(0).json();
    assert_eq!((&answer["proofs"]["is_stale"], &answer["unproven"]), (&json!(true), &built["unproven"]));
    std::fs::remove_file(folder.path("t.cert")).expect("the old proofs");
    let answer = folder.run(&verify).expect(0).json();
    assert_eq!((&answer["proofs"], &answer["unproven"]), (&Value::Null, &built["unproven"]));
    // Who wants proofs is not content with rays.
    let answer = folder.run(&[&verify[..], &["--strict"]].concat()).expect(1).json();
    assert_eq!((&answer["is_true"], &answer["n_violations"]), (&json!(false), &json!(0)));
    let text = folder.run(&verify[..5]).expect(0).out;
    assert!(text.starts_with("unproven       all "), "{text}");
}

#[test]
fn damaged_proofs_are_refused() {
    let folder = Folder::with_office();
    folder.run(&["build", "office.geojson", "-o", "t.pvs", "--certify"]).expect(0);
    let mut bytes = folder.read("t.cert");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    folder.write("t.cert", &bytes);
    let error = folder.refused(&["verify", "t.pvs", "office.geojson"]);
    assert!(error.contains("t.cert: byte ") && error.contains("the checksum is wrong"), "{error}");
}

/// Two slanted roofs: without walls along axes, the cells that can be proven hide nothing, and the program tells.
#[test]
fn scenes_without_axis_aligned_walls_are_warned_of() {
    let folder = Folder::new();
    folder.write(
        "hall.obj",
        "v 0 0 0\nv 24 0 0\nv 24 6 5\nv 0 6 5\nv 0 0 10\nv 24 0 10\nf 1 2 3\nf 1 3 4\nf 5 6 3\nf 5 3 4\n",
    );
    let run = folder.run(&["build", "hall.obj", "-o", "t.pvs", "--certify", "--json"]).expect(0);
    assert_eq!(run.json()["n_cells"], 1);
    assert!(run.err.contains("hall.obj: few walls are axis-aligned"), "{}", run.err);
    // The twins: cells that are named, and a scene whose walls are axis-aligned.
    let run = folder.run(&["build", "hall.obj", "--method", "sightlines", "-o", "t.pvs", "--certify"]).expect(0);
    assert!(!run.err.contains("axis-aligned"), "{}", run.err);
    let folder = Folder::with_tower();
    let run = folder.run(&["build", "tower.glb", "-o", "t.pvs", "--certify"]).expect(0);
    assert!(!run.err.contains("axis-aligned"), "{}", run.err);
}
