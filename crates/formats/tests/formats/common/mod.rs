//! What the tests of readers share: small files to begin with.

pub(crate) mod dxf;
pub(crate) mod glb;
pub(crate) mod quake;
pub(crate) mod udmf;

use sightlines_formats::doom::{DoomMapSource, ML_TWOSIDED, SourceLine, SourceThing};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Malformed, Wad};
use std::path::{Path, PathBuf};

/// The line of a text that an error names.
pub(crate) fn line_of(error: &Malformed) -> usize {
    let (_, behind) = error.place.split_once("line ").expect("a line");
    let digits = behind.split(|c: char| !c.is_ascii_digit()).next();
    digits.and_then(|digits| digits.parse().ok()).expect("a number")
}

/// Two square rooms joined by a two-sided line, sector 0 in the west and sector 1 in the east, with a
/// thing in each.
pub(crate) fn two_rooms(hexen: bool) -> DoomMapSource {
    let wall = |v1, v2, right| SourceLine { v1, v2, flags: 1, right: Some(right), left: None };
    let door = SourceLine { v1: 1, v2: 4, flags: ML_TWOSIDED, right: Some(1), left: Some(0) };
    DoomMapSource {
        vertices: vec![[0, 0], [64, 0], [128, 0], [128, 64], [64, 64], [0, 64]],
        // Clockwise around each room, so that its sector is on the right hand.
        lines: vec![wall(1, 0, 0), wall(0, 5, 0), wall(5, 4, 0), wall(4, 3, 1), wall(3, 2, 1), wall(2, 1, 1), door],
        n_sectors: 2,
        things: vec![SourceThing { x: 32, y: 32, kind: 1 }, SourceThing { x: 96, y: 32, kind: 3001 }],
        reject: Some(vec![0]),
        hexen,
    }
}

/// A WAD with a lump before, the map, and a lump behind.
pub(crate) fn small_wad(source: &DoomMapSource) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"before").unwrap();
    source.add_to(&mut builder, LumpName::new("MAP01").unwrap()).unwrap();
    builder.lump("BEHIND", b"behind").unwrap();
    builder.finish().unwrap()
}

/// A scene with every kind of GeoJSON object that is read.
pub(crate) const SMALL_GEOJSON: &str = r#"{"type":"FeatureCollection","features":[
{"type":"Feature","id":3,"properties":{"kind":"wall","left_group":1},"geometry":{"type":"LineString","coordinates":[[0,0],[4.5,0],[4.5,3]]}},
{"type":"Feature","properties":{"sight":"transparent"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]],[[5,5],[6,5],[6,6]]]}},
{"type":"Feature","properties":{"name":"lamp","opaque":true},"geometry":{"type":"GeometryCollection","geometries":[
{"type":"Point","coordinates":[1,2,3]},{"type":"MultiPoint","coordinates":[[1,2],[3,4]]},
{"type":"MultiLineString","coordinates":[[[0,1],[1,0]],[[2,2],[3,3]]]},{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[1,1]]]]}]}}]}"#;

/// Says where `after` differs from `before` in more than the REJECT lumps, if it does.
pub(crate) fn difference_besides_reject(before: &Wad, after: &Wad) -> Option<String> {
    let others = |wad: &Wad| -> Vec<([u8; 8], Vec<u8>)> {
        let lumps = wad.lumps().iter().enumerate().filter(|(_, l)| !l.name.is("REJECT"));
        lumps.map(|(k, l)| (l.name.raw(), wad.lump_bytes(k).to_vec())).collect()
    };
    let (old, new) = (others(before), others(after));
    if before.kind() != after.kind() || old.len() != new.len() {
        return Some(format!("{:?} of {} lumps, then {:?} of {}", before.kind(), old.len(), after.kind(), new.len()));
    }
    let differs = old.iter().zip(&new).position(|(a, b)| a != b);
    differs.map(|k| format!("lump {k} besides REJECT, {:?}, differs", LumpName::from_raw(old[k].0)))
}

/// The folder of real data that an environment variable names; says loudly that a test skips without it.
pub(crate) fn data_folder(variable: &str, test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        eprintln!("SKIPPED {test}: {variable} is not set");
    }
    folder
}

/// The files of a folder with this extension, by name.
pub(crate) fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.filter(|p| p.extension().is_some_and(|e| e == extension)).collect();
    paths.sort();
    paths
}

/// A number that the environment may set.
pub(crate) fn setting(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |text| text.parse().unwrap_or_else(|e| panic!("{variable}: {e}")))
}
