//! Which maps a WAD has.

use sightlines_formats::doom::{DoomMap, MapFormat, MapLump, list_maps};
use sightlines_formats::wad::{Wad, WadBuilder, WadKind};
use std::ops::Range;

fn wad(names: &[&str]) -> Wad {
    let mut builder = WadBuilder::new(WadKind::Patch);
    for name in names {
        builder.lump(name, b"").unwrap();
    }
    Wad::parse(builder.finish().unwrap()).unwrap()
}

fn found(names: &[&str]) -> Vec<(String, Range<usize>, MapFormat)> {
    list_maps(&wad(names)).into_iter().map(|m| (m.name().to_string(), m.range(), m.format())).collect()
}

fn map(name: &str, range: Range<usize>, format: MapFormat) -> (String, Range<usize>, MapFormat) {
    (name.to_owned(), range, format)
}

#[test]
fn maps_are_found_between_other_lumps() {
    let names = ["PLAYPAL", "E1M1", "THINGS", "LINEDEFS", "REJECT", "E1M2", "SECTORS", "GL_E1M2", "GL_VERT", "S_END"];
    assert_eq!(found(&names), [map("E1M1", 1..5, MapFormat::Doom), map("E1M2", 5..9, MapFormat::Doom)]);
    assert_eq!(list_maps(&wad(&names))[0].lump(MapLump::Reject), Some(4));
    assert_eq!(found(&["START", "NODES", "REJECT"]), []);
    assert_eq!(found(&["THINGS", "LINEDEFS"]), [], "lumps without a marker");
}

#[test]
fn order_names_and_case_are_free() {
    let names = ["MyLevel", "vertexes", "REJECT", "SECTORS", "NODES", "LINEDEFS"];
    assert_eq!(found(&names), [map("MyLevel", 0..6, MapFormat::Doom)]);
    assert_eq!(list_maps(&wad(&names))[0].lump(MapLump::Vertexes), Some(1));
}

#[test]
fn formats_are_recognised() {
    assert_eq!(found(&["MAP01", "LINEDEFS", "BEHAVIOR"]), [map("MAP01", 0..3, MapFormat::Hexen)]);
    assert_eq!(found(&["MAP01", "LINEDEFS", "LEAFS"]), [map("MAP01", 0..3, MapFormat::Console)]);
    let text = ["X", "TEXTMAP", "ZNODES", "DIALOGUE", "ENDMAP", "MAP02", "THINGS"];
    assert_eq!(found(&text), [map("X", 0..5, MapFormat::Udmf), map("MAP02", 5..7, MapFormat::Doom)]);
    assert_eq!(found(&["X", "TEXTMAP"]), [map("X", 0..2, MapFormat::Udmf)]);
    let open = ["X", "TEXTMAP", "Y", "TEXTMAP", "ENDMAP"];
    assert_eq!(found(&open), [map("X", 0..2, MapFormat::Udmf), map("Y", 2..5, MapFormat::Udmf)]);
}

#[test]
fn bare_markers_of_maps_are_maps() {
    assert_eq!(found(&["MAP01"]), [map("MAP01", 0..1, MapFormat::Doom)]);
    assert_eq!(found(&["e10m2", "MAP7"]).len(), 2);
    assert_eq!(found(&["MAPINFO", "EXM1", "E1M", "MAP", "E1"]), []);
}

#[test]
fn repeated_lumps_are_refused() {
    let wad = wad(&["MAP01", "THINGS", "SECTORS", "LINEDEFS", "SECTORS"]);
    let error = DoomMap::parse(&wad, &list_maps(&wad)[0]).unwrap_err();
    assert_eq!(error.to_string(), "map MAP01: SECTORS: there are two such lumps, 2 and 4");
}
