//! A thousand siblings each of small files that readers once refused or read in part: what is left of a damaged file is the file without the damage.

use crate::common::dxf::Dxf;
use crate::common::glb::glb;
use crate::common::udmf;
use serde_json::{Map, Value, json};
use sightlines_formats::doom::RmbFile;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::geojson::parse_plan_file;
use sightlines_formats::input::Neighbours;
use sightlines_formats::points::parse_points;
use sightlines_formats::quake::overrides::parse_overrides;
use sightlines_formats::scene::{SceneReadOptions, parse_glb, parse_obj, parse_obj_with};
use sightlines_formats::{PlanReadOptions, SceneFile};
use sightlines_geometry::Random;
use sightlines_testkit::siblings;
use std::io;
use std::path::Path;

fn pick<'a, T>(random: &mut Random, of: &'a [T]) -> &'a T {
    &of[random.below(of.len())]
}

/// An OBJ, line by line; `n` is the number of its corners, the first four of which are a square. Some face has an area.
struct Obj {
    lines: Vec<String>,
    n: usize,
}

impl Obj {
    fn any(random: &mut Random) -> Self {
        let mut lines: Vec<String> =
            ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "f 1 2 3"].map(str::to_owned).to_vec();
        let mut n = 4;
        for _ in 0..3 + random.below(12) {
            let line = match random.below(8) {
                0 | 1 => {
                    n += 1;
                    let [x, y, z] = [(); 3].map(|()| random.below(9) as f64 / 4.0);
                    format!("v {x} {y} {z}")
                }
                2 => format!("o part {}", random.below(4)),
                3 => format!("usemtl m{}", random.below(3)),
                4 => (*pick(random, &["# f 1 2", "vt 0 0", "s off", "", "l 1 2", "g x"])).to_owned(),
                5 => "f 1 \\\n 2 4".to_owned(),
                6 => "f 1/1 2/1/1 3//1 4".to_owned(),
                _ => {
                    let corner = || -1 - random.below(n) as i64;
                    let [a, b, c] = [(); 3].map({
                        let mut corner = corner;
                        move |()| corner()
                    });
                    format!("f {a} {b} {c}")
                }
            };
            lines.push(line);
        }
        Self { lines, n }
    }

    /// The line of the text at which the `k`-th of these begins, from 1.
    fn line_of(&self, k: usize) -> usize {
        1 + self.lines[..k].iter().map(|line| line.matches('\n').count() + 1).sum::<usize>()
    }

    fn text(&self) -> String {
        self.lines.join("\n")
    }

    fn with(&self, k: usize, line: &str) -> Self {
        let mut lines = self.lines.clone();
        lines.insert(k, line.to_owned());
        Self { lines, n: self.n }
    }
}

fn read(text: &str) -> SceneFile {
    parse_obj(text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// A face that is none, somewhere in a file: the scene is that of the file without it, and the warning has its line. The twin is a face at that place,
/// which is there; the impostor is a reader that stops there.
#[test]
fn what_is_left_without_a_bad_face_is_the_file_without_it() {
    let (mut n, mut n_stopped) = (0, 0);
    for seed in siblings() {
        let mut random = Random::new(seed);
        let obj = Obj::any(&mut random);
        let expected = read(&obj.text());
        let far = obj.n + 1 + random.below(99);
        let bad = [
            "f 1 2".to_owned(),
            "f".to_owned(),
            "f 0 1 2".to_owned(),
            "f 1 2 x".to_owned(),
            "f 1 /2 3".to_owned(),
            "f 1 2 3.5".to_owned(),
            format!("f 1 2 {far}"),
            format!("f {far}/1 2 1 3"),
            format!("f 1 2 -{far}"),
        ];
        let (bad, at) = (pick(&mut random, &bad), random.below(obj.lines.len() + 1));
        let text = obj.with(at, bad).text();
        let file = read(&text);
        assert_eq!(file.scene, expected.scene, "{seed}: {text}");
        let line = format!("left out 1 face: line {}: ", obj.line_of(at));
        let more: Vec<&String> = file.info.warnings.iter().filter(|w| w.starts_with("left out")).collect();
        assert!(more.len() == 1 && more[0].starts_with(&line), "{seed}: {line} {more:?} {text}");
        // Behind its corners, which begin the file.
        let good = obj.with(at.max(4), "f 1 3 4").text();
        assert_eq!(n_triangles(&read(&good)), n_triangles(&expected) + 1, "{seed}");
        let stopped = parse_obj(obj.lines[..at].join("\n").as_bytes());
        n_stopped += usize::from(stopped.map_or(true, |stopped| stopped.scene != expected.scene));
        n += 1;
    }
    assert!(n == siblings().len() && 2 * n_stopped > n, "{n_stopped} of {n}");
}

fn n_triangles(file: &SceneFile) -> usize {
    file.scene.objects().iter().map(|object| object.triangles.len()).sum()
}

/// The name of an object, its triangles as corners, and whether it hides.
type Shown = (String, Vec<[[f64; 3]; 3]>, bool);

fn shown(file: &SceneFile) -> Vec<Shown> {
    let objects = (0..).zip(file.scene.objects());
    let corners = |k, o: &sightlines_cells::SceneObject| {
        let triangles = o.triangles.iter().map(|t| t.map(|v| o.vertices[v as usize])).collect();
        (o.name.clone(), triangles, file.scene.is_opaque(k))
    };
    objects.map(|(k, o)| corners(k, o)).collect()
}

/// A face whose outline crosses itself, somewhere in a file, is seen and hides nothing; all else hides as without it. The twin is the same face with its
/// corners in order; the impostor takes the bow for a wall.
#[test]
fn bows_take_nothing_from_the_walls_beside_them() {
    let (mut n, mut n_split) = (0, 0);
    for seed in siblings() {
        let mut random = Random::new(seed);
        let mut obj = Obj::any(&mut random);
        obj.lines.retain(|line| !line.starts_with("usemtl"));
        let expected = shown(&read(&obj.text()));
        let at = 4 + random.below(obj.lines.len() - 3);
        let bow = *pick(&mut random, &["f 1 3 2 4", "f 3 1 2 4", "f 1 2 4 3", "f 2 1 3 4"]);
        let file = read(&obj.with(at, bow).text());
        let line = format!("1 face hides nothing: line {}: the outline of the face crosses itself", obj.line_of(at));
        assert!(file.info.warnings.contains(&line), "{seed}: {line} {:?}", file.info.warnings);
        let (bows, walls): (Vec<_>, Vec<_>) = shown(&file).into_iter().partition(|(_, _, hides)| !hides);
        // An object that has no name is called by its number, which the bow may change.
        let triangles = |of: &[Shown]| of.iter().map(|(_, t, _)| t.clone()).collect::<Vec<_>>();
        assert_eq!(triangles(&walls), triangles(&expected), "{seed}");
        assert!(bows.len() == 1 && bows[0].1.len() == 4, "{seed}: {bows:?}");
        n_split += usize::from(bows[0].0.ends_with("#see-through"));
        let twin = read(&obj.with(at, "f 1 2 3 4").text());
        assert!(twin.scene.see_through().is_empty() && n_triangles(&twin) == 2 + n_triangles(&read(&obj.text())));
        n += 1;
    }
    assert!(n == siblings().len() && 4 * n_split > n, "{n_split} of {n}");
}

/// The text with ends of lines of one system, or now and then of several.
fn with_ends(random: &mut Random, text: &str) -> String {
    let end = *pick(random, &["\r", "\r\n", ""]);
    let mut lines = text.split('\n');
    let first = lines.next().expect("a line").to_owned();
    lines.fold(first, |text, line| {
        let any = *pick(random, &["\n", "\r\n", "\r"]);
        // A lone CR before a lone LF would be one end.
        let any = if text.ends_with('\r') && any == "\n" { "\r\n" } else { any };
        text + if end.is_empty() { any } else { end } + line
    })
}

/// Texts say the same whatever ends their lines. The twin is LF; the impostor ends lines at LF only.
#[test]
fn lines_end_as_on_any_system() {
    let (mut n, mut n_lost) = (0, 0);
    for seed in siblings() {
        let mut random = Random::new(seed);
        let obj = Obj::any(&mut random);
        let text = obj.with(random.below(obj.lines.len()), "f 1 2").text();
        let ended = with_ends(&mut random, &text);
        assert_eq!(parse_obj(ended.as_bytes()), parse_obj(text.as_bytes()), "{seed}: {ended:?}");
        n_lost += usize::from(parse_obj(text.replace('\n', " ").as_bytes()) != parse_obj(text.as_bytes()));
        // A library.
        let library = format!("# x\nnewmtl m0\nKd 1 1 1\nd {}\nnewmtl m1\nillum 2\n", random.below(2));
        let text = format!("mtllib a.mtl\nusemtl m1\n{text}");
        let with = |library: String| {
            let beside = Beside(vec![("a.mtl".to_owned(), library)]);
            parse_obj_with(text.as_bytes(), Some(&beside), &SceneReadOptions::default())
        };
        assert_eq!(with(with_ends(&mut random, &library)), with(library), "{seed}");
        // Points, wishes of leafs, options of REJECT builders.
        let rows = (0..1 + random.below(5)).map(|k| format!("{k},{},p{k}\n", random.below(9)));
        let text: String = ["# points\nx,y,name\n".to_owned()].into_iter().chain(rows).collect();
        assert_eq!(parse_points(with_ends(&mut random, &text).as_bytes()), parse_points(text.as_bytes()), "{seed}");
        let text = format!("# wishes\nshow 1 {}\n\nhide 2 3 # x\nshow 4 5", random.below(9));
        let ended = with_ends(&mut random, &text);
        assert_eq!(parse_overrides(ended.as_bytes()), parse_overrides(text.as_bytes()), "{seed}");
        let text = format!("# options\nBLIND 0 ({})\nINCLUDE 1 2 # x\n\nMAP01\nSAFE 1 3\n", random.below(4));
        assert_eq!(RmbFile::parse(with_ends(&mut random, &text).as_bytes()), RmbFile::parse(text.as_bytes()), "{seed}");
        // A drawing and a map as text have ends of one kind.
        let end = *pick(&mut random, &["\r", "\r\n"]);
        let drawing = (0..1 + random.below(4)).fold(Dxf::new(), |dxf, k| {
            let y = random.below(9) as f64;
            dxf.line("0", [k as f64, y], [9.5, y + 1.0])
        });
        let drawing = String::from_utf8(drawing.model(&Dxf::new())).unwrap();
        let plan = |text: &str| parse_dxf(text.as_bytes(), &PlanReadOptions::default());
        assert_eq!(plan(&drawing.replace('\n', end)).unwrap(), plan(&drawing).unwrap(), "{seed}");
        n += 1;
    }
    assert!(n == siblings().len() && 10 * n_lost > 9 * n, "{n_lost} of {n}");
}

/// As above, of maps as text with a comment in each line.
#[test]
fn maps_as_text_have_lines_of_any_system() {
    let (mut n, mut n_lost) = (0, 0);
    for seed in siblings() {
        let mut random = Random::new(seed);
        let mut text = "namespace = \"zdoom\"; // a map\nsector { } // a room\nsidedef { sector = 0; }\n".to_owned();
        let n_corners = 3 + random.below(4);
        for k in 0..n_corners {
            let [x, y] = [(); 2].map(|()| random.below(999));
            text += &format!("vertex // {k}\n{{ x = {x}.0; y = {y}.5; /* here */ }}\n");
            let next = (k + 1) % n_corners;
            text += &format!("linedef {{ v1 = {k}; v2 = {next}; sidefront = 0; }} // wall {k}\n");
        }
        let map = |text: &str| {
            let wad = sightlines_formats::Wad::parse(udmf::wad_of_text(text.as_bytes(), &[])).unwrap();
            let lumps = &sightlines_formats::doom::list_maps(&wad)[0];
            let map = sightlines_formats::DoomMap::parse(&wad, lumps).map_err(|error| error.what)?;
            Ok::<_, String>((map.vertices().to_vec(), map.lines().to_vec(), map.n_sectors()))
        };
        let expected = map(&text);
        assert!(expected.is_ok(), "{seed}: {expected:?}");
        for end in ["\r", "\r\n"] {
            assert_eq!(map(&text.replace('\n', end)), expected, "{seed}");
        }
        n_lost += usize::from(map(&text.replace('\n', " ")) != expected);
        n += 1;
    }
    assert_eq!((n, n_lost), (siblings().len(), n));
}

/// Files beside an OBJ.
#[derive(Debug)]
struct Beside(Vec<(String, String)>);

impl Neighbours for Beside {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        let found = self.0.iter().find(|(name, _)| Path::new(name) == path);
        found.map(|(_, text)| Some(text.as_bytes().to_vec())).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

/// Of the libraries of a line those that are there count, and those that are missing are named. The twin has all of them and no warning; the impostor
/// uses none if one is missing.
#[test]
fn libraries_that_are_there_count_whatever_is_missing() {
    let [mut n, mut n_missing, mut n_all, mut n_impostor] = [0; 4];
    for seed in siblings() {
        let mut random = Random::new(seed);
        // Each has two materials; what hides is known of those that are there.
        let names: Vec<String> =
            (0..1 + random.below(4)).map(|k| format!("{}{k}.mtl", pick(&mut random, &["a", "B_", "x-"]))).collect();
        let there: Vec<bool> = names.iter().map(|_| random.below(3) > 0).collect();
        let opaque: Vec<[bool; 2]> = names.iter().map(|_| [(); 2].map(|()| random.below(2) == 0)).collect();
        let library = |k: usize| {
            let of = |m: usize| format!("newmtl m{k}_{m}\nKd 0 0 0\nd {}\n", if opaque[k][m] { "1" } else { "0.4" });
            format!("{}{}", of(0), of(1))
        };
        let beside = (0..names.len()).filter(|&k| there[k]).map(|k| (names[k].clone(), library(k))).collect();
        let mut text = format!(
            "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
            names.join(if random.below(2) == 0 { " " } else { "  " })
        );
        let mut expected = Vec::new();
        for object in 0..1 + random.below(5) {
            let (k, m) = (random.below(names.len()), random.below(2));
            text += &format!("o {object}\nusemtl m{k}_{m}\nf 1 2 3\n");
            expected.push(there[k] && opaque[k][m]);
        }
        let file = parse_obj_with(text.as_bytes(), Some(&Beside(beside)), &SceneReadOptions::default()).unwrap();
        let hides: Vec<bool> = (0..expected.len() as u32).map(|k| file.scene.is_opaque(k)).collect();
        assert_eq!(hides, expected, "{seed}: {text}");
        let missing: Vec<&String> = (0..names.len()).filter(|&k| !there[k]).map(|k| &names[k]).collect();
        let [warning] = &file.info.warnings[..] else {
            assert!(file.info.warnings.is_empty() && missing.is_empty(), "{seed}: {:?}", file.info.warnings);
            n_all += 1;
            n += 1;
            continue;
        };
        // If there is none, it may be one name.
        assert!(!missing.is_empty() && missing.iter().all(|name| warning.contains(name.as_str())), "{seed}: {warning}");
        let of_others = (0..names.len()).filter(|&k| there[k]).any(|k| warning.contains(names[k].as_str()));
        assert!(!of_others, "{seed}: {warning}");
        n_missing += 1;
        n_impostor += usize::from(expected.contains(&true));
        n += 1;
    }
    let found = [n_missing, n_all, n_impostor].map(|k| 8 * k > n);
    assert!(n == siblings().len() && found == [true; 3], "{n_missing} {n_all} {n_impostor} of {n}");
}

/// Any JSON, not deep.
fn json_of(random: &mut Random, depth: usize) -> Value {
    match random.below(if depth == 0 { 3 } else { 5 }) {
        0 => json!(random.below(9)),
        1 => json!("text"),
        2 => json!([0.5, 1, "x"]),
        3 => Value::Object((0..random.below(3)).map(|k| (format!("k{k}"), json_of(random, depth - 1))).collect()),
        _ => Value::Array((0..random.below(3)).map(|_| json_of(random, depth - 1)).collect()),
    }
}

/// A glTF of version 1, whose lists are maps, is named with what converts it, whatever it holds and in whatever order. The twin states version 2 and has
/// lists; the impostor states version 2, so that its maps are what is wrong.
#[test]
fn version_1_of_gltf_is_named_with_what_converts_it() {
    const LISTS: [&str; 9] =
        ["accessors", "animations", "bufferViews", "buffers", "materials", "meshes", "nodes", "scenes", "techniques"];
    let mut n = 0;
    for seed in siblings() {
        let mut random = Random::new(seed);
        let version = *pick(&mut random, &["1.0", "1.0.1", "1", "1.1"]);
        let mut members: Vec<(String, String)> = Vec::new();
        for name in LISTS {
            if random.below(3) > 0 {
                let of: Map<String, Value> =
                    (0..1 + random.below(3)).map(|k| (format!("{name}_{k}"), json_of(&mut random, 2))).collect();
                members.push((name.to_owned(), Value::Object(of).to_string()));
            }
        }
        members.push(("scene".to_owned(), "\"defaultScene\"".to_owned()));
        members.push(("extras".to_owned(), json!({"version": "2.0", "asset": {"version": "2.0"}}).to_string()));
        let asset = |version: &str| {
            ("asset".to_owned(), json!({"generator": "x", "version": version, "premultipliedAlpha": true}).to_string())
        };
        for k in (1..members.len()).rev() {
            members.swap(k, random.below(k + 1));
        }
        let at = random.below(members.len() + 1);
        let text = |version: &str| {
            let mut members = members.clone();
            members.insert(at, asset(version));
            let members: Vec<String> = members.iter().map(|(name, value)| format!("{name:?}: {value}")).collect();
            format!("{{{}}}", members.join(", "))
        };
        let refused = |bytes: &[u8]| parse_glb(bytes, None).expect_err("version 1").to_string();
        let expected = format!(
            "glTF version {version:?} is not 2.x; `npx gltf-pipeline -i IN.gltf -o OUT.glb` makes version 2 of version 1"
        );
        assert_eq!(refused(text(version).as_bytes()), expected, "{seed}: {}", text(version));
        assert_eq!(refused(&glb(&text(version), &[])), expected, "{seed}");
        assert!(!refused(text("2.0").as_bytes()).contains("gltf-pipeline"), "{seed}");
        // A container of version 1.
        let mut container = glb(&text(version), &[]);
        container[4] = 1;
        assert!(refused(&container).contains("gltf-pipeline"), "{seed}");
        let mut twin = crate::common::glb::small_doc();
        twin.json["extras"] = json!({"asset": {"version": version}, "meshes": json_of(&mut random, 2)});
        assert!(parse_glb(&twin.glb(), None).is_ok(), "{seed}");
        n += 1;
    }
    assert_eq!(n, siblings().len());
}

/// A building somewhere on earth in degrees is noticed, and named with the zone in which it is. The twins are the same building in metres: around a
/// corner of it, and as its zone has it; the impostor takes everything between -180 and 180 for degrees.
#[test]
fn buildings_in_degrees_are_noticed() {
    let [mut n, mut n_impostor] = [0; 2];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let (longitude, latitude) = (360.0 * random.unit() - 180.0, 160.0 * random.unit() - 80.0);
        let size = 2.0 + 150.0 * random.unit();
        let corners: Vec<[f64; 2]> = (0..3 + random.below(5)).map(|_| [(); 2].map(|()| size * random.unit())).collect();
        let line = |of: &dyn Fn([f64; 2]) -> [f64; 2]| {
            let all: Vec<String> = corners.iter().map(|&p| of(p)).map(|[x, y]| format!("[{x:.8},{y:.8}]")).collect();
            format!("[{}]", all.join(","))
        };
        let feature = |of: &dyn Fn([f64; 2]) -> [f64; 2]| {
            let geometry = match random.clone().below(2) {
                0 => format!(r#"{{"type":"LineString","coordinates":{}}}"#, line(of)),
                _ => format!(r#"{{"type":"MultiLineString","coordinates":[{}]}}"#, line(of)),
            };
            format!(
                r#"{{"type":"FeatureCollection","features":[{{"type":"Feature","properties":{{}},"geometry":{geometry}}}]}}"#
            )
        };
        let warnings = |text: &str| parse_plan_file(text.as_bytes()).unwrap_or_else(|e| panic!("{seed}: {e}")).warnings;
        let metres = 1.0 / 111_320.0;
        let across = metres / latitude.to_radians().cos();
        let degrees = feature(&|[x, y]| [(longitude + x * across).min(180.0), latitude + y * metres]);
        if longitude.abs() > 1.01 || latitude.abs() > 1.01 {
            let [warning] = &warnings(&degrees)[..] else { panic!("{seed}: {degrees}") };
            let zone = |x: f64| 1 + ((x + 180.0) / 6.0).floor().min(59.0) as u32;
            let system = if latitude < 0.0 { 32700 } else { 32600 };
            // One at the border of a zone, or of the hemispheres, may be in either.
            let is_near =
                [longitude, longitude + size * across].map(|x| warning.contains(&format!("EPSG:{}", system + zone(x))));
            assert!(is_near.contains(&true) || latitude.abs() < 0.01, "{seed}: {warning} {longitude} {latitude}");
            n += 1;
        }
        for shift in [[0.0; 2], [500_000.0, 5_000_000.0]] {
            let text = feature(&|[x, y]| [x + shift[0], y + shift[1]]);
            assert_eq!(warnings(&text), [""; 0], "{seed}: {text}");
        }
        n_impostor += usize::from(size < 90.0);
    }
    let all = siblings().len();
    assert!(10 * n > 9 * all && 4 * n_impostor > all, "{n} {n_impostor} of {all}");
}
