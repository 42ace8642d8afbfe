//! Asking by method, and walking.

use crate::common::Folder;
use crate::common::looks::{middle, scenes, table};
use serde_json::{Value, json};
use sightlines::eye_to_cell::Method;
use sightlines::pvs::{CellId, ObjectId};

fn methods() -> impl Iterator<Item = &'static str> {
    Method::ALL.into_iter().map(Method::name)
}

fn numbers(list: &Value) -> Vec<u64> {
    let number = |v: &Value| v.as_u64().or_else(|| v["id"].as_u64()).expect("a number");
    list.as_array().expect("a list").iter().map(number).collect()
}

/// What is in the first list and not in the second.
fn beyond(inner: &Value, outer: &Value) -> Vec<u64> {
    let outer = numbers(outer);
    numbers(inner).into_iter().filter(|id| !outer.contains(id)).collect()
}

/// Invariant: each method finds no more than the one before, and the first what the table says of the cell.
#[test]
fn methods_are_nested() {
    let (mut n_asked, mut n_less, mut n_wide) = (0, 0, 0);
    for (folder, name, views) in scenes() {
        let table = table(&folder, name);
        for cell in (0..table.n_cells()).step_by(1 + table.n_cells() / 8) {
            for view in &views {
                let eye = middle(&table, cell);
                let args = [&["query", name, "--eye", &eye, "--method", "all", "--json"][..], view].concat();
                let reply = folder.run(&args).expect(0).json();
                let methods = reply["methods"].as_array().expect("all methods");
                assert!(methods.iter().map(|m| m["method"].as_str().unwrap()).eq(self::methods()));
                let row: Vec<u64> = table.visible(CellId(cell as u32)).map(|c| u64::from(c.0)).collect();
                assert_eq!(numbers(&methods[0]["visible"]), row);
                for pair in methods.windows(2) {
                    for list in ["visible", "objects"] {
                        assert_eq!(beyond(&pair[1][list], &pair[0][list]), [0u64; 0], "{args:?}");
                        n_less += beyond(&pair[0][list], &pair[1][list]).len();
                    }
                }
                // By its own name a method says the same.
                let one = [&["query", name, "--eye", &eye, "--json"][..], view, &["--method", "exact"]].concat();
                let one = folder.run(&one).expect(0).json();
                assert_eq!((&one["visible"], &one["method"]), (&methods[4]["visible"], &json!("exact")));
                assert_eq!(one["dir"].is_null(), view.is_empty());
                n_wide += usize::from(view.is_empty());
                n_asked += 1;
            }
        }
    }
    // The impostor: the comparison finds something when it is turned round.
    assert!(n_asked > 30 && n_less > n_asked && n_wide > 5, "{n_asked} {n_less} {n_wide}");
}

#[test]
fn a_look_is_described_in_words() {
    let folder = Folder::with_office();
    let table = table(&folder, "office.pvs");
    let eye = middle(&table, 0);
    let reply = folder.run(&["query", "office.pvs", "--eye", &eye, "--method", "all"]).expect(0).out;
    assert_eq!(reply.lines().count(), 6, "{reply}");
    assert!(methods().zip(reply.lines().skip(1)).all(|(m, line)| line.starts_with(m) && line.ends_with(" µs")));
    let reply = folder.run(&["query", "office.pvs", "--eye", &eye, "--dir", "1,0"]).expect(0).out;
    assert!(reply.contains(" is in cell 0\nby exact in ") && reply.contains("\nsees "), "{reply}");
}

#[test]
fn closed_portals_cut_the_view() {
    let folder = Folder::with_office();
    let table = table(&folder, "office.pvs");
    let mut n_less = 0;
    for cell in (0..table.n_cells()).step_by(3) {
        let doors: Vec<String> = (0u32..)
            .zip(table.portals())
            .filter(|(_, p)| p.cells.contains(&CellId(cell as u32)))
            .map(|(i, _)| i.to_string())
            .collect();
        let eye = middle(&table, cell);
        let ask = |more: &[&str]| {
            let found = folder.run(&[&["query", "office.pvs", "--eye", &eye, "--json"][..], more].concat()).expect(0);
            numbers(&found.json()["visible"])
        };
        let doors = doors.join(",");
        let closed = ask(&["--closed", &doors]);
        assert_eq!(closed, [cell as u64], "behind closed doors");
        n_less += usize::from(ask(&["--method", "exact"]).len() > 1);
    }
    assert!(n_less > 3, "open doors show more: {n_less}");
    let error = folder.refused(&["query", "office.pvs", "--eye", "1,1", "--closed", "99999"]);
    assert!(error.starts_with("office.pvs: there is no portal 99999: the table has "), "{error}");
}

/// A room with a mirror at its lower wall, and a room behind a door in its upper one. Mirrors make images, of mirrors in mirrors only
/// if there are two.
#[test]
fn mirrors_show_images() {
    let folder = Folder::new();
    let line = |points: &str, mirror: bool| {
        let geometry = format!(r#"{{"type": "LineString", "coordinates": {points}}}"#);
        format!(r#"{{"type": "Feature", "properties": {{"mirror": {mirror}}}, "geometry": {geometry}}}"#)
    };
    let walls = line("[[8,0],[8,4],[5,4],[5,8],[3,8],[3,4],[0,4],[0,0]]", false);
    for (two, words) in [(false, 1), (true, 3)] {
        let lower = line("[[0,0],[8,0]]", true);
        let inner = line("[[0,4],[1,4]]", two);
        folder.write(
            "hall.geojson",
            format!(r#"{{"type": "FeatureCollection", "features": [{walls},{lower},{inner}]}}"#),
        );
        folder.run(&["build", "hall.geojson", "-o", "hall.pvs"]).expect(0);
        let ask = |more: &[&str]| {
            let args = ["query", "hall.pvs", "--eye", "0.5,2", "--json", "--method", "exact"];
            folder.run(&[&args[..], more].concat()).expect(0).json()
        };
        assert_eq!(ask(&[])["images"], json!([]));
        let found = ask(&["--bounces", "2"]);
        let images = found["images"].as_array().unwrap();
        assert!(images.len() >= words && images.iter().all(|image| image["complete"] == true), "{images:?}");
        // The mirror shows what is beside the eye.
        let cell = &found["cell"];
        assert!(images[0]["cells"].as_array().unwrap().contains(cell));
        let most = images.iter().map(|image| image["mirrors"].as_array().unwrap().len()).max();
        assert_eq!(most, Some(if two { 2 } else { 1 }));
        // Away from the mirror it is not seen.
        if !two {
            assert_eq!(ask(&["--bounces", "2", "--dir", "0,1", "--fov", "20"])["images"], json!([]));
        }
        let reply = folder.run(&["walk", "hall.pvs", "--random", "60", "--bounces", "1", "--json"]).expect(0).json();
        assert_eq!(reply["n_starved"], 0);
        assert!(reply["methods"][4]["images"].as_f64().unwrap() > 0.0);
    }
}

/// Outside of every cell everything may be seen, by whatever method; exit code 1.
#[test]
fn outside_sees_everything() {
    for (folder, name, views) in scenes() {
        let table = table(&folder, name);
        let eye = if table.dimension() == 2 { "--eye=-1000,0" } else { "--eye=-1000,0,0" };
        let args = [&["query", name, eye][..], &views[0]].concat();
        let reply = folder.run(&args).expect(1).out;
        assert!(reply.contains("is outside every cell, and sees everything: "), "{reply}");
        let found = folder.run(&[&args[..], &["--json", "--method", "all"]].concat()).expect(1).json();
        assert_eq!((&found["cell"], &found["outside"]), (&Value::Null, &json!(true)));
        for method in found["methods"].as_array().unwrap() {
            let lengths = ["visible", "objects"].map(|k| numbers(&method[k]).len());
            assert_eq!(lengths, [table.n_cells(), table.objects().len()]);
        }
    }
}

#[test]
fn looks_that_cannot_be_are_refused() {
    let folder = Folder::with_office();
    fn ask<'a>(more: &[&'a str]) -> Vec<&'a str> {
        [&["query", "office.pvs", "--eye", "1,1"][..], more].concat()
    }
    for bad in [
        &["--dir", "NaN,1"][..],
        &["--dir", "inf,1"],
        &["--dir", "1"],
        &["--dir", "1,0", "--fov", "NaN"],
        &["--dir", "1,0", "--fov", "0"],
        &["--dir", "1,0", "--fov", "361"],
        &["--dir", "1,0", "--aspect", "0"],
        &["--dir", "1,0", "--up", "0,0,0"],
        &["--method", "best"],
        &["--closed", "x"],
        &["--bounces", "99"],
    ] {
        let run = folder.run(&ask(bad)).expect(2);
        assert!(run.out.is_empty() && run.err.starts_with("error: "), "{bad:?}: {}", run.err);
    }
    for (bad, reply) in [
        (&["--dir", "0,0"][..], "--dir: the direction of view is not finite, or has no length"),
        (&["--dir", "1,0,0"], "office.pvs: the table has 2 dimensions, but the point has 3 coordinates"),
        (&["--fov", "40"], "--fov, --aspect and --up need --dir: without it the viewer looks all round"),
        (
            &["--dir", "1,0", "--up", "y"],
            "office.pvs: --up is for tables of scenes in space, and this is the table of a plan",
        ),
        (
            &["--dir", "1,0", "--aspect", "2"],
            "office.pvs: --aspect is for tables of scenes in space, and this is the table of a plan",
        ),
    ] {
        assert_eq!(folder.refused(&ask(bad)), reply);
    }
}

/// The numbers of a walk's methods.
fn kept(reply: &Value, what: &str) -> Vec<f64> {
    reply["methods"].as_array().unwrap().iter().map(|m| m[what]["mean"].as_f64().unwrap()).collect()
}

#[test]
fn walks_are_measured() {
    for (folder, name, _) in scenes() {
        let table = table(&folder, name);
        let args = ["walk", name, "--random", "400", "--seed", "7", "--json", "--steps", "none"];
        let reply = folder.run(&[&args[..], &["-o", "walk.svg", "--csv", "walk.csv"]].concat()).expect(0).json();
        assert_eq!((&reply["n_frames"], &reply["n_full"], &reply["n_starved"]), (&json!(400), &json!(400), &json!(0)));
        let (svg, csv) = (folder.read("walk.svg"), folder.read("walk.csv"));
        assert!(svg.ends_with(b"</svg>\n") && csv.iter().filter(|c| **c == b'\n').count() == 6);
        for what in ["cells", "objects", "polygons"] {
            let kept = kept(&reply, what);
            assert!(kept.is_sorted_by(|a, b| a >= b) && kept[4] < kept[0] && kept[4] > 0.0, "{what}: {kept:?}");
        }
        let polygons: u64 = (0..table.objects().len() as u32).map(|o| u64::from(table.polygons_of(ObjectId(o)))).sum();
        assert_eq!(reply["n_polygons"], polygons);
        // The same walk again leaves the same to draw, by one method as by all, from a packed table as from a plain one.
        folder.run(&["pack", name, "-o", "small.pvz"]).expect(0);
        let args = ["walk", "small.pvz", "--random", "400", "--seed", "7", "--json", "--method", "incident-portals"];
        let again = folder.run(&args).expect(0).json();
        assert_eq!(again["methods"].as_array().unwrap().len(), 2);
        assert_eq!(kept(&again, "cells"), [kept(&reply, "cells")[0], kept(&reply, "cells")[3]]);
        assert_eq!(kept(&again, "polygons"), [kept(&reply, "polygons")[0], kept(&reply, "polygons")[3]]);
        assert!(again["packed_bytes"][0].as_u64().unwrap() > 0 && reply["packed_bytes"].is_null());
        // Without a bound no frame is a coarser one. With none at all each of the exact method is, and shows what incident portals
        // find; the others are as before.
        let coarser = |reply: &Value| -> Vec<u64> {
            reply["methods"].as_array().unwrap().iter().map(|m| m["n_fell_back"].as_u64().unwrap()).collect()
        };
        assert_eq!((coarser(&reply), &reply["steps"]), (vec![0; 5], &json!(null)));
        let args = ["walk", name, "--random", "400", "--seed", "7", "--json", "--steps", "0"];
        let hurried = folder.run(&args).expect(0).json();
        assert_eq!((coarser(&hurried), &hurried["steps"]), (vec![0, 0, 0, 0, 400], &json!(0)));
        for what in ["cells", "objects", "polygons"] {
            let (hurried, full) = (kept(&hurried, what), kept(&reply, what));
            assert_eq!((&hurried[..4], hurried[4]), (&full[..4], full[3]), "{what}");
        }
        for line in hurried["methods"].as_array().unwrap() {
            assert!(line["longest_us"].as_f64() >= line["p99_us"].as_f64(), "{line}");
        }
        // A bound is what frames have unless they are told otherwise.
        let usual = folder.run(&["walk", name, "--random", "400", "--seed", "7", "--json"]).expect(0).json();
        assert_eq!(usual["steps"], 4096);
        // The impostor: another walk is another.
        let other = folder.run(&["walk", name, "--random", "400", "--seed", "8", "--json"]).expect(0).json();
        assert_ne!(kept(&other, "cells"), kept(&reply, "cells"));
    }
    let folder = Folder::with_tower();
    let reply = folder.run(&["walk", "tower.pvs", "--random", "50", "--budget", "1"]).expect(0).out;
    assert!(methods().all(|m| reply.contains(&format!("\n{m}"))) && reply.contains("subgraphs made"), "{reply}");
}

#[test]
fn walks_are_read_from_files() {
    let folder = Folder::with_office();
    let table = table(&folder, "office.pvs");
    let frames: Vec<String> = (0..table.n_cells())
        .map(|cell| format!(r#"{{"eye": [{}], "dir": [1, 0.5]}}"#, middle(&table, cell)))
        .chain([r#"{"eye": [-999, 0], "dir": [0, 1]}"#.to_owned()])
        .collect();
    folder.write("way.json", format!(r#"{{"frames": [{}]}}"#, frames.join(",")));
    let reply = folder.run(&["walk", "office.pvs", "--path", "way.json", "--fov", "360", "--json"]).expect(0).json();
    assert_eq!((&reply["n_full"], &reply["n_outside"]), (&json!(table.n_cells()), &json!(1)));
    // One frame in each cell, all round: on average what the table has on average, and the cell itself.
    let share = reply["methods"][0]["cells"]["share_of_all"].as_f64().unwrap();
    let n = table.n_cells() as f64;
    assert!((share - (1.0 + table.mean_visible_share() * (n - 1.0)) / n).abs() < 1e-9, "{share}");
    assert!(reply["step"].is_null());
    for (text, place) in [
        (r#"{"frames": [{"eye": [1, 1], "dir": [1, 0]}, {"eye": [1, 1], "dir": [0, 0]}]}"#, "frame 1: the direction"),
        (r#"{"frames": [{"eye": [1, 1, 1], "dir": [1, 0]}]}"#, "frame 0: eye has 3 numbers"),
        (r#"{"frames": [{"eye": [1, 1], "dir": [1, 0]}, 3]}"#, "frame 1: invalid type"),
        (r#"{"frames": []}"#, "no frames"),
        (r#"{"frames": "#, "line 1 column "),
        ("\u{0}\u{1}", "line 1 column "),
    ] {
        folder.write("bad.json", text);
        let error = folder.refused(&["walk", "office.pvs", "--path", "bad.json", "-o", "out.svg"]);
        assert!(error.starts_with("bad.json: ") && error.contains(place), "{text}: {error}");
    }
    let error = folder.refused(&["walk", "office.pvs", "--path", "no.json"]);
    assert!(error.starts_with("no.json: ") && error.contains("No such file"), "{error}");
    assert!(!folder.path("out.svg").exists());
}

#[test]
fn walks_that_cannot_be_are_refused() {
    let folder = Folder::with_office();
    for bad in [
        &["--random", "0"][..],
        &["--random", "x"],
        &[],
        &["--random", "5", "--path", "x.json"],
        &["--random", "5", "--step", "0"],
        &["--random", "5", "--step", "NaN"],
        &["--random", "5", "--fov", "NaN"],
        &["--random", "5", "--method", "best"],
        &["--random", "5", "--steps", "-1"],
        &["--random", "5", "--steps", "few"],
    ] {
        let run = folder.run(&[&["walk", "office.pvs"][..], bad].concat()).expect(2);
        assert!(run.out.is_empty() && run.err.starts_with("error: "), "{bad:?}: {}", run.err);
    }
    let error = folder.refused(&["walk", "office.pvs", "--random", "5", "-o", "office.pvs"]);
    assert_eq!(error, "office.pvs: the output would replace the input");
}

/// A walk needs no portals: in one room it goes from place to place, and between given cells where they touch.
#[test]
fn a_table_without_portals_is_walked() {
    let folder = Folder::with_tower();
    folder.write("room.geojson", r#"{"type":"LineString","coordinates":[[-2,-2],[2,-2],[2,2],[-2,2],[-2,-2]]}"#);
    folder.run(&["build", "room.geojson", "-o", "room.pvs"]).expect(0);
    let reply = folder.run(&["walk", "room.pvs", "--random", "50", "--json"]).expect(0).json();
    assert_eq!((&reply["n_cells"], &reply["n_full"], &reply["n_outside"]), (&json!(1), &json!(50), &json!(0)));
    folder.run(&["build", "tower.glb", "--grid", "4,1,4", "--method", "shafts", "-o", "grid.pvs"]).expect(0);
    assert!(table(&folder, "grid.pvs").portals().is_empty());
    let reply = folder.run(&["walk", "grid.pvs", "--random", "400", "--json"]).expect(0).json();
    assert_eq!((&reply["n_full"], &reply["n_outside"]), (&json!(400), &json!(0)));
}
