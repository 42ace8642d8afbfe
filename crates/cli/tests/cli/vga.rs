//! `vga`: tables have a row for each point, pictures show what tables hold, and what cannot be analysed is refused in one line.

use crate::common::Folder;
use serde_json::Value;

/// Three rooms in a row with doors between them.
const ROOMS: &str = r#"{"type": "MultiLineString", "coordinates": [
    [[0, 0], [12, 0], [12, 6], [0, 6], [0, 0]], [[4, 0], [4, 2]], [[4, 3], [4, 6]], [[8, 0], [8, 4]], [[8, 5], [8, 6]]]}"#;

fn with_rooms() -> Folder {
    let folder = Folder::new();
    folder.write("rooms.geojson", ROOMS);
    folder
}

/// The header and the rows of a CSV file.
fn table(folder: &Folder, name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = String::from_utf8(folder.read(name)).expect("text");
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',').map(str::to_owned).collect();
    (header, lines.map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect())
}

#[test]
fn tables_have_all_points_and_measures() {
    let folder = with_rooms();
    let args = ["vga", "rooms.geojson", "--spacing", "0.5", "--measures", "all", "-o", "all.csv", "--json"];
    let reply = folder.run(&args).expect(0).json();
    let (header, rows) = table(&folder, "all.csv");
    assert_eq!((header.len(), &header[..4]), (23, &["x", "y", "index", "connectivity"].map(str::to_owned)[..]));
    assert_eq!(rows.len() as u64, reply["n_points"].as_u64().expect("a number"));
    // Whole numbers of spacings inside, without those on walls.
    assert_eq!(rows.len(), 23 * 11 - (4 + 6) - (8 + 2));
    let column = |name: &str| header.iter().position(|other| other == name).expect(name);
    assert!(rows.iter().enumerate().all(|(k, row)| row.len() == header.len() && row[2] == k as f64));
    assert!(rows.iter().all(|row| row[column("node-count")] == rows.len() as f64));
    let pairs: f64 = rows.iter().map(|row| row[column("connectivity")]).sum();
    assert_eq!(Some(pairs as u64 / 2), reply["n_visible_pairs"].as_u64());
    // The middle room is nearer to all than the others.
    let mean = |low: f64, high: f64| {
        let depths: Vec<f64> =
            rows.iter().filter(|row| low < row[0] && row[0] < high).map(|row| row[column("mean-depth")]).collect();
        depths.iter().sum::<f64>() / depths.len() as f64
    };
    assert!(mean(4.0, 8.0) < mean(0.0, 4.0) && mean(4.0, 8.0) < mean(8.0, 12.0));

    // The same points as GeoJSON, with any number of threads.
    let args = ["vga", "rooms.geojson", "--spacing", "0.5", "--measures", "all", "-o", "all.geojson", "--threads", "1"];
    folder.run(&args).expect(0);
    let json: Value = serde_json::from_slice(&folder.read("all.geojson")).expect("JSON");
    for (feature, row) in json["features"].as_array().expect("features").iter().zip(&rows) {
        for (k, name) in header.iter().enumerate().skip(2) {
            let value = feature["properties"][name].as_f64().unwrap_or(-1.0);
            assert_eq!(value, row[k], "{name}");
        }
    }
}

#[test]
fn seeds_points_and_names_choose() {
    let folder = with_rooms();
    let run = |args: &[&str]| {
        let all = [&["vga", "rooms.geojson", "-o", "out.csv", "--json"][..], args].concat();
        (folder.run(&all).expect(0).json(), table(&folder, "out.csv"))
    };
    let (all, _) = run(&["--spacing", "0.5"]);
    let (seeded, (header, _)) = run(&["--spacing", "0.5", "--seed", "1,1", "--measures", "control,entropy"]);
    assert_eq!(all["n_points"], seeded["n_points"]);
    assert_eq!(header[3..], ["control", "entropy"].map(str::to_owned));
    folder.write("points.csv", "x,y\n1,1\n2,5\n11,1\n");
    let (of_file, (_, rows)) = run(&["--points", "points.csv"]);
    assert_eq!((rows.len(), rows[2][0], &of_file["grid"]), (3, 11.0, &Value::Null));
    assert_eq!(rows[0][3], 1.0, "two in one room, and one far away");
    // A line of sight along a wall: blocked, unless walls may be touched.
    folder.write("along.csv", "0,1\n0,5\n");
    let seen = |touch: &str| run(&["--points", "along.csv", "--touch", touch]).1.1[0][3];
    assert_eq!([seen("blocks"), seen("passes")], [0.0, 1.0]);
}

#[test]
fn pictures_are_of_one_measure() {
    let folder = with_rooms();
    let draw = |name: &str, measure: &str| {
        let args =
            ["vga", "rooms.geojson", "--spacing", "0.5", "--measure", measure, "-o", name, "--size", "300", "--json"];
        folder.run(&args).expect(0).json()
    };
    let reply = draw("depth.svg", "mean-depth");
    assert_eq!((reply["drawn"].as_str(), reply["measures"].as_array().map(Vec::len)), (Some("mean-depth"), Some(1)));
    let svg = String::from_utf8(folder.read("depth.svg")).expect("text");
    assert!(svg.contains("Visual Mean Depth, in steps") && svg.contains("class=\"walls\""));
    draw("depth.png", "mean-depth");
    let png = folder.read("depth.png");
    draw("depth.png", "control");
    assert!(png.starts_with(b"\x89PNG") && png != folder.read("depth.png"), "another measure is another picture");
}

#[test]
fn what_cannot_be_analysed_is_refused() {
    let folder = with_rooms();
    folder.write("open.geojson", r#"{"type": "LineString", "coordinates": [[0, 0], [4, 1]]}"#);
    folder.write("hall.obj", "o hall\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("bad.csv", "x,y\n1,2\n1,none\n");
    folder.write("none.csv", "x,y\n");
    folder.write("nan.csv", "1,NaN\n");
    let refused = |args: &[&str]| folder.refused(&[&["vga"][..], args].concat());
    for (args, error) in [
        (
            &["rooms.geojson", "--spacing", "0", "-o", "o.csv"][..],
            "rooms.geojson: a spacing of 0 is no positive number",
        ),
        (
            &["rooms.geojson", "--spacing", "1", "--seed", "99,1", "-o", "o.csv"],
            "rooms.geojson: the seed (99, 1) lies outside the grid",
        ),
        (
            &["rooms.geojson", "--spacing", "1", "-o", "o.txt"],
            "o.txt: the name of the output ends in .csv, .geojson, .svg or .png",
        ),
        (
            &["rooms.geojson", "--spacing", "1", "--measure", "control", "-o", "o.csv"],
            "o.csv: --measure is for pictures",
        ),
        (&["rooms.geojson", "--points", "bad.csv", "-o", "o.csv"], "bad.csv: line 3 column 3: 'none' is not a number"),
        (
            &["rooms.geojson", "--points", "none.csv", "-o", "o.csv"],
            "none.csv: line 1 column 1: there are no points in the file",
        ),
        (&["rooms.geojson", "--points", "nan.csv", "-o", "o.csv"], "nan.csv: line 1 column 3: "),
        (&["rooms.geojson", "--points", "lost.csv", "-o", "o.csv"], "lost.csv: "),
        (&["rooms.geojson", "--points", "bad.csv", "-o", "o.svg"], "o.svg: a picture of points needs --spacing"),
        (&["open.geojson", "--spacing", "1", "-o", "o.csv"], "open.geojson: no pixel is enclosed"),
        (&["bad.csv", "--spacing", "1", "-o", "o.csv"], "bad.csv: neither a plan nor a WAD"),
        (
            &["hall.obj", "--spacing", "1", "-o", "o.csv"],
            "hall.obj: is a scene in space, not a plan: cut one first: sightlines plan hall.obj --height H -o hall.geojson",
        ),
    ] {
        let found = refused(args);
        assert!(found.starts_with(error), "{args:?}: {found}");
    }
    folder.run(&["vga", "rooms.geojson", "-o", "o.csv"]).expect(2);
    folder.run(&["vga", "rooms.geojson", "--spacing", "1", "--measures", "guess", "-o", "o.csv"]).expect(2);
    assert!(!folder.path("o.csv").exists() && !folder.path("o.svg").exists());
}

/// A map of a WAD is a plan, too.
#[test]
fn maps_are_plans() {
    let folder = Folder::with_wad();
    let args = ["vga", "maps.wad", "--map", "MAP01", "--spacing", "64", "-o", "map.csv", "--json"];
    let reply = folder.run(&args).expect(0).json();
    assert!(reply["n_points"].as_u64() > Some(10), "{reply}");
    assert!(folder.refused(&["vga", "maps.wad", "--spacing", "64", "-o", "map.csv"]).contains("choose one with --map"));
}

/// Killed as soon as there are results, and taken up, an analysis ends with the bytes of one that was left alone.
#[test]
fn an_analysis_goes_on_where_it_was_killed() {
    let folder = with_rooms();
    let args = ["vga", "rooms.geojson", "--spacing", "0.12", "--measures", "global", "-q", "--save-after", "0"];
    let with = |out: &'static str, more: &[&'static str]| [&args[..], &["-o", out], more].concat();
    folder.run(&with("whole.csv", &[])).expect(0);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_sightlines"))
        .args(with("out.csv", &[]))
        .current_dir(folder.path("."))
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("the program was built");
    let state = folder.path("out.csv.state");
    // A header alone is less.
    while std::fs::metadata(&state).map_or(0, |state| state.len()) < 2000 {
        assert!(child.try_wait().expect("a child").is_none(), "it was over before it could be killed");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().expect("a child can be killed");
    child.wait().expect("a child ends");
    assert!(!folder.path("out.csv").exists() && state.exists());
    let other = folder.refused(&[&with("out.csv", &["--resume"])[..], &["--radius", "2"]].concat());
    assert!(other.starts_with("out.csv.state: "), "{other}");
    folder.run(&with("out.csv", &["--resume"])).expect(0);
    assert!(folder.read("out.csv") == folder.read("whole.csv") && !state.exists());
}
