//! Pages of tables: what is refused, what is left out. That they show what the tables say is tested in a browser.

use crate::common::{Folder, maze_text, one_floor};
use serde_json::{Value, json};
use sightlines::cells::{Scene, SceneObject};
use sightlines::formats::scene::{parse_glb, read_scene, write_glb};
use sightlines_testkit::browser::{Opened, chromium};
use std::path::Path;

#[test]
fn a_page_is_written_of_plain_and_packed_tables() {
    let folder = Folder::with_office();
    folder.run(&["pack", "office.pvs", "-o", "office.pvz"]).expect(0);
    for table in ["office.pvs", "office.pvz"] {
        let command = ["view", table, "--title", "same", "--scene", "office.geojson", "-o", "page.html", "--json"];
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
    let (folder, office) = (Folder::with_tower(), Folder::with_office());
    for name in ["office.geojson", "office.pvs"] {
        folder.write(name, office.read(name));
    }
    folder.write("other.geojson", maze_text(1));
    folder.run(&["build", "other.geojson", "-o", "other.pvs"]).expect(0);
    folder.write("small.glb", one_floor(1, 0));
    folder.write("walk.json", r#"{"frames": [{"eye": [1, 2, 3], "dir": [0, 1]}]}"#);
    // As many objects, with the same names, and one that stands elsewhere.
    let mut objects = read_scene(folder.path("tower.glb")).expect("a scene").scene.objects().to_vec();
    objects.last_mut().expect("objects").vertices.iter_mut().for_each(|corner| corner[0] += 1.0);
    folder.write("moved.glb", write_glb(&Scene::new(objects).expect("a scene")).expect("single precision"));
    let cases: [(&[&str], &str); 9] = [
        (&["tower.pvs", "--scene", "moved.glb"], "moved.glb: the table was made of another scene: its triangles"),
        (&["office.pvs", "--scene", "other.geojson"], "other.geojson: the table was made of another scene: its lines"),
        (&["office.pvs", "--scene", "tower.glb"], "the table is of a plan"),
        (&["tower.pvs", "--scene", "office.geojson"], "the table is of a scene in space"),
        (&["tower.pvs", "--scene", "small.glb"], "small.glb: the table was made of another scene: it has"),
        (&["office.pvs", "--against", "other.pvs"], "cannot be compared"),
        (&["office.pvs", "--walk", "walk.json"], "walk.json: frame 0: eye has 3 numbers"),
        (&["office.geojson"], "not a table"),
        (&["office.pvs", "--scene", "no.geojson"], "no.geojson"),
    ];
    for (words, expected) in cases {
        let error = folder.refused(&[&["view"], words, &["-o", "page.html"]].concat());
        assert!(error.contains(expected), "{words:?}: {error}");
        assert!(!folder.path("page.html").exists(), "nothing is left");
    }
    // A table that is cut short is named, with the place.
    let bytes = folder.read("office.pvs");
    std::fs::write(folder.path("cut.pvs"), &bytes[..bytes.len() / 2]).expect("a file");
    assert!(folder.refused(&["view", "cut.pvs", "-o", "page.html"]).contains("cut.pvs: "));
}

/// A small tower, and heaps of small triangles in it: the table is as quick to make as that of the tower, and the page is large.
fn heaps() -> Vec<u8> {
    let tower = parse_glb(&one_floor(1, 0), None).expect("a scene").scene;
    let (mut objects, mut seed) = (tower.objects().to_vec(), 1_u64);
    let mut chance = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // Numbers of single precision, up to a tenth of a metre.
        f64::from((seed >> 48) as u16) / 1_048_576.0
    };
    for k in 0..64_u32 {
        let place = [1.0 + 0.125 * f64::from(k % 8), 0.5, 1.0 + 0.125 * f64::from(k / 8)];
        let vertices = (0..1500).map(|_| place.map(|x| x + chance())).collect();
        let triangles = (0..500).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        objects.push(SceneObject { name: format!("heap {k}"), vertices, triangles });
    }
    write_glb(&Scene::new(objects).expect("a scene")).expect("single precision")
}

#[test]
fn what_does_not_fit_is_left_out_and_said() {
    let folder = Folder::new();
    folder.write("t.glb", heaps());
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

/// The notice of a page, as its scripts read it.
fn notice(page: &str) -> Value {
    let (_, head) = page.split_once(r#"id="head">"#).expect("a head");
    let (head, _) = head.split_once("</script>").expect("an end");
    let head: Value = serde_json::from_str(head).expect("JSON");
    head["figure"]["notice"].clone()
}

/// A page draws both sides of faces, and tells so where the table is for engines of one kind, and the scene has faces of one side.
#[test]
fn pages_state_which_engines_the_table_is_for() {
    let folder = Folder::new();
    let scene = parse_glb(&one_floor(1, 0), None).expect("a scene").scene;
    let all = (0..scene.objects().len() as u32).collect();
    let two = Scene::new(scene.objects().to_vec()).expect("a scene");
    let one = two.clone().with_single_sided(all).expect("objects of the scene");
    folder.write("one.glb", write_glb(&one).expect("single precision"));
    folder.write("two.glb", write_glb(&two).expect("single precision"));
    let view = |scene: &str, backs: &[&str], more: &[&str]| {
        folder.run(&[&["build", scene, "-o", "t.pvs"], backs].concat()).expect(0);
        folder.run(&[&["view", "t.pvs", "-o", "page.html"], more].concat()).expect(0);
        String::from_utf8(folder.read("page.html")).expect("a text")
    };
    let (drawn, culled) = (&["--backs", "drawn"][..], &["--backs", "culled"][..]);
    for (backs, end) in [
        (drawn, "This page draws these backs; in an engine that does not, what is seen through them may be missing."),
        (culled, "This page draws the backs of what may be seen, and they cover what is seen through them."),
    ] {
        let page = view("one.glb", backs, &["--scene", "one.glb"]);
        let said = notice(&page);
        let said = said.as_str().expect("a text");
        let begin = format!("The table was built with {}, and the scene has single-sided faces: ", backs.join(" "));
        assert!(said.starts_with(&begin) && said.ends_with(end), "{said}");
        if let Some(browser) = chromium() {
            let script = "ready.then(() => tell(document.getElementById('notice').textContent))";
            let told =
                Opened { html: &page, script, given: &Value::Null, size: [1000, 700], link: "" }.result(&browser);
            assert_eq!(told, said);
        }
        // The twins: no such faces, and no triangles.
        assert_eq!(notice(&view("two.glb", backs, &["--scene", "two.glb"])), Value::Null);
        assert_eq!(notice(&view("one.glb", backs, &[])), Value::Null);
    }
    // And a table that is right for every engine.
    assert_eq!(notice(&view("one.glb", &[], &["--scene", "one.glb"])), Value::Null);
}

#[test]
fn two_bakes_and_a_walk_are_on_the_page() {
    let folder = Folder::with_office();
    std::fs::write(folder.path("walk.json"), r#"{"frames": [{"eye": [1, 2], "dir": [0, 1]}]}"#).expect("a file");
    folder.run(&["view", "office.pvs", "--against", "office.pvs", "--walk", "walk.json", "-o", "page.html"]).expect(0);
    let page = String::from_utf8(folder.read("page.html")).expect("a text");
    assert!(page.contains(r#"id="against""#) && page.contains(r#""walk":[{"eye":[1.0,2.0,0.0]"#));
}

/// Asks the page for the lines of some pairs that were looked for, and for the reasons of some hidden ones.
const LINES: &str = r#"
ready.then(({ model }) => {
  const { reasons } = model;
  const pick = (list) => list.filter((_, i) => i % Math.ceil(list.length / 25) === 0);
  const seen = pick(reasons.lines).map(({ cells }) => [cells[0], cells.at(-1)]);
  const lines = seen.map(([from, to]) => ({ pair: [from, to], back: reasons.line(to, from).cells, ...reasons.line(from, to) }));
  const hidden = pick([...reasons.hidden.keys()]).map((key) => ({ pair: key.split(",").map(Number), ...reasons.hidden.get(key) }));
  tell({ lines, hidden });
});"#;

/// Opens the page of a table and compares with `explain`; returns how many pairs were compared, seen and hidden.
fn compare_lines(folder: &Folder, browser: &Path, view: &[&str], table: &str) -> [usize; 2] {
    folder.run(&[&["view", table], view, &["-o", "page.html"]].concat()).expect(0);
    let html = String::from_utf8(folder.read("page.html")).expect("a text");
    let found = Opened { html: &html, script: LINES, given: &Value::Null, size: [1000, 700], link: "" }.result(browser);
    let list = |key: &str| found[key].as_array().expect("a list").clone();
    let explain = |pair: &Value, code: i32| {
        let [a, b] = [0, 1].map(|k| pair[k].to_string());
        folder.run(&["explain", table, &a, &b, "--json"]).expect(code).json()
    };
    let mut last = Value::Null;
    for line in list("lines") {
        let told = explain(&line["pair"], 0);
        // Clusters name portals and cells together.
        let together = |key: &str| {
            told["portals"]
                .as_array()
                .expect("portals")
                .iter()
                .map(|p| p.get(key).unwrap_or(p).clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(line["portals"], json!(together("portal")), "{line}");
        let entered = if told["cells"].is_array() { told["cells"].clone() } else { json!(together("cell")) };
        let cells = line["cells"].as_array().expect("cells");
        assert_eq!(json!(cells[1..]), entered);
        assert_eq!(line["back"], json!(cells.iter().rev().collect::<Vec<_>>()), "the way back");
        let points = if told["points"].is_array() { told["points"].clone() } else { json!(together("at")) };
        for (at, told) in line["points"].as_array().expect("points").iter().zip(points.as_array().expect("points")) {
            let far =
                |k: usize| at[k].as_f64().zip(told[k].as_f64()).map_or(0.0, |(a, b)| (a - b).abs() / (1.0 + b.abs()));
            assert!((0..3).all(|k| far(k) < 1e-9), "{at} and {told}");
        }
        // Other pairs have other lines: the comparison can fail.
        assert_ne!(line["cells"], last);
        last = line["cells"].clone();
    }
    for pair in list("hidden") {
        let told = explain(&pair["pair"], 1);
        assert_eq!(told["answer"], "hidden");
        let count = |value: &Value| value.as_array().map_or(0, Vec::len);
        match pair["kind"].as_str().expect("a kind") {
            "walls" => assert_eq!(count(&pair["walls"]), count(&told["walls"]).min(12)),
            "portals" => assert!(count(&pair["portals"]) > 0 && count(&told["blocked"]) > 0),
            kind => assert!(kind == "not connected" && count(&told["walls"]) + count(&told["blocked"]) == 0),
        }
    }
    [list("lines").len(), list("hidden").len()]
}

#[test]
fn lines_of_pages_are_those_of_explain() {
    let Some(browser) = chromium() else { return };
    let folder = Folder::new();
    folder.run(&["demo", "--out", "."]).expect(0);
    folder.run(&["generate", "tower", "--floors", "1", "-o", "t.glb"]).expect(0);
    folder.run(&["build", "t.glb", "-o", "t.pvs"]).expect(0);
    for (table, view) in [("plan.pvs", &[][..]), ("t.pvs", &["--scene", "t.glb", "--lines", "400"][..])] {
        let [n_seen, n_hidden] = compare_lines(&folder, &browser, view, table);
        assert!(n_seen >= 20 && n_hidden >= 20, "{n_seen} and {n_hidden}");
    }
    // Without lines the page still opens, and has none.
    folder.run(&["view", "plan.pvs", "--lines", "0", "-o", "page.html"]).expect(0);
    let html = String::from_utf8(folder.read("page.html")).expect("a text");
    let script = "ready.then((app) => { app.explain(0, 1); tell([app.model.reasons, document.getElementById('why-text').textContent]); })";
    let told = Opened { html: &html, script, given: &Value::Null, size: [1000, 700], link: "" }.result(&browser);
    assert!(
        told[0].is_null() && told[1].as_str().is_some_and(|text| text.contains("sightlines explain plan.pvs 0 1")),
        "{told}"
    );
}

#[test]
fn lines_of_pages_of_real_scenes_are_those_of_explain() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(std::path::PathBuf::from) else {
        eprintln!("SKIPPED lines_of_pages_of_real_scenes_are_those_of_explain: SIGHTLINES_DATA is not set");
        return;
    };
    let Some(browser) = chromium() else { return };
    let folder = Folder::new();
    for name in ["doom/freedoom1_E1M1.wad", "quake/e1m7.bsp", "scenes/whale_tall/whale_tall.glb"] {
        let scene = data.join(name).display().to_string();
        // A table does not tell which way walls of one side hide, so of pairs that these hide no reason is found.
        let drawn: &[&str] = if scene.ends_with(".glb") { &["--backs", "drawn"] } else { &[] };
        folder.run(&[&["build", &scene, "-o", "r.pvs"], drawn].concat()).expect(0);
        let [n_seen, n_hidden] = compare_lines(&folder, &browser, &["--lines", "400"], "r.pvs");
        assert!(n_seen >= 15 && n_hidden > 0, "{name}: {n_seen} and {n_hidden}");
    }
}
