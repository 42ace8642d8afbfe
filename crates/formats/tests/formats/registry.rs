//! The registry of formats: each recognises its own sample and no other's, and reads it.

use crate::common::glb::small_doc;
use crate::common::quake::{SMALL_PRTS, SmallBsp};
use sightlines_formats::input::{FORMATS, Format, HEAD, Input, InputKind, Neighbours, Source, detect};
use sightlines_formats::levels::{LevelsIndex, write_levels_index};
use sightlines_formats::quake::BspFormat;
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_pvs::{Table, TableKind, TableParts};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;

const PLAN: &str = r#"{"type": "LineString", "coordinates": [[0, 0], [4, 0]]}"#;
const VIEW_CELLS: &str = r#"{"cells": [{"id": "hall", "min": [0, 0, 0], "max": [1, 1, 1]}]}"#;
/// A triangle as the text of a glTF, with its buffer inside.
const GLTF: &str = r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri":
    "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]}"#;
/// A line as DXF of any version.
const DXF: &str = "  0\nSECTION\n  2\nENTITIES\n  0\nLINE\n 10\n1.5\n 20\n0\n 11\n4\n 21\n0\n  0\nENDSEC\n  0\nEOF\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// What files of a format are like, each with the ending of its name.
fn samples(format: &Format) -> Vec<(&'static str, Vec<u8>)> {
    let small = |kind| SmallBsp::new(kind).file(false);
    match format.name {
        "wad" => [WadKind::Game, WadKind::Patch].map(|kind| ("wad", WadBuilder::new(kind).finish().unwrap())).to_vec(),
        "pvs" => vec![("pvs", Table::new(TableParts::empty(2, TableKind::PlanKdTree)).unwrap().to_bytes())],
        "pvz" => vec![("pvz", b"\x89PVP\r\n\x1a\n and more".to_vec())],
        "proofs" => vec![("cert", b"SLPROOFS and more".to_vec())],
        "gltf" => vec![("glb", small_doc().glb()), ("gltf", GLTF.as_bytes().to_vec())],
        "obj" => vec![("obj", OBJ.as_bytes().to_vec())],
        "prt" => SMALL_PRTS.map(|text| ("prt", text.as_bytes().to_vec())).to_vec(),
        "bsp" => BspFormat::ALL.map(|kind| ("bsp", small(kind))).to_vec(),
        "dxf" => {
            ["", "999\nmade by hand\n", "\u{FEFF}"].map(|head| ("dxf", format!("{head}{DXF}").into_bytes())).to_vec()
        }
        "levels" => {
            let index = LevelsIndex { n_triangles: 3, budget: 0.5, levels: Vec::new(), cells: vec![None] };
            vec![("json", write_levels_index(&index).into_bytes())]
        }
        "view-cells" => vec![("json", VIEW_CELLS.as_bytes().to_vec())],
        "geojson" => [
            ("json", PLAN.to_owned()),
            ("geojson", format!("\u{FEFF}\n {PLAN}")),
            ("ndjson", format!("{PLAN}\n{PLAN}\n")),
            ("geojsons", format!("\x1E{PLAN}\n\x1E{PLAN}\n")),
        ]
        .map(|(ending, text)| (ending, text.into_bytes()))
        .to_vec(),
        name => panic!("a sample for the format {name} is missing"),
    }
}

/// Formats that only the name tells, such as OBJ, JSON that is a glTF by its name, and portals of Half-Life, which begin with a number.
fn is_by_name(format: &Format, bytes: &[u8]) -> bool {
    format.name == "obj"
        || format.name == "prt" && bytes[0].is_ascii_digit()
        || format.name == "gltf" && !bytes.starts_with(b"glTF")
}

fn name_of(name: &str, bytes: &[u8]) -> Option<&'static str> {
    detect(Path::new(name), bytes).map(|format| format.name)
}

const fn kind_of(input: &Input) -> InputKind {
    match input {
        Input::Plan(_) => InputKind::Plan,
        Input::Wad(_) => InputKind::Wad,
        Input::Scene(_) => InputKind::Scene,
        Input::Prt(_) => InputKind::Prt,
        Input::Bsp(_) => InputKind::Bsp,
        Input::Table(_) => InputKind::Table,
        Input::Packed => InputKind::Packed,
        Input::Proofs => InputKind::Proofs,
        Input::ViewCells(_) => InputKind::ViewCells,
        Input::Levels(_) => InputKind::Levels,
        _ => panic!("a kind is missing here"),
    }
}

/// Whether a registry recognises each sample as of its own format, whatever its name: its content if it has a sign, else its name.
fn all_recognised(detect: impl Fn(&str, &[u8]) -> Option<&'static str>) -> usize {
    let mut n = 0;
    for format in &FORMATS {
        for (ending, bytes) in samples(format) {
            let own = format!("some.{}", ending.to_ascii_uppercase());
            n += usize::from(detect(&own, &bytes) != Some(format.name));
            if !is_by_name(format, &bytes) {
                n += usize::from(detect("some", &bytes) != Some(format.name));
                n += usize::from(detect("some.txt", &bytes[..bytes.len().min(HEAD)]) != Some(format.name));
            }
        }
    }
    n
}

#[test]
fn each_format_recognises_its_own_samples_and_no_other() {
    assert_eq!(all_recognised(name_of), 0);
    // Impostors: a registry that goes by names alone, one without names, one that takes everything for the same.
    assert!(all_recognised(|name, _| name_of(name, b"")) > 10);
    assert!(all_recognised(|_, bytes| name_of("", bytes)) >= 2);
    for format in &FORMATS {
        assert!(all_recognised(|_, _| Some(format.name)) > 20, "{}", format.name);
    }
    // Content with a magic decides against every name.
    let mut n = 0;
    for format in &FORMATS {
        for (_, bytes) in samples(format) {
            let is_strong = !is_by_name(format, &bytes) && !bytes.trim_ascii_start().starts_with(b"{");
            for other in
                FORMATS.iter().filter(|_| is_strong && !bytes.starts_with(b"\xEF") && !bytes.starts_with(b"\x1E"))
            {
                for ending in other.extensions {
                    assert_eq!(name_of(&format!("x.{ending}"), &bytes), Some(format.name), "{}.{ending}", format.name);
                    n += 1;
                }
            }
        }
    }
    assert!(n > 100, "{n}");
}

#[test]
fn names_decide_where_the_content_does_not() {
    for format in &FORMATS {
        for ending in format.extensions {
            let found = name_of(&format!("x.{ending}"), b"").unwrap();
            // Formats of JSON share an ending.
            assert_eq!(found, if *ending == "json" { "geojson" } else { format.name });
        }
    }
    assert_eq!([name_of("x", b""), name_of("x.txt", b"PWA"), name_of("json", b"[1]")], [None; 3]);
    assert_eq!(name_of("x.obj", PLAN.as_bytes()), Some("obj"));
    assert_eq!(name_of("x.gltf", VIEW_CELLS.as_bytes()), Some("gltf"));
    assert_eq!(name_of("x.wad", PLAN.as_bytes()), Some("geojson"));
    // A plan stays one, whatever else it has.
    let plan = r#"{"cells": 1, "sightlines_levels": 1, "type": "LineString", "coordinates": [[0, 0], [4, 0]]}"#;
    assert_eq!(name_of("x.json", plan.as_bytes()), Some("geojson"));
}

#[test]
fn names_and_endings_are_sound() {
    let names: BTreeSet<&str> = FORMATS.iter().map(|format| format.name).collect();
    assert_eq!(names.len(), FORMATS.len());
    for format in &FORMATS {
        assert!(!format.extensions.is_empty() && !format.noun.is_empty());
        let is_lower = |ending: &&str| ending.bytes().all(|b| b.is_ascii_lowercase());
        assert!(format.extensions.iter().all(is_lower), "{}", format.name);
    }
}

/// From a file and from memory the same is read, and what is no sample is refused by the reader with the name.
#[test]
fn all_formats_are_read_from_files_and_from_memory() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_refused = 0;
    for format in &FORMATS {
        for (ending, bytes) in samples(format) {
            let path = folder.path().join(format!("some.{ending}"));
            fs::write(&path, &bytes).unwrap();
            let from_file = Source::File(&path).read().unwrap().unwrap();
            let from_memory = Source::Memory { name: &path, bytes: &bytes, beside: None }.read().unwrap().unwrap();
            assert_eq!([kind_of(&from_file), kind_of(&from_memory)], [format.kind; 2], "{}", format.name);
            assert_eq!(format!("{from_file:?}"), format!("{from_memory:?}"));
            let broken = Source::Memory { name: &path, bytes: b"?", beside: None };
            if let Err(error) = broken.read_as(format) {
                assert!(error.to_string().starts_with(path.to_str().unwrap()), "{error}");
                n_refused += 1;
            }
        }
    }
    assert!(n_refused > 10, "{n_refused}");
    let absent = folder.path().join("absent.wad");
    assert!(Source::File(&absent).read().unwrap_err().to_string().contains("absent.wad: "));
}

/// An archive with one file.
#[derive(Debug)]
struct Archive(&'static str, Vec<u8>);

impl Neighbours for Archive {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        if path == Path::new(self.0) { Ok(Some(self.1.clone())) } else { Err(io::ErrorKind::NotFound.into()) }
    }
}

#[test]
fn what_a_scene_names_is_read_from_wherever_it_lies() {
    let positions: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    let text = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]}"#;
    let read = |beside| Source::Memory { name: "x.gltf".as_ref(), bytes: text.as_bytes(), beside }.read();
    let archive = Archive("a.bin", positions);
    let Input::Scene(file) = read(Some(&archive as &dyn Neighbours)).unwrap().unwrap() else { panic!("a scene") };
    assert_eq!(file.scene.n_triangles(), 1);
    let other = Archive("b.bin", Vec::new());
    assert!(read(Some(&other)).is_err() && read(None).is_err());
}
