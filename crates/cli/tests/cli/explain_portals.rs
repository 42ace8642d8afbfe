//! Explanations for clusters of Quake maps through the command line: of portal files and of their tables.

use crate::common::quake::{Map, rooms};
use crate::common::{Folder, Run};
use serde_json::{Value, json};
use sightlines::cells::{CellId, Portal3};
use sightlines::formats::quake::{graph_of_prt, prt::parse_prt};
use sightlines::pvs::Table;
use sightlines::sightline::Line3;

/// A map, its portals, and their table.
fn with(map: &Map) -> Folder {
    let folder = Folder::new();
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder.run(&["build", "map.prt", "-o", "map.pvs"]).expect(0);
    folder
}

fn explain(folder: &Folder, file: &str, [a, b]: [u32; 2], more: &[&str]) -> Run {
    folder.run(&[&["explain", file, &a.to_string(), &b.to_string()][..], more].concat())
}

fn point(value: &Value) -> [f64; 3] {
    serde_json::from_value(value.clone()).expect("three numbers")
}

/// Every pair of a map, from the one or from the other: the answer is the table's, the portal file and the table give the same, a line that is shown
/// passes the portals that it says where it says, and the checker accepts everything.
#[test]
fn clusters_are_explained() {
    let map = rooms(5, 3);
    let folder = with(&map);
    let graph = graph_of_prt(&parse_prt(map.prt.as_bytes()).expect("sound portals"));
    let table = Table::from_bytes(&folder.read("map.pvs")).expect("a sound table");
    let (mut n_visible, mut n_hidden) = (0, 0);
    let is_asked = |a: u32, b: u32| if (a + b).is_multiple_of(2) { a < b } else { a > b };
    for [a, b] in (0..15).flat_map(|a| (0..15).filter(move |&b| is_asked(a, b)).map(move |b| [a, b])) {
        let listed = table.sees(CellId(a), CellId(b));
        let run = explain(&folder, "map.pvs", [a, b], &["--json"]).expect(i32::from(!listed));
        let reply = run.json();
        assert_eq!((&reply["listed"], &reply["checked"]), (&json!(listed), &json!(true)), "{a} {b}");
        let of_prt = explain(&folder, "map.prt", [a, b], &["--json"]).expect(i32::from(!listed));
        assert_eq!(of_prt.out, run.out.replace(&format!("\"listed\":{listed}"), "\"listed\":null"));
        if listed {
            assert_eq!(reply["answer"], json!("visible"));
            let line = Line3 { a: point(&reply["line"][0]), b: point(&reply["line"][1]) };
            let mut here = CellId(a);
            for passed in reply["portals"].as_array().expect("a list") {
                let portal = &graph.portals()[passed["portal"].as_u64().expect("a number") as usize];
                let forward = portal.cells[0] == here;
                let shape: Portal3 = if forward { portal.shape.clone() } else { portal.shape.reversed() };
                assert!(line.passes(&shape), "{a} {b}");
                let at = point(&passed["at"]);
                // Windows are squares across an axis, so the place is within their corners.
                let corners = || shape.corners().iter();
                let is_within =
                    |k: usize| corners().any(|p| p[k] <= at[k] + 1e-9) && corners().any(|p| p[k] >= at[k] - 1e-9);
                assert!((0..3).all(is_within), "{a} {b}: {at:?}");
                here = portal.cells[usize::from(forward)];
                assert_eq!(passed["cell"], json!(here.0));
            }
            assert_eq!(here, CellId(b));
            n_visible += 1;
        } else {
            assert_eq!(reply["answer"], json!("hidden"));
            let blocked = reply["blocked"].as_array().expect("a list");
            assert_eq!(reply["n_blocked"], json!(blocked.len()));
            assert!(!blocked.is_empty() && blocked.iter().all(|way| !way["certificate"].is_null()));
            n_hidden += 1;
        }
    }
    assert!(n_visible > 50 && n_hidden > 25, "{n_visible} {n_hidden}");
}

#[test]
fn the_text_has_the_same() {
    let folder = with(&rooms(4, 1));
    let reply = explain(&folder, "map.prt", [0, 1], &[]).expect(0).out;
    let start = "cluster 0 sees cluster 1 through 1 portal\n  portal 0 into cluster 1 at (16, ";
    assert!(reply.starts_with(start) && reply.contains("\nalong the line from ("), "{reply}");
    assert!(reply.ends_with("\nthe independent checker accepts this\n"), "{reply}");
    let reply = explain(&folder, "map.prt", [2, 2], &[]).expect(0).out;
    assert!(reply.starts_with("both are cluster 2, and a cluster sees itself\n"), "{reply}");
    let hidden = (0..4).flat_map(|a| (0..4).map(move |b| [a, b])).find_map(|pair| {
        let run = explain(&folder, "map.pvs", pair, &["--proofs", "1"]);
        (run.code == 1).then_some(run.out)
    });
    let reply = hidden.expect("not all rooms see each other");
    let way = "passes one of ";
    assert!(reply.contains(" does not see cluster ") && reply.contains(way) && reply.contains("\n  blocked: portals "));
    assert!(reply.ends_with("\nthe independent checker accepts this\n"), "{reply}");
    // Two rooms without a way between them.
    let far = "PRT1\n3\n1\n4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8)\n";
    folder.write("far.prt", far);
    let reply = explain(&folder, "far.prt", [0, 2], &[]).expect(1).out;
    assert!(reply.starts_with("cluster 0 does not see cluster 2: no way through portals joins them\n"), "{reply}");
}

#[test]
fn limits_and_wrong_tables_are_reported() {
    let folder = with(&rooms(6, 5));
    let reply = explain(&folder, "map.prt", [0, 29], &["--max-questions", "1"]).expect(0).out;
    assert_eq!(reply, "cluster 0 and cluster 29: given up after 1 question; see --max-questions\n");
    let reply = explain(&folder, "map.prt", [0, 29], &["--max-questions", "1", "--json"]).expect(0).json();
    assert_eq!((&reply["answer"], &reply["checked"]), (&json!("unknown"), &json!(false)));
    // A table that was only bounded shows more than there is; and a wrong one is reported as such.
    folder.run(&["build", "map.prt", "-o", "fast.pvs", "--fast"]).expect(0);
    let [exact, fast] =
        ["map.pvs", "fast.pvs"].map(|name| Table::from_bytes(&folder.read(name)).expect("a sound table"));
    let pairs = || (0..30).flat_map(|a| (0..30).map(move |b| [a, b]));
    let sees = |table: &Table, [a, b]: [u32; 2]| table.sees(CellId(a), CellId(b));
    let loose = pairs().find(|&pair| sees(&fast, pair) && !sees(&exact, pair)).expect("the bound is loose");
    let reply = explain(&folder, "fast.pvs", loose, &[]).expect(1).out;
    assert!(reply.contains("\nthe table lists them as visible all the same\n"), "{reply}");
    let pair = pairs().find(|&[a, b]| a < b && sees(&exact, [a, b])).expect("two rooms see each other");
    let mut parts = exact.into_parts();
    for [a, b] in [pair, [pair[1], pair[0]]] {
        parts.rows.set(a as usize, b as usize, false);
    }
    folder.write("wrong.pvs", Table::new(parts).expect("a sound table").to_bytes());
    let reply = explain(&folder, "wrong.pvs", pair, &[]).expect(0).out;
    assert!(reply.contains("\nthe table says that they do not: it is wrong\n"), "{reply}");
}

#[test]
fn what_cannot_be_explained_is_refused() {
    let folder = with(&rooms(3, 2));
    let numbers = "a portal file does not say where its clusters are: name them by their numbers";
    for file in ["map.prt", "map.pvs"] {
        let error = folder.refused(&["explain", file, "0", "6"]);
        assert_eq!(error, format!("{file}: there is no cluster 6: there are 6"));
        assert_eq!(folder.refused(&["explain", file, "1,2,3", "0"]), format!("{file}: {numbers}"));
        let found = if file == "map.prt" { "a portal file" } else { "the table of a portal file" };
        for (option, meant) in [
            ("--max-visits", "plans"),
            ("--max-programs", "scenes in space"),
            ("--draw", "plans and scenes with portals"),
        ] {
            let error = folder.refused(
                &["explain", file, "0", "1", option, "9.svg"]
                    .map(|arg| if option != "--draw" && arg == "9.svg" { "9" } else { arg }),
            );
            assert_eq!(error, format!("{file}: {option} is for {meant}, and this is {found}"));
        }
    }
    let table = Table::from_bytes(&folder.read("map.pvs")).expect("a sound table");
    folder.write("bare.pvs", table.strip_geometry().to_bytes());
    let error = folder.refused(&["explain", "bare.pvs", "0", "1"]);
    assert_eq!(error, "bare.pvs: the table has no polygons and portals to look for lines in");
    folder.write("cut.prt", "PRT1\n2\n1\n3 0 1 (0 0 0)");
    let error = folder.refused(&["explain", "cut.prt", "0", "1"]);
    assert!(error.starts_with("cut.prt: line 4, column 14: expected the \"(\" before point 1"), "{error}");
    let office = Folder::with_office();
    let error = office.refused(&["explain", "office.pvs", "0", "1", "--max-questions", "5"]);
    assert_eq!(error, "office.pvs: --max-questions is for portal files, and this is the table of a plan");
}

/// `vis --certify` proves pairs of both kinds, changes nothing of the map, and says what it did.
#[test]
fn vis_certifies() {
    let folder = with(&rooms(6, 4));
    folder.run(&["vis", "map.bsp", "-o", "plain.bsp"]).expect(0);
    let run = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--certify", "20"]).expect(0);
    for kind in ["visible", "hidden"] {
        let line = format!("certified      20 of 20 {kind} pairs checked\n");
        assert!(run.out.contains(&line), "{}", run.out);
    }
    assert_eq!(folder.read("out.bsp"), folder.read("plain.bsp"));
    let reply = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json", "--certify", "100000"]).expect(0).json();
    let certified = &reply["certified"];
    for kind in ["visible", "hidden"] {
        let proven = &certified[kind];
        assert!(proven["n_picked"].as_u64() > Some(20), "{certified}");
        assert_eq!(proven["n_picked"], proven["n_accepted"], "{certified}");
    }
    assert_eq!(certified["visible"]["n_picked"], reply["n_visible_pairs"]);
    // Of a fast search pairs are hidden after all, which is no contradiction.
    let reply = folder.run(&["vis", "map.bsp", "-o", "f.bsp", "--json", "--fast", "--certify", "999"]).expect(0).json();
    let visible = &reply["certified"]["visible"];
    assert!(visible["n_loose"].as_u64() > Some(0) && visible["n_too_many"] == json!(0), "{visible}");
    let plain = folder.run(&["vis", "map.bsp", "-o", "out.bsp", "--json"]).expect(0).json();
    assert_eq!(plain["certified"], Value::Null);
}
