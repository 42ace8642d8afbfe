//! Maps as text, written from binary ones: for tests, which compare both.

use sightlines_formats::doom::{DoomMap, LineDef};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Wad};
use std::fmt::Write;

/// A coordinate as one of the ways to write it that every program reads.
fn number(x: f64, way: usize) -> String {
    match way % 3 {
        0 => format!("{x:.3}"),
        1 => format!("{x}"),
        _ => format!("{x:.1}"),
    }
}

/// The text of a map. Coordinates, flags, comments and the order of blocks are written in turns as the grammar allows; coordinates
/// must be multiples of 1/8.
pub(crate) fn text_of(map: &DoomMap) -> String {
    let mut text = "namespace = \"zdoom\"; // a map\n".to_owned();
    for (k, thing) in map.things().iter().enumerate() {
        let [x, y] = [thing.x, thing.y].map(|x| number(x, k));
        writeln!(text, "thing {{ x = {x}; y = {y}; type = {}; skill1 = true; comment = \"}}\"; }}", thing.kind)
            .unwrap();
    }
    for (k, &[x, y]) in map.vertices().iter().enumerate() {
        writeln!(text, "vertex // {k}\n{{\ny = {};\nx = {};\n}}", number(y, k / 2), number(x, k)).unwrap();
    }
    for (k, line) in map.lines().iter().enumerate() {
        writeln!(text, "LineDef/* {k} */{{ {} }}", line_text(line, k)).unwrap();
    }
    for (k, sector) in map.side_sectors().iter().enumerate() {
        writeln!(text, "sidedef{{texturemiddle=\"-\";offsetx={k};sector={sector};}}").unwrap();
    }
    for k in 0..map.n_sectors() {
        writeln!(text, "sector {{ heightceiling = {k}; texturefloor = \"A\\\"B\"; user_note = nothing; }};").unwrap();
    }
    text
}

fn line_text(line: &LineDef, k: usize) -> String {
    let mut text = format!("v1 = {}; v2 = {};", line.v1, line.v2);
    if let Some(side) = line.right {
        write!(text, " sidefront = {side};").unwrap();
    }
    match line.left {
        Some(side) => write!(text, " sideback = {side};").unwrap(),
        None if k.is_multiple_of(2) => text += " sideback = -1;",
        None => {}
    }
    match (line.is_two_sided(), k % 2) {
        (true, _) => text += " TwoSided = TRUE;",
        (false, 0) => text += " twosided = false; blocking = true;",
        (false, _) => {}
    }
    text
}

/// A WAD with one map as text between two lumps, with the lumps that stand around the text.
pub(crate) fn wad_of_text(text: &[u8], others: &[(&str, &[u8])]) -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    let mut lump = |name: &str, bytes: &[u8]| _ = builder.lump(name, bytes).unwrap();
    lump("BEFORE", b"before");
    lump("MAP01", b"");
    lump("TEXTMAP", text);
    others.iter().for_each(|&(name, bytes)| lump(name, bytes));
    lump("ENDMAP", b"");
    lump("BEHIND", b"behind");
    builder.finish().unwrap()
}

/// The same WAD with each map in a binary format as text, without REJECT lumps.
pub(crate) fn as_text(wad: &Wad) -> Vec<u8> {
    let mut builder = WadBuilder::new(wad.kind());
    for lumps in sightlines_formats::doom::list_maps(wad) {
        let map = DoomMap::parse(wad, &lumps).unwrap();
        let name = LumpName::from_raw(lumps.name().raw());
        builder.lump_named(name, b"").unwrap();
        builder.lump("TEXTMAP", text_of(&map).as_bytes()).unwrap().lump("ZNODES", b"XGLN").unwrap();
        builder.lump("ENDMAP", b"").unwrap();
    }
    builder.finish().unwrap()
}
