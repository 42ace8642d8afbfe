//! What the tests of readers share: small files to begin with, and a mutator that breaks them.

#![allow(dead_code, unreachable_pub, reason = "each test uses a part of this module")]

use sightlines_formats::doom::{DoomMapSource, ML_TWOSIDED, SourceLine, Thing};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Wad};
use std::path::{Path, PathBuf};

/// Steele, Lea and Flood's SplitMix64: the same numbers on every machine.
#[derive(Debug, Clone)]
pub struct SplitMix(pub u64);

impl SplitMix {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `n`, or 0.
    pub fn below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.next() % n as u64) as usize }
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

/// Numbers that are most likely to break a reader of binary fields.
const NUMBERS: [u32; 12] = [0, 1, 2, 11, 12, 16, 0x7F, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFF0, 0xFFFF_FFFF];
/// Pieces that are most likely to break a reader of GeoJSON.
const PIECES: [&[u8]; 18] = [
    b"[",
    b"]",
    b"{",
    b"}",
    b",",
    b"null",
    b"NaN",
    b"-",
    b"1e999",
    b"1e-300",
    b"-0",
    b"\"",
    b"\\",
    b"\xFF",
    b"[]",
    b"\"type\":\"Point\",",
    b"\"coordinates\":[1,2],",
    b"18446744073709551616",
];

/// Breaks `bytes` in one to four ways.
pub fn mutate(bytes: &[u8], random: &mut SplitMix) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4) {
        mutate_once(&mut out, random);
    }
    out
}

fn mutate_once(out: &mut Vec<u8>, random: &mut SplitMix) {
    let at = random.below(out.len());
    match random.below(8) {
        0 if !out.is_empty() => out[at] ^= 1 << random.below(8),
        1 if !out.is_empty() => out[at] = random.next() as u8,
        2 => out.truncate(at),
        3 => {
            let to = (at + random.below(40)).min(out.len());
            let (piece, goal) = (out[at..to].to_vec(), random.below(out.len()));
            out.splice(goal..goal, piece);
        }
        4 => drop(out.drain(at..(at + random.below(20)).min(out.len()))),
        5 => _ = out.splice(at..at, random.pick(&PIECES).iter().copied()),
        6 => write_number(out, at & !3, random),
        // The header, and the directory that the builder leaves at the end.
        _ if random.below(3) == 0 => write_number(out, 4 * random.below(3), random),
        _ => {
            let entry = out.len().saturating_sub(16 * (1 + random.below(14)));
            write_number(out, entry + 4 * random.below(4), random);
        }
    }
}

/// Puts an extreme number, or the number there with a small change, at `at`.
fn write_number(out: &mut [u8], at: usize, random: &mut SplitMix) {
    let Some(field) = out.get_mut(at..at + 4) else { return };
    let old = u32::from_le_bytes([field[0], field[1], field[2], field[3]]);
    let near = old.wrapping_add(random.below(9) as u32).wrapping_sub(4);
    let new = if random.below(2) == 0 { near } else { random.pick(&NUMBERS) };
    field.copy_from_slice(&new.to_le_bytes());
}

/// Two square rooms joined by a two-sided line, sector 0 in the west and sector 1 in the east, with a
/// thing in each.
pub fn two_rooms(hexen: bool) -> DoomMapSource {
    let wall = |v1, v2, right| SourceLine { v1, v2, flags: 1, right: Some(right), left: None };
    let door = SourceLine { v1: 1, v2: 4, flags: ML_TWOSIDED, right: Some(1), left: Some(0) };
    DoomMapSource {
        vertices: vec![[0, 0], [64, 0], [128, 0], [128, 64], [64, 64], [0, 64]],
        // Clockwise around each room, so that its sector is on the right hand.
        lines: vec![wall(1, 0, 0), wall(0, 5, 0), wall(5, 4, 0), wall(4, 3, 1), wall(3, 2, 1), wall(2, 1, 1), door],
        n_sectors: 2,
        things: vec![Thing { x: 32, y: 32, kind: 1 }, Thing { x: 96, y: 32, kind: 3001 }],
        reject: Some(vec![0]),
        hexen,
    }
}

/// A WAD with a lump before, the map, and a lump behind.
pub fn small_wad(source: &DoomMapSource) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"before").unwrap();
    source.add_to(&mut builder, LumpName::new("MAP01").unwrap()).unwrap();
    builder.lump("BEHIND", b"behind").unwrap();
    builder.finish().unwrap()
}

/// A scene with every kind of GeoJSON object that is read.
pub const SMALL_GEOJSON: &str = r#"{"type":"FeatureCollection","features":[
{"type":"Feature","id":3,"properties":{"kind":"wall","left_group":1},"geometry":{"type":"LineString","coordinates":[[0,0],[4.5,0],[4.5,3]]}},
{"type":"Feature","properties":{"sight":"transparent"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]],[[5,5],[6,5],[6,6]]]}},
{"type":"Feature","properties":{"name":"lamp","opaque":true},"geometry":{"type":"GeometryCollection","geometries":[
{"type":"Point","coordinates":[1,2,3]},{"type":"MultiPoint","coordinates":[[1,2],[3,4]]},
{"type":"MultiLineString","coordinates":[[[0,1],[1,0]],[[2,2],[3,3]]]},{"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[1,1]]]]}]}}]}"#;

/// Says where `after` differs from `before` in more than the REJECT lumps, if it does.
pub fn difference_besides_reject(before: &Wad, after: &Wad) -> Option<String> {
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
pub fn data_folder(variable: &str, test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map(PathBuf::from);
    if folder.is_none() {
        eprintln!("SKIPPED {test}: {variable} is not set");
    }
    folder
}

/// The files of a folder with this extension, by name.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.filter(|p| p.extension().is_some_and(|e| e == extension)).collect();
    paths.sort();
    paths
}
