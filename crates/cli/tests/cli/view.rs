//! Pages of tables: what is refused, what is left out. That they show what the tables say is tested in a browser.

use crate::common::Folder;
use serde_json::json;

#[test]
fn a_page_is_written_of_plain_and_packed_tables() {
    let folder = Folder::new();
    folder.run(&["demo", "--out", "."]).expect(0);
    folder.run(&["pack", "plan.pvs", "-o", "plan.pvz"]).expect(0);
    for table in ["plan.pvs", "plan.pvz"] {
        let command = ["view", table, "--title", "same", "--scene", "plan.geojson", "-o", "page.html", "--json"];
        let reply = folder.run(&command).expect(0).json();
        let page = folder.read("page.html");
        assert_eq!((&reply["n_bytes"], &reply["n_left_out"]), (&json!(page.len()), &json!(0)));
        // The shell with its scripts and style is small.
        assert!(page.len() < 800_000, "{} bytes", page.len());
        let text = String::from_utf8(page).expect("a text");
        assert!(text.starts_with("<!DOCTYPE html>") && text.contains("default-src 'none'"));
        assert!(!text.contains("src=\"") && !text.contains("href=\""), "nothing is fetched");
    }
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = Folder::new();
    folder.run(&["demo", "--out", "office"]).expect(0);
    folder.run(&["demo", "--out", "other", "--seed", "2"]).expect(0);
    folder.run(&["demo", "tower", "--out", "tower"]).expect(0);
    folder.run(&["generate", "tower", "--floors", "1", "-o", "small.glb"]).expect(0);
    std::fs::write(folder.path("walk.json"), r#"{"frames": [{"eye": [1, 2, 3], "dir": [0, 1]}]}"#).expect("a file");
    let cases: [(&[&str], &str); 8] = [
        (
            &["office/plan.pvs", "--scene", "other/plan.geojson"],
            "other/plan.geojson: the table was made of another scene: its lines",
        ),
        (&["office/plan.pvs", "--scene", "tower/tower.glb"], "the table is of a plan"),
        (&["tower/tower.pvs", "--scene", "office/plan.geojson"], "the table is of a scene in space"),
        (&["tower/tower.pvs", "--scene", "small.glb"], "small.glb: the table was made of another scene: it has"),
        (&["office/plan.pvs", "--against", "other/plan.pvs"], "cannot be compared"),
        (&["office/plan.pvs", "--walk", "walk.json"], "walk.json: frame 0: eye has 3 numbers"),
        (&["office/plan.geojson"], "not a table"),
        (&["office/plan.pvs", "--scene", "no.geojson"], "no.geojson"),
    ];
    for (words, expected) in cases {
        let error = folder.refused(&[&["view"], words, &["-o", "page.html"]].concat());
        assert!(error.contains(expected), "{words:?}: {error}");
        assert!(!folder.path("page.html").exists(), "nothing is left");
    }
    // A table that is cut short is named, with the place.
    let bytes = folder.read("office/plan.pvs");
    std::fs::write(folder.path("cut.pvs"), &bytes[..bytes.len() / 2]).expect("a file");
    assert!(folder.refused(&["view", "cut.pvs", "-o", "page.html"]).contains("cut.pvs: "));
}

#[test]
fn what_does_not_fit_is_left_out_and_said() {
    let folder = Folder::new();
    folder.run(&["generate", "tower", "--floors", "6", "-o", "t.glb"]).expect(0);
    folder.run(&["build", "t.glb", "-o", "t.pvs"]).expect(0);
    let view = |most: &str| {
        let command = ["view", "t.pvs", "--scene", "t.glb", "--max-mb", most, "-o", "page.html"];
        let text = folder.run(&command).expect(0).out;
        let json = folder.run(&[&command[..], &["--json"]].concat()).expect(0).json();
        (text, json["n_bytes"].as_u64().expect("a number"), json["n_left_out"].as_u64().expect("a number"))
    };
    let (all, n_bytes, n_left_out) = view("200");
    assert!(n_left_out == 0 && !all.contains("left out"), "{all}");
    assert!(n_bytes > 1_000_000, "{n_bytes} bytes do not fit into one megabyte");
    let (less, n_bytes, n_left_out) = view("1");
    assert!(n_left_out > 0 && n_bytes <= 1_000_000 && less.contains("smallest of"), "{less}, {n_bytes}");
    let page = String::from_utf8(folder.read("page.html")).expect("a text");
    assert!(page.contains("are left out of this page"));
}

#[test]
fn two_bakes_and_a_walk_are_on_the_page() {
    let folder = Folder::new();
    folder.run(&["demo", "--out", "."]).expect(0);
    std::fs::write(folder.path("walk.json"), r#"{"frames": [{"eye": [1, 2], "dir": [0, 1]}]}"#).expect("a file");
    folder.run(&["view", "plan.pvs", "--against", "plan.pvs", "--walk", "walk.json", "-o", "page.html"]).expect(0);
    let page = String::from_utf8(folder.read("page.html")).expect("a text");
    assert!(page.contains(r#"id="against""#) && page.contains(r#""walk":[{"eye":[1.0,2.0,0.0]"#));
}
