//! Doom maps from generated WADs: what is read is what was written, and what is wrong is named.

use crate::common::{difference_besides_reject, small_wad, two_rooms};
use proptest::prelude::*;
use sightlines_formats::doom::{
    DoomMapSource, Game, MapLump, SourceLine, SourceThing, Thing, list_maps, write_doom_map,
};
use sightlines_formats::wad::{WadBuilder, WadError, WadKind};
use sightlines_formats::{DoomMap, LumpName, Malformed, ReadError, Wad};

fn name(text: &str) -> LumpName {
    LumpName::new(text).unwrap()
}

/// The first map of a file.
fn read(bytes: Vec<u8>) -> Result<DoomMap, Malformed> {
    let wad = Wad::parse(bytes).unwrap();
    DoomMap::parse(&wad, &list_maps(&wad)[0])
}

fn error(change: impl Fn(&mut DoomMapSource)) -> [String; 2] {
    [false, true].map(|hexen| {
        let mut source = two_rooms(hexen);
        change(&mut source);
        read(small_wad(&source)).unwrap_err().to_string()
    })
}

fn vertices(source: &DoomMapSource) -> Vec<[f64; 2]> {
    source.vertices.iter().map(|v| v.map(f64::from)).collect()
}

fn things(source: &DoomMapSource) -> Vec<Thing> {
    source.things.iter().map(|t| Thing { x: t.x.into(), y: t.y.into(), kind: t.kind.into() }).collect()
}

/// The small map with some lumps left out or with other bytes.
fn with_lumps(change: impl Fn(&str, &[u8]) -> Option<Vec<u8>>) -> Result<DoomMap, Malformed> {
    let wad = Wad::parse(small_wad(&two_rooms(false))).unwrap();
    let mut builder = WadBuilder::new(WadKind::Patch);
    for (k, lump) in wad.lumps().iter().enumerate() {
        if let Some(bytes) = change(&lump.name.to_string(), wad.lump_bytes(k)) {
            builder.lump_named(lump.name, &bytes).unwrap();
        }
    }
    read(builder.finish().unwrap())
}

#[test]
fn two_rooms_make_the_flat_plan() {
    for hexen in [false, true] {
        let source = two_rooms(hexen);
        let map = read(small_wad(&source)).unwrap();
        assert_eq!((map.n_sectors(), map.format(), map.reject()), (2, source.format(), Some(&[0][..])));
        assert_eq!((map.things(), map.vertices()), (&things(&source)[..], &vertices(&source)[..]));
        let plan = map.plan().unwrap();
        let opaque: Vec<bool> = plan.lines().iter().map(|l| l.opaque).collect();
        assert_eq!(opaque, [true, true, true, true, true, true, false]);
        let names: Vec<&str> = plan.objects().iter().map(|o| o.name.as_str()).collect();
        assert_eq!(names, ["thing 1 #0", "thing 3001 #1"]);
        assert_eq!((plan.objects()[1].bounds.min, plan.objects()[1].bounds.max), ([96.0, 32.0], [96.0, 32.0]));
    }
}

/// The right side of a line is on the right hand: going north, that is the east.
#[test]
fn sides_are_on_the_right_hands() {
    let plan = read(small_wad(&two_rooms(false))).unwrap().plan().unwrap();
    let door = plan.lines()[6];
    assert!(door.b.y > door.a.y && door.a.x == door.b.x, "the door goes north");
    assert_eq!((door.right, door.left), (Some(1), Some(0)), "the eastern room is sector 1");
    // The same for all walls: each room's middle is on the right of the lines that face it with their right.
    for (sector, middle) in [(0, (32.0, 32.0)), (1, (96.0, 32.0))] {
        for l in plan.lines().iter().filter(|l| l.right == Some(sector)) {
            let middle = sightlines_geometry::Point2::new(middle.0, middle.1);
            assert!(sightlines_geometry::orient2d(l.a, l.b, middle) < 0.0, "{l:?}");
        }
    }
}

#[test]
fn lines_with_missing_sides_are_fine() {
    let mut source = two_rooms(false);
    source.lines[6].left = None;
    source.lines[0].right = None;
    let map = read(small_wad(&source)).unwrap();
    let plan = map.plan().unwrap();
    assert!(!plan.lines()[6].opaque && plan.lines()[6].left.is_none());
    assert!(plan.lines()[0].opaque && plan.lines()[0].right.is_none());
    source.lines[6].flags = 0;
    source.lines[6].left = Some(0);
    let opaque = |source: &_, game| read(small_wad(source)).unwrap().plan_for(game).unwrap().lines()[6].opaque;
    assert!(opaque(&source, Some(Game::Doom)), "two sides do not make it two-sided");
    assert!(!opaque(&source, None) && !opaque(&source, Some(Game::Heretic)), "other engines look through it");
    source.hexen = true;
    assert!(!opaque(&source, Some(Game::Doom)), "the format counts more");
    (source.lines[6].right, source.lines[6].left) = (Some(0), None);
    assert!(opaque(&source, None), "it needs a left side");
}

#[test]
fn indices_out_of_range_are_named() {
    let vertex = error(|s| s.lines[3].v2 = 6);
    assert_eq!(vertex, ["map MAP01: LINEDEFS 3: vertex 6 is not among the 6 there are"; 2]);
    let sector = error(|s| s.lines[6].left = Some(2));
    assert_eq!(sector, ["map MAP01: SIDEDEFS 7: sector 2 is not among the 2 there are"; 2]);
    let side = with_lumps(|name, bytes| Some(if name == "SIDEDEFS" { bytes[..30].to_vec() } else { bytes.to_vec() }));
    assert_eq!(side.unwrap_err().to_string(), "map MAP01: LINEDEFS 1: side 1 is not among the 1 there are");
}

/// Lines without length are no lines of the plan; a map of nothing else is empty.
#[test]
fn lines_of_length_zero_are_left_out() {
    for (change, left) in [
        ((|s| s.lines[2].v1 = s.lines[2].v2) as fn(&mut DoomMapSource), vec![0, 1, 3, 4, 5, 6]),
        (|s| s.vertices[5] = [0, 0], vec![0, 2, 3, 4, 5, 6]),
    ] {
        let mut source = two_rooms(false);
        let whole = read(small_wad(&source)).unwrap();
        assert_eq!(whole.n_lines_without_length(), 0);
        change(&mut source);
        let map = read(small_wad(&source)).unwrap();
        assert_eq!((map.lines().len(), map.n_lines_without_length()), (7, 1));
        let plan = map.plan().unwrap();
        assert_eq!(plan.lines().len(), left.len());
        for (drawn, &k) in plan.lines().iter().zip(&left) {
            let ends = [map.lines()[k].v1, map.lines()[k].v2].map(|v| map.vertices()[v as usize]);
            assert_eq!([drawn.a, drawn.b].map(|p| p.to_array()), ends);
        }
    }
    let points = error(|s| s.vertices.fill([5, 5]));
    assert_eq!(points, ["map MAP01: LINEDEFS: the map is empty"; 2]);
}

#[test]
fn empty_maps_are_refused() {
    assert_eq!(error(|s| s.lines.clear()), ["map MAP01: LINEDEFS: the map is empty"; 2]);
    assert_eq!(error(|s| (s.lines.clear(), s.n_sectors = 0).1), ["map MAP01: LINEDEFS: the map is empty"; 2]);
    assert_eq!(error(|s| s.n_sectors = 0), ["map MAP01: SECTORS: the map is empty"; 2]);
    let mut marker = WadBuilder::new(WadKind::Patch);
    marker.lump("E1M1", b"").unwrap();
    let error = read(marker.finish().unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "map E1M1: VERTEXES: there is no such lump");
}

#[test]
fn missing_lumps_are_named_if_they_matter() {
    for missing in ["LINEDEFS", "SIDEDEFS", "VERTEXES", "SECTORS"] {
        let found = with_lumps(|name, bytes| (name != missing).then(|| bytes.to_vec()));
        assert_eq!(found.unwrap_err().to_string(), format!("map MAP01: {missing}: there is no such lump"));
    }
    for missing in ["THINGS", "SEGS", "SSECTORS", "NODES", "REJECT", "BLOCKMAP"] {
        assert!(with_lumps(|name, bytes| (name != missing).then(|| bytes.to_vec())).is_ok(), "{missing}");
    }
}

#[test]
fn lumps_of_odd_size_are_refused() {
    for (odd, record, n) in
        [("THINGS", 10, 2), ("LINEDEFS", 14, 7), ("SIDEDEFS", 30, 8), ("VERTEXES", 4, 6), ("SECTORS", 26, 2)]
    {
        let longer = |name: &str, bytes: &[u8]| if name == odd { [bytes, &[0]].concat() } else { bytes.to_vec() };
        let found = with_lumps(|name, bytes| Some(longer(name, bytes))).unwrap_err().to_string();
        let size = record * n + 1;
        let rest = format!("{size} bytes do not divide into records of {record}; record {n} is cut short");
        assert_eq!(found, format!("map MAP01: {odd}: {rest}"));
    }
}

#[test]
fn node_lumps_are_never_read() {
    for nodes in [&b"xNd4\0\0\0\0rest"[..], b"XNOD....", b"ZNOD\x78\x9c\x03", b"XGL3", &[0xFF; 29]] {
        let garbage = |name: &str, bytes: &[u8]| match name {
            "SEGS" | "SSECTORS" | "NODES" | "BLOCKMAP" => nodes.to_vec(),
            _ => bytes.to_vec(),
        };
        assert!(with_lumps(|name, bytes| Some(garbage(name, bytes))).is_ok());
    }
}

#[test]
fn vertices_of_node_builders_are_fine() {
    let mut source = two_rooms(false);
    source.vertices.extend([[17, 0], [17, 0]]);
    assert_eq!(read(small_wad(&source)).unwrap().vertices().len(), 8);
}

#[test]
fn other_formats_are_refused_by_name() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("MAP03", b"").unwrap().lump("LINEDEFS", b"").unwrap().lump("LEAFS", b"").unwrap();
    let found = read(builder.finish().unwrap()).unwrap_err();
    assert_eq!(found.to_string(), "map MAP03: maps in console format are not supported");
    let shown = ReadError::new("maps/e1m1.wad", found).to_string();
    assert_eq!(shown, "maps/e1m1.wad: map MAP03: maps in console format are not supported");
}

#[test]
fn rejects_are_replaced_in_place_or_with_a_new_layout() {
    for hexen in [false, true] {
        let wad = Wad::parse(small_wad(&two_rooms(hexen))).unwrap();
        let maps = list_maps(&wad);
        let reject = maps[0].lump(MapLump::Reject).unwrap();
        assert_eq!(wad.with_rejects(&[(&maps[0], vec![0])]).unwrap(), wad.as_bytes(), "nothing changed");
        let mut expected = wad.as_bytes().to_vec();
        expected[wad.lumps()[reject].range().start] = 6;
        assert_eq!(wad.with_rejects(&[(&maps[0], vec![6])]).unwrap(), expected, "one byte changed");
        let after = Wad::parse(wad.with_rejects(&[(&maps[0], vec![1; 999])]).unwrap()).unwrap();
        assert_eq!(difference_besides_reject(&wad, &after), None);
        assert_eq!(after.lump_bytes(reject), [1; 999]);
    }
}

#[test]
fn maps_without_reject_get_one_behind_their_sectors() {
    let mut source = two_rooms(false);
    source.reject = None;
    let mut builder = WadBuilder::new(WadKind::Game);
    for map in ["MAP01", "MAP02", "MAP03"] {
        source.add_to(&mut builder, name(map)).unwrap();
    }
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let maps = list_maps(&wad);
    let after = Wad::parse(wad.with_rejects(&[(&maps[2], vec![3]), (&maps[0], vec![1])]).unwrap()).unwrap();
    assert_eq!(difference_besides_reject(&wad, &after), None);
    let rejects: Vec<Option<Vec<u8>>> = list_maps(&after)
        .iter()
        .map(|m| {
            assert!(m.lump(MapLump::Reject).is_none_or(|k| Some(k) == m.lump(MapLump::Sectors).map(|s| s + 1)));
            m.lump(MapLump::Reject).map(|k| after.lump_bytes(k).to_vec())
        })
        .collect();
    assert_eq!(rejects, [Some(vec![1]), None, Some(vec![3])]);
}

#[test]
fn rejects_without_a_place_are_refused() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("MAP01", b"").unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let maps = list_maps(&wad);
    assert_eq!(wad.with_rejects(&[(&maps[0], vec![])]), Err(WadError::NoPlace { map: name("MAP01") }));
    let other = Wad::parse(small_wad(&two_rooms(false))).unwrap();
    let foreign = wad.with_rejects(&[(&list_maps(&other)[0], vec![])]);
    assert_eq!(foreign, Err(WadError::NoSuchLump { lump: 10, n_lumps: 1 }));
}

#[test]
fn impostor_a_changed_lump_is_noticed() {
    let wad = Wad::parse(small_wad(&two_rooms(false))).unwrap();
    for (k, lump) in wad.lumps().iter().enumerate().filter(|(_, l)| l.size() > 0 && !l.name.is("REJECT")) {
        let mut bytes = wad.as_bytes().to_vec();
        bytes[lump.range().start] ^= 1;
        let changed = Wad::parse(bytes).unwrap();
        assert!(difference_besides_reject(&wad, &changed).is_some(), "lump {k}");
    }
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"before").unwrap();
    assert!(difference_besides_reject(&wad, &Wad::parse(builder.finish().unwrap()).unwrap()).is_some());
}

#[test]
fn too_many_sides_are_refused() {
    let mut source = two_rooms(false);
    source.lines = vec![source.lines[6]; 0x8000];
    let found = write_doom_map(name("MAP01"), &source).unwrap_err();
    assert_eq!(found.to_string(), "map MAP01: SIDEDEFS: 65536 sides are more than lines can name");
    source.lines.truncate(0x7FFF);
    assert!(read(write_doom_map(name("MAP01"), &source).unwrap()).is_ok());
}

pub(crate) fn sources() -> impl Strategy<Value = DoomMapSource> {
    let vertices = prop::collection::vec([-3i16..4, -3i16..4], 1..7);
    let sector = || prop::option::of(0u16..4);
    let line = (0u16..7, 0u16..7, 0u16..16, sector(), sector());
    let thing = (any::<i16>(), any::<i16>(), any::<u16>()).prop_map(|(x, y, kind)| SourceThing { x, y, kind });
    let reject = prop::option::of(prop::collection::vec(any::<u8>(), 0..4));
    let lines = prop::collection::vec(line, 0..8);
    (vertices, lines, 0u16..5, prop::collection::vec(thing, 0..3), reject, any::<bool>()).prop_map(
        |(vertices, lines, n_sectors, things, reject, hexen)| {
            let line = |(v1, v2, flags, right, left)| SourceLine { v1, v2, flags, right, left };
            DoomMapSource { vertices, lines: lines.into_iter().map(line).collect(), n_sectors, things, reject, hexen }
        },
    )
}

/// Whether a map is sound, by the definition.
fn sound(source: &DoomMapSource) -> bool {
    let vertex = |v: u16| source.vertices.get(usize::from(v));
    let sector = |s: Option<u16>| s.is_none_or(|s| s < source.n_sectors);
    let line = |l: &SourceLine| vertex(l.v1).zip(vertex(l.v2)).is_some() && sector(l.right) && sector(l.left);
    let long = |l: &SourceLine| vertex(l.v1) != vertex(l.v2);
    source.n_sectors > 0 && source.lines.iter().all(line) && source.lines.iter().any(long)
}

proptest! {
    /// Invariant: a map is read exactly if it is sound, and then it is what was written.
    #[test]
    fn maps_are_read_as_written(source in sources()) {
        let map = read(write_doom_map(name("MAP01"), &source).unwrap());
        prop_assert_eq!(map.is_ok(), sound(&source), "{:?}", map);
        let Ok(map) = map else { return Ok(()) };
        prop_assert_eq!(map.vertices(), &vertices(&source)[..]);
        prop_assert_eq!(map.things(), &things(&source)[..]);
        prop_assert_eq!(map.reject(), source.reject.as_deref());
        prop_assert_eq!((map.n_sectors(), map.format()), (u32::from(source.n_sectors), source.format()));
        let plan = map.plan().unwrap();
        let mut all_drawn = plan.lines().iter();
        for (line, written) in map.lines().iter().zip(&source.lines) {
            let sectors = [written.right, written.left].map(|s| s.map(u32::from));
            prop_assert_eq!((line.v1, line.v2, line.flags), (written.v1.into(), written.v2.into(), written.flags));
            prop_assert_eq!(map.sectors_of(line), sectors);
            let [start, end] = [written.v1, written.v2].map(|v| source.vertices[usize::from(v)].map(f64::from));
            if start == end {
                continue;
            }
            let drawn = all_drawn.next().expect("each line with length");
            prop_assert_eq!([drawn.right, drawn.left], sectors);
            prop_assert_eq!(drawn.opaque, written.flags & 4 == 0 && written.left.is_none());
            prop_assert_eq!([drawn.a.to_array(), drawn.b.to_array()], [start, end]);
        }
        prop_assert_eq!(all_drawn.next(), None);
        prop_assert_eq!(plan.lines().len() + map.n_lines_without_length(), map.lines().len());
    }

    /// Invariant: new tables change the tables and nothing else.
    #[test]
    fn rejects_change_nothing_else(
        first in sources(),
        second in sources(),
        tables in prop::collection::vec((0usize..2, prop::collection::vec(any::<u8>(), 0..5)), 0..3),
    ) {
        let mut builder = WadBuilder::new(WadKind::Game);
        builder.lump("REJECT", b"not of a map").unwrap().lump("X", b"x").unwrap();
        first.add_to(&mut builder, name("MAP01")).unwrap();
        builder.lump_named(LumpName::from_raw(*b"Y\0junk!!"), b"y").unwrap();
        second.add_to(&mut builder, name("MAP01")).unwrap();
        let wad = Wad::parse(builder.finish().unwrap()).unwrap();
        let maps = list_maps(&wad);
        let edits: Vec<_> = tables.iter().map(|(map, bytes)| (&maps[*map], bytes.clone())).collect();
        let after = Wad::parse(wad.with_rejects(&edits).unwrap()).unwrap();
        prop_assert_eq!(difference_besides_reject(&wad, &after), None);
        prop_assert_eq!(after.lump_bytes(0), b"not of a map");
        for (k, (map, source)) in list_maps(&after).iter().zip([&first, &second]).enumerate() {
            let given = tables.iter().rev().find(|(map, _)| *map == k).map(|(_, bytes)| bytes.clone());
            let found = map.lump(MapLump::Reject).map(|lump| after.lump_bytes(lump).to_vec());
            prop_assert_eq!(found, given.or_else(|| source.reject.clone()));
        }
    }
}

/// Node builders let tables of zeros share their bytes, of one size or of several.
#[test]
fn shared_tables_are_not_overwritten_by_each_other() {
    let mut source = two_rooms(false);
    let mut builder = WadBuilder::new(WadKind::Patch);
    source.add_to(&mut builder, name("MAP01")).unwrap();
    source.reject = Some(vec![0; 3]);
    source.add_to(&mut builder, name("MAP02")).unwrap();
    let mut bytes = builder.finish().unwrap();
    let wad = Wad::parse(bytes.clone()).unwrap();
    let [first, second] = [0, 1].map(|k| list_maps(&wad)[k].lump(MapLump::Reject).unwrap());
    let directory = bytes.len() - 16 * wad.lumps().len();
    for n in [1, 3] {
        // The first map's table is the first `n` of the second's three zeros.
        let place = [wad.lumps()[second].range().start as u32, n].map(u32::to_le_bytes).concat();
        bytes[directory + 16 * first..][..8].copy_from_slice(&place);
        let shared = Wad::parse(bytes.clone()).unwrap();
        let maps = list_maps(&shared);
        let table = vec![6; n as usize];
        let after = Wad::parse(shared.with_rejects(&[(&maps[0], table.clone())]).unwrap()).unwrap();
        assert_eq!(difference_besides_reject(&shared, &after), None);
        assert_eq!((after.lump_bytes(first), after.lump_bytes(second)), (&table[..], &[0; 3][..]));
        assert_eq!(shared.with_rejects(&[(&maps[0], vec![0; n as usize])]).unwrap(), bytes, "nothing changed");
    }
}
