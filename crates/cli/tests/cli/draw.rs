//! `draw --eye` shows the set that `query` lists: the cells of each colour are read back from the picture.

use crate::common::quake::row_of_leafs;
use crate::common::{Folder, Run};
use serde_json::{Value, json};
use sightlines::formats::quake::BspFormat;
use std::path::PathBuf;

const SEEN: &str = "#8fc4f5";
const SEEN_BY_CELL: &str = "#cfe4fa";
const FROM: &str = "#f0701a";
const HIDDEN: &str = "#eceef1";

type Polygon = Vec<[f64; 2]>;

/// The polygons of the first path that is filled with a colour, in pixels.
fn filled(svg: &str, colour: &str) -> Vec<Polygon> {
    let end = format!("\" fill=\"{colour}\"/>");
    let line = svg.lines().find(|line| line.starts_with("<path") && line.ends_with(&end));
    let Some(path) = line.and_then(|line| line.strip_prefix("<path d=\"")?.strip_suffix(&end)) else {
        return Vec::new();
    };
    // A legend has boxes of its own colours.
    if path.contains('H') {
        return Vec::new();
    }
    let point = |text: &str| {
        let (x, y) = text.split_once(' ').expect("two coordinates");
        [x, y].map(|x| x.parse().expect("a number"))
    };
    path.split_terminator('Z').map(|polygon| polygon.split(['M', 'L']).skip(1).map(point).collect()).collect()
}

fn bounds(polygons: &[Polygon]) -> [[f64; 2]; 2] {
    polygons.iter().flatten().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// A picture of a table, and where its cells are according to the export.
struct Read {
    /// By cell; in space those that the plane cuts.
    cells: Vec<Option<Polygon>>,
}

impl Read {
    /// From the export of a table; a table in space has y up and is cut at `height`.
    fn new(export: &Value, height: f64) -> Self {
        let number = |v: &Value| v.as_f64().expect("a number");
        let list = |v: &Value| -> Vec<f64> { v.as_array().expect("a list").iter().map(number).collect() };
        let up = export["up"].as_str().map_or(1, |up| "xyz".find(up).expect("an axis"));
        let cell = |cell: &Value| {
            if export["dimension"] == 2 {
                let points = cell["polygon"].as_array().expect("corners").iter();
                return Some(points.map(|p| [number(&p[0]), number(&p[1])]).collect());
            }
            let (min, max) = (list(&cell["min"]), list(&cell["max"]));
            let on_floor = |p: [f64; 3]| if up == 1 { [p[0], -p[2]] } else { [p[0], p[1]] };
            let [a, b] = [[min[0], min[1], min[2]], [max[0], max[1], max[2]]].map(on_floor);
            let box_ = vec![[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]]];
            (min[up] <= height && height < max[up]).then_some(box_)
        };
        Self { cells: export["cells"].as_array().expect("cells").iter().map(cell).collect() }
    }

    /// Whether the polygons that are filled with a colour are those of the cells, no more and no less.
    fn shows(&self, svg: &str, colour: &str, ids: &[u64]) -> bool {
        let all: Vec<Polygon> = self.cells.iter().flatten().cloned().collect();
        let [low, high] = bounds(&all);
        let [left_top, right_bottom] = bounds(&filled(svg, HIDDEN));
        let scale = |k: usize| (right_bottom[k] - left_top[k]) / (high[k] - low[k]);
        let place =
            |p: &[f64; 2]| [left_top[0] + (p[0] - low[0]) * scale(0), left_top[1] + (high[1] - p[1]) * scale(1)];
        let mut drawn = filled(svg, colour);
        let expected = ids.iter().filter_map(|&id| self.cells[id as usize].as_ref());
        let expected: Vec<Polygon> = expected.map(|polygon| polygon.iter().map(place).collect()).collect();
        let n_expected = expected.len();
        let found = expected.into_iter().filter(|polygon| {
            // Pixels are rounded to hundredths; the first corner may be another one.
            let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs() < 0.03 && (a[1] - b[1]).abs() < 0.03;
            let covers = |a: &Polygon, b: &Polygon| a.iter().all(|p| b.iter().any(|q| near(p, q)));
            let same = drawn.iter().position(|d| d.len() == polygon.len() && covers(d, polygon) && covers(polygon, d));
            same.map(|i| drawn.swap_remove(i)).is_some()
        });
        found.count() == n_expected && drawn.is_empty()
    }
}

/// Numbers from 0 to 1 in a fixed order.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn ids(value: &Value) -> Vec<u64> {
    value.as_array().expect("a list").iter().map(|id| id.as_u64().expect("an id")).collect()
}

/// What was compared: eyes, and of these those that see less than their cell.
#[derive(Default, Debug)]
struct Counts {
    eyes: usize,
    narrower: usize,
}

/// Compares pictures of random eyes in a table with what `query` lists, by every method in turn, with and without a direction.
fn compare(folder: &Folder, table: &str, n_eyes: usize) -> Counts {
    folder.run(&["export", table, "-o", "export.json"]).expect(0);
    let export: Value = serde_json::from_slice(&folder.read("export.json")).expect("JSON");
    let n_dimensions = export["dimension"].as_u64().expect("a number") as usize;
    let up = export["up"].as_str().map_or(1, |up| "xyz".find(up).expect("an axis"));
    let cells = export["cells"].as_array().expect("cells");
    let (mut numbers, mut counts) = (Numbers(7), Counts::default());
    for k in 0..n_eyes {
        let cell = &cells[(numbers.next() * cells.len() as f64) as usize];
        let eye: Vec<f64> = (0..n_dimensions)
            .map(|axis| {
                let [low, high] = ["min", "max"].map(|end| cell[end][axis].as_f64().expect("a number"));
                low + (high - low) * numbers.next()
            })
            .collect();
        let text = eye.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let eye_option = format!("--eye={text}");
        let dir: Vec<String> = (0..n_dimensions).map(|_| (numbers.next() - 0.5).to_string()).collect();
        let dir = format!("--dir={}", dir.join(","));
        let method =
            ["exact", "exact", "incident-portals", "connected-component", "disjoint-cell", "cell-to-cell"][k % 6];
        let mut options = vec![eye_option.as_str(), "--method", method];
        if k % 3 > 0 {
            options.extend([dir.as_str(), "--fov", ["40", "75", "120"][k / 6 % 3]]);
        }
        let query = folder.run(&[&["query", table, "--json"][..], &options].concat());
        let drawn = folder.run(&[&["draw", table, "-o", "eye.svg"][..], &options].concat());
        assert_eq!(query.code, drawn.code, "{options:?}: {} {}", query.err, drawn.err);
        if query.code == 1 {
            continue;
        }
        let svg = String::from_utf8(folder.read("eye.svg")).expect("text");
        let of_cell = folder.run(&["query", table, "--json", &eye_option]).expect(0).json();
        let [visible, by_cell] = [&query.json()["visible"], &of_cell["visible"]].map(ids);
        let elsewhere: Vec<u64> = by_cell.iter().copied().filter(|id| !visible.contains(id)).collect();
        let read = Read::new(&export, *eye.get(up).unwrap_or(&0.0));
        assert!(read.shows(&svg, SEEN, &visible), "{options:?}");
        assert!(read.shows(&svg, SEEN_BY_CELL, &elsewhere), "{options:?}");
        assert!(read.shows(&svg, FROM, &ids(&of_cell["cells"])), "{options:?}");
        counts.eyes += 1;
        // The impostor: the picture of the cell's set, where that is another one at this height.
        if elsewhere.iter().any(|&id| read.cells[id as usize].is_some()) {
            counts.narrower += 1;
            assert!(!read.shows(&svg, SEEN, &by_cell), "{options:?}");
        }
    }
    counts
}

#[test]
fn a_viewer_in_a_plan_is_drawn_as_queried() {
    let counts = compare(&Folder::with_office(), "office.pvs", 36);
    assert!(counts.eyes > 25 && counts.narrower > 10, "{counts:?}");
}

#[test]
fn a_viewer_in_a_doom_map_is_drawn_as_queried() {
    let folder = Folder::with_wad();
    folder.run(&["build", "maps.wad", "--map", "MAP01", "-o", "map.pvs"]).expect(0);
    let counts = compare(&folder, "map.pvs", 36);
    assert!(counts.eyes > 20 && counts.narrower > 5, "{counts:?}");
}

#[test]
fn a_viewer_in_a_building_is_drawn_as_queried() {
    let counts = compare(&Folder::with_tower(), "tower.pvs", 36);
    assert!(counts.eyes > 25 && counts.narrower > 10, "{counts:?}");
}

/// Of maps and buildings that were made by others.
#[test]
fn a_viewer_in_real_scenes_is_drawn_as_queried() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from) else {
        eprintln!("SKIPPED a_viewer_in_real_scenes_is_drawn_as_queried: SIGHTLINES_DATA is not set");
        return;
    };
    let folder = Folder::new();
    for input in ["doom/freedm_MAP01.wad", "plans/mlstruct_fp_test_0.geojson", "scenes/whale_tall/whale_tall.glb"] {
        folder.run(&["build", &data.join(input).display().to_string(), "-o", "real.pvs"]).expect(0);
        let counts = compare(&folder, "real.pvs", 60);
        assert!(counts.eyes > 30 && counts.narrower > 5, "{input}: {counts:?}");
    }
}

/// The plan of the guide: from the point two of the three rooms are seen, from its room all three.
#[test]
fn the_plan_of_the_guide_shows_two_rooms() {
    let folder = Folder::new();
    let rooms = json!([
        [[0, 0], [12, 0], [12, 6], [0, 6], [0, 0]],
        [[4, 0], [4, 2]],
        [[4, 3], [4, 6]],
        [[8, 0], [8, 4]],
        [[8, 5], [8, 6]]
    ]);
    let plan =
        json!({"type": "Feature", "properties": {}, "geometry": {"type": "MultiLineString", "coordinates": rooms}});
    folder.write("plan.geojson", plan.to_string());
    folder.run(&["build", "plan.geojson", "-o", "plan.pvs"]).expect(0);
    folder.run(&["draw", "plan.pvs", "--eye", "1,2.5", "-o", "plan.svg"]).expect(0);
    let svg = String::from_utf8(folder.read("plan.svg")).expect("text");
    assert_eq!([SEEN, SEEN_BY_CELL, FROM].map(|colour| filled(&svg, colour).len()), [2, 1, 1]);
    folder.run(&["draw", "plan.pvs", "--cell", "0", "-o", "cell.svg"]).expect(0);
    let svg = String::from_utf8(folder.read("cell.svg")).expect("text");
    assert_eq!([SEEN, SEEN_BY_CELL].map(|colour| filled(&svg, colour).len()), [3, 0]);
}

#[test]
fn all_methods_are_drawn_side_by_side() {
    let folder = Folder::with_office();
    let args =
        ["draw", "office.pvs", "--eye", "3,3", "--dir", "1,0", "--method", "all", "--size", "400", "-o", "all.svg"];
    folder.run(&args).expect(0);
    let svg = String::from_utf8(folder.read("all.svg")).expect("text");
    for method in ["cell-to-cell", "disjoint-cell", "connected-component", "incident-portals", "exact"] {
        assert!(svg.contains(&format!("<title>{method}: ")), "{method}");
    }
    assert_eq!(svg.matches("<title>scale: ").count(), 1);
}

#[test]
fn a_door_that_is_shut_narrows_what_is_drawn() {
    let (folder, map) = (Folder::new(), row_of_leafs(BspFormat::Bsp29));
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    folder.run(&["build", "map.bsp", "-o", "map.pvs"]).expect(0);
    let draw = |options: &[&str]| -> Run {
        folder.run(&[&["draw", "map.pvs", "--eye", "70,50,50", "-o", "map.svg"][..], options].concat()).expect(0)
    };
    let n_seen = |options: &[&str]| {
        draw(options);
        filled(&String::from_utf8(folder.read("map.svg")).expect("text"), SEEN).len()
    };
    assert!(n_seen(&["--closed", "0"]) < n_seen(&[]));
}

#[test]
fn options_of_a_view_need_an_eye() {
    let folder = Folder::with_office();
    let refused = |args: &[&str]| folder.refused(&[&["draw", "office.pvs", "-o", "out.svg"][..], args].concat());
    for (option, value) in [("--dir", "1,0"), ("--method", "all"), ("--closed", "0")] {
        assert_eq!(refused(&["--cell", "0", option, value]), format!("{option} is of a viewer: give --eye"));
    }
    assert_eq!(refused(&["--fov", "60"]), "--fov or --aspect is of a viewer: give --eye");
    let error = refused(&["--eye", "3,3", "--fov", "60"]);
    assert_eq!(error, "--fov and --aspect need --dir: without it the viewer looks all round");
    assert_eq!(refused(&["--eye", "3,3", "--closed", "9999"]).split(": there is").next(), Some("office.pvs"));
    assert!(refused(&["--eye", "3,3", "--dir", "0,0"]).starts_with("--dir: "));
    assert!(!folder.path("out.svg").exists());
}

/// Where ends of walls were joined, and where they nearly meet others; of the same plan without a gap, and of another one.
#[test]
fn joints_of_a_plan_are_drawn() {
    let folder = Folder::new();
    let wall = |ends: [[f64; 2]; 2]| json!({"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": ends}});
    let room = [[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [0.0, 6.0], [0.0, 0.0]];
    let mut lines: Vec<Value> = room.windows(2).map(|ends| wall([ends[0], ends[1]])).collect();
    lines.extend([wall([[4.0, 0.001], [4.0, 2.0]]), wall([[7.0, 5.995], [7.0, 4.0]])]);
    folder.write("plan.geojson", json!({"type": "FeatureCollection", "features": lines}).to_string());
    let rings = |gap: &str| {
        let run = folder.run(&["build", "plan.geojson", "--gap", gap, "-o", "plan.pvs"]).expect(0);
        folder.run(&["draw", "plan.pvs", "--joints", "plan.geojson", "-o", "plan.svg"]).expect(0);
        let svg = String::from_utf8(folder.read("plan.svg")).expect("text");
        let is_said = run.err.contains("`draw --joints` shows where they are");
        (svg.matches("<circle").count(), ["are joined", "nearly meet"].map(|words| svg.contains(words)), is_said)
    };
    // A ring is two circles, and the legend has a dot for each kind.
    assert_eq!(rings("0.002"), (6, [true, true], true));
    assert_eq!(rings("0.006"), (5, [true, false], false));
    let (_, words, _) = rings("0");
    assert!(!words[0]);
    folder.write("other.geojson", json!({"type": "FeatureCollection", "features": lines[..5]}).to_string());
    let error = folder.refused(&["draw", "plan.pvs", "--joints", "other.geojson", "-o", "out.svg"]);
    assert!(error.contains("its lines differ from those of this file"), "{error}");
    folder.run(&["draw", "plan.pvs", "-o", "plain.svg"]).expect(0);
    assert!(!String::from_utf8(folder.read("plain.svg")).expect("text").contains("<circle"));
    let tower = Folder::with_tower();
    let error = tower.refused(&["draw", "tower.pvs", "--joints", "tower.glb", "-o", "out.svg"]);
    assert!(error.contains("--joints"), "{error}");
}
