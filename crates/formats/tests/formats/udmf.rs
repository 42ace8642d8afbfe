//! Maps as text: read as the binary maps they say the same as, refused by line and column, REJECT lumps in their place.

use crate::common::udmf::{as_text, text_of, wad_of_text};
use crate::common::{difference_besides_reject, line_of, small_wad, two_rooms};
use proptest::prelude::*;
use sightlines_formats::doom::{MapFormat, MapLump, list_maps, write_doom_map};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{DoomMap, LumpName, Malformed, Wad, WadError};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

fn read(text: &[u8]) -> Result<DoomMap, Malformed> {
    let wad = Wad::parse(wad_of_text(text, &[])).unwrap();
    DoomMap::parse(&wad, &list_maps(&wad)[0])
}

fn refused(text: &str) -> String {
    let error = read(text.as_bytes()).unwrap_err();
    error
        .to_string()
        .strip_prefix("map MAP01: TEXTMAP: ")
        .unwrap_or_else(|| panic!("the place comes first: {error}"))
        .to_owned()
}

/// The binary map of two rooms.
fn binary() -> DoomMap {
    let wad = Wad::parse(small_wad(&two_rooms(false))).unwrap();
    DoomMap::parse(&wad, &list_maps(&wad)[0]).unwrap()
}

/// A triangle, with `more` behind it.
fn triangle(more: &str) -> String {
    let text = "vertex { x = 0; y = 0; } vertex { x = 8; y = 0; } vertex { x = 0; y = 8; } sector {} sidedef { sector = 0; }\n\
                linedef { v1 = 0; v2 = 2; sidefront = 0; } linedef { v1 = 2; v2 = 1; sidefront = 0; }\n";
    format!("{text}{more}")
}

/// Whether two maps say the same; flags but the one that counts are not in a text.
fn assert_same(text: &DoomMap, binary: &DoomMap) {
    assert_eq!((text.format(), text.n_sectors()), (MapFormat::Udmf, binary.n_sectors()));
    assert_eq!((text.vertices(), text.things()), (binary.vertices(), binary.things()));
    assert_eq!(text.side_sectors(), binary.side_sectors());
    assert_eq!(text.lines().len(), binary.lines().len());
    for (a, b) in text.lines().iter().zip(binary.lines()) {
        assert_eq!((a.v1, a.v2, a.right, a.left), (b.v1, b.v2, b.right, b.left));
        assert_eq!(a.is_two_sided(), b.is_two_sided());
    }
    assert_eq!(text.plan().unwrap(), binary.plan().unwrap());
}

#[test]
fn a_text_says_what_the_binary_map_says() {
    let binary = binary();
    assert_same(&read(text_of(&binary).as_bytes()).unwrap(), &binary);
}

/// The impostor: a text with one number changed says something else.
#[test]
fn impostor_a_changed_text_is_noticed() {
    let binary = binary();
    let text = text_of(&binary);
    let (mut n_changed, mut n_same) = (0, 0);
    for (at, _) in text.match_indices(|c: char| c.is_ascii_digit()) {
        let mut changed = text.clone().into_bytes();
        changed[at] = if changed[at] == b'7' { b'5' } else { b'7' };
        let Ok(map) = read(&changed) else { continue };
        let same = std::panic::catch_unwind(|| assert_same(&map, &binary)).is_ok();
        if same { n_same += 1 } else { n_changed += 1 }
    }
    assert!(n_changed > 15 && n_same > 5, "{n_changed} changed, {n_same} in comments and where nothing counts");
}

#[test]
fn fractions_are_the_doubles_nearest_to_them() {
    let text = triangle("vertex { x = 0.1; y = -12345.678900000000000000000000001; } vertex { x = +.5; y = 1.e2; }");
    let map = read(text.as_bytes()).unwrap();
    assert_eq!(map.vertices()[3..], [[0.1, -12345.6789], [0.5, 100.0]]);
    // Numbers so close that they are one double make no line.
    let text = triangle(
        "linedef { v1 = 3; v2 = 4; } vertex { x = 0.1; y = 1; } vertex { x = 0.10000000000000000001; y = 1; }",
    );
    let map = read(text.as_bytes()).unwrap();
    assert_eq!((map.lines().len(), map.n_lines_without_length(), map.plan().unwrap().lines().len()), (3, 1, 2));
}

#[test]
fn what_the_text_does_not_say_has_its_default() {
    let map = read(triangle("linedef { v2 = 1; v1 = 0; v1 = 2; special = 9; };;").as_bytes()).unwrap();
    let line = map.lines()[2];
    assert_eq!((line.v1, line.v2, line.right, line.left, line.is_two_sided()), (2, 1, None, None, false));
    assert_eq!(map.things(), []);
    // Numbers in other ways than most programs write them.
    let map = read(
        triangle("linedef { v1 = 0x2; v2 = +1; sidefront = -1; } thing { x = +8.0; y = 1.6e+1; type = -0; }")
            .as_bytes(),
    );
    let (line, thing) = map.map(|m| (m.lines()[2], m.things()[0])).unwrap();
    assert_eq!((line.v1, line.v2, line.right, thing.x, thing.y, thing.kind), (2, 1, None, 8.0, 16.0, 0));
    for namespace in ["namespace = \"doom\";", "namespace = \"eternity\";", "ns = 5;", ""] {
        assert!(read(format!("{namespace}{}", triangle("")).as_bytes()).is_ok(), "{namespace}");
    }
}

#[test]
fn what_is_wrong_is_named_with_its_line_and_column() {
    let cases = [
        (
            "vertex { x = 0; y = 0; }\n  linedef { v1 = 0; v2 = 9; }",
            "line 2, column 3: linedef 0: vertex 9 is not among the 1 there are",
        ),
        (
            "linedef { v1 = 0; v2 = 0; sidefront = 3; } vertex { x = 0; y = 0; }",
            "line 1, column 1: linedef 0: sidedef 3 is not among the 0 there are",
        ),
        ("\nsidedef { sector = 1; } sector {}", "line 2, column 1: sidedef 0: sector 1 is not among the 1 there are"),
        ("vertex { x = 1; }", "line 1, column 1: vertex 0 has no y"),
        ("sector {} sidedef {}", "line 1, column 11: sidedef 0 has no sector"),
        ("linedef { v1 = 0; }", "line 1, column 1: linedef 0 has no v2"),
        ("thing { x = 0; y = 0; }", "line 1, column 1: thing 0 has no type"),
        ("vertex { x = \"1\"; y = 0; }", "line 1, column 14: x is a string, but it takes a number"),
        ("vertex { x = inf; y = 0; }", "line 1, column 14: x is inf, but it takes a number"),
        ("vertex { x = 1e400; y = 0; }", "line 1, column 14: x: coordinate inf is not a finite number"),
        (
            "vertex { x = 0;\ny = 1e-100; }",
            "line 2, column 5: y: coordinate 1e-100 is neither 0 nor between 2^-140 and 2^200 in magnitude",
        ),
        ("linedef { v1 = -1; v2 = 0; }", "line 1, column 16: v1 is -1, but it takes the number of a block"),
        ("linedef { v1 = 1.0; v2 = 0; }", "line 1, column 16: v1 is 1.0, but it takes the number of a block"),
        ("linedef { v1 = 010; v2 = 0; }", "line 1, column 16: v1 is 010, but it takes the number of a block"),
        (
            "linedef { v1 = 99999999999999999999; v2 = 0; }",
            "line 1, column 16: v1 is 99999999999999999999, but it takes the number of a block",
        ),
        (
            "linedef { v1 = 4294967296; v2 = 0; }",
            "line 1, column 16: v1 is 4294967296, but it takes the number of a block",
        ),
        ("linedef { v1 = 08; v2 = 0; }", "line 1, column 16: v1 is 08, but it takes the number of a block"),
        ("linedef { v1 = 0; v2 = 0; special = a; }", "line 1, column 37: special is a, but it takes a whole number"),
        ("linedef { v1 = 0x; v2 = 0; }", "line 1, column 16: v1 is 0x, but it takes the number of a block"),
        (
            "linedef { v1 = 0; v2 = 0; sideback = -2; }",
            "line 1, column 38: sideback is -2, but it takes the number of a block",
        ),
        ("linedef { v1 = 0; v2 = 0; twosided = 1; }", "line 1, column 38: twosided is 1, but it takes true or false"),
        (
            "thing { x = 0; y = 0; type = 2147483648; }",
            "line 1, column 30: type is 2147483648, but it takes a whole number",
        ),
        ("vertex { x = 1; y = 2 }", "line 1, column 23: ; is expected, not }"),
        ("vertex { inner { } }", "line 1, column 16: = is expected, not {"),
        ("vertex { x = { } }", "line 1, column 14: a value is expected, not {"),
        ("vertex { 5 = x; }", "line 1, column 10: a name or } is expected, not 5"),
        ("vertex {", "line 1, column 9: a name or } is expected, not the end of the text"),
        ("vertex", "line 1, column 7: = or { is expected, not the end of the text"),
        ("a = ;", "line 1, column 5: a value is expected, not ;"),
        ("}", "line 1, column 1: a name is expected, not }"),
        ("a = 1; \u{feff}b = 1;", "line 1, column 8: a name is expected, not \\xef\\xbb\\xbfb"),
        ("a = \"\n\n", "line 1, column 5: this string has no end"),
        ("// a\n/* b", "line 2, column 1: this comment has no end"),
    ];
    for (text, error) in cases {
        assert_eq!(refused(text), error, "{text}");
    }
    let long = format!("a {}", "b".repeat(1000));
    assert_eq!(refused(&long), format!("line 1, column 3: = or {{ is expected, not {}...", "b".repeat(24)));
}

#[test]
fn empty_texts_and_texts_without_an_end_are_refused() {
    assert_eq!(read(b"").unwrap_err().to_string(), "map MAP01: LINEDEFS: the map is empty");
    let point = "vertex { x = 0; y = 0; } linedef { v1 = 0; v2 = 0; } sector {}";
    assert_eq!(read(point.as_bytes()).unwrap_err().to_string(), "map MAP01: LINEDEFS: the map is empty");
    let line = "vertex { x = 0; y = 0; } vertex { x = 1; y = 0; } linedef { v1 = 0; v2 = 1; }";
    assert_eq!(read(line.as_bytes()).unwrap_err().to_string(), "map MAP01: SECTORS: the map is empty");
    let many = format!("{line}{}", "sector{}".repeat(65_537));
    let error = read(many.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "map MAP01: SECTORS: 65537 sectors are more than the 65536 that a map can have");

    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("MAP01", b"").unwrap().lump("TEXTMAP", triangle("").as_bytes()).unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let maps = list_maps(&wad);
    let error = DoomMap::parse(&wad, &maps[0]).unwrap_err();
    assert_eq!(error.to_string(), "map MAP01: ENDMAP: there is no such lump behind TEXTMAP");
    let name = LumpName::new("MAP01").unwrap();
    assert_eq!(wad.with_rejects(&[(&maps[0], vec![1])]), Err(WadError::NoPlace { map: name }));
}

/// Hostile texts cost no more than their length: a hundred thousand braces, a long word, blocks without content.
#[test]
fn hostile_texts_are_refused() {
    let n = 100_000;
    for (text, error) in [
        ("a{".repeat(n), "line 1, column 4: = is expected, not {"),
        ("{".repeat(n), "line 1, column 1: a name is expected, not {"),
        ("/* ".repeat(n), "line 1, column 1: this comment has no end"),
        ("\\\"".repeat(n), "line 1, column 1: a name is expected, not \\\\"),
        (
            format!("vertex {{ x = {}; y = e; }}", "9".repeat(n)),
            "line 1, column 14: x: coordinate inf is not a finite number",
        ),
        (
            format!("vertex {{ x = 0.{}; y = e; }}", "1".repeat(n)),
            "line 1, column 100022: y is e, but it takes a number",
        ),
        ("linedef { v1 = 1; v2 = 2; }".repeat(n), "line 1, column 1: linedef 0: vertex 1 is not among the 0 there are"),
    ] {
        assert_eq!(refused(&text), error, "{}", &text[..20]);
    }
}

/// A REJECT lump is replaced where it is, or put before ENDMAP; everything else keeps its bytes and its turn.
#[test]
fn rejects_stand_before_the_end_of_the_map() {
    let text = text_of(&binary());
    let others: [&[(&str, &[u8])]; 4] = [
        &[],
        &[("ZNODES", b"XGL3..."), ("BLOCKMAP", b"123"), ("BEHAVIOR", b"acs"), ("DIALOGUE", b"x"), ("OWN", b"y")],
        &[("REJECT", b"0"), ("ZNODES", b"XGLN")],
        &[("ZNODES", b"XGLN"), ("SECTORS", b"not one"), ("reject", b"")],
    ];
    for lumps in others {
        let wad = Wad::parse(wad_of_text(text.as_bytes(), lumps)).unwrap();
        let maps = list_maps(&wad);
        let after = Wad::parse(wad.with_rejects(&[(&maps[0], vec![6])]).unwrap()).unwrap();
        assert_eq!(difference_besides_reject(&wad, &after), None);
        let names: Vec<String> = after.lumps().iter().map(|l| l.name.to_string()).collect();
        let mut expected = vec!["BEFORE", "MAP01", "TEXTMAP"];
        expected.extend(lumps.iter().map(|l| l.0));
        if !lumps.iter().any(|l| l.0.eq_ignore_ascii_case("REJECT")) {
            expected.push("REJECT");
        }
        expected.extend(["ENDMAP", "BEHIND"]);
        assert_eq!(names, expected);
        let map = DoomMap::parse(&after, &list_maps(&after)[0]).unwrap();
        assert_eq!(map.reject(), Some(&[6][..]));
        assert_same(&map, &binary());
    }
    let twice = wad_of_text(text.as_bytes(), &[("REJECT", b"0"), ("REJECT", b"0")]);
    let wad = Wad::parse(twice).unwrap();
    let error = DoomMap::parse(&wad, &list_maps(&wad)[0]).unwrap_err();
    assert_eq!(error.to_string(), "map MAP01: REJECT: there are two such lumps, 3 and 4");
}

/// Several maps of both kinds in one file.
#[test]
fn texts_stand_beside_binary_maps() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    let name = |text| LumpName::new(text).unwrap();
    two_rooms(false).add_to(&mut builder, name("MAP01")).unwrap();
    let text = text_of(&binary());
    builder.lump("MAP02", b"").unwrap().lump("TEXTMAP", text.as_bytes()).unwrap().lump("ENDMAP", b"").unwrap();
    two_rooms(true).add_to(&mut builder, name("MAP03")).unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let maps = list_maps(&wad);
    assert_eq!(maps[1].text(), maps[1].range().nth(1));
    let tables: Vec<_> = maps.iter().zip(1u8..).map(|(m, k)| (m, vec![k; 7])).collect();
    let after = Wad::parse(wad.with_rejects(&tables).unwrap()).unwrap();
    assert_eq!(difference_besides_reject(&wad, &after), None);
    for (lumps, k) in list_maps(&after).iter().zip(1u8..) {
        assert_eq!(after.lump_bytes(lumps.lump(MapLump::Reject).unwrap()), [k; 7]);
        assert!(DoomMap::parse(&after, lumps).is_ok());
    }
}

/// Damaged texts are refused with a place inside the text, or read as a map whose every index is there.
#[test]
fn damaged_texts_are_read_or_refused() {
    let text = text_of(&binary());
    let n_lines = text.lines().count();
    let check = |bytes: &[u8]| match read(bytes) {
        Ok(map) => {
            let plan = map.plan().unwrap();
            assert_eq!(plan.lines().len(), map.lines().len() - map.n_lines_without_length());
            true
        }
        Err(error) => {
            if error.place.starts_with("map MAP01: TEXTMAP: ") {
                assert!(
                    (1..=bytes.len() + 1).contains(&line_of(&error)) && !error.place.contains("column 0"),
                    "{error}"
                );
            }
            false
        }
    };
    assert!(check(text.as_bytes()));
    let n_prefixes = (0..text.len()).filter(|&n| check(&text.as_bytes()[..n])).count();
    assert_eq!(n_prefixes, 2, "all but the line's end and the last semicolon are needed");
    let n_flipped = flipped_bits(text.as_bytes()).filter(|bytes| check(bytes)).count();
    let n_mutated = (0..10_000).filter(|&k| check(&mutate(text.as_bytes(), &mut SplitMix::new(k)))).count();
    eprintln!("{n_lines} lines, {n_flipped} of {} flipped, {n_mutated} of 10000 mutated were read", 8 * text.len());
    assert!(n_flipped > 1000 && n_flipped < 6 * text.len());
    assert!(n_mutated > 300 && n_mutated < 9000, "{n_mutated}");
}

proptest! {
    /// Invariant: any binary map that is read and its text say the same.
    #[test]
    fn texts_say_what_binary_maps_say(source in crate::maps::sources()) {
        let wad = Wad::parse(write_doom_map(LumpName::new("MAP01").unwrap(), &source).unwrap()).unwrap();
        let Ok(binary) = DoomMap::parse(&wad, &list_maps(&wad)[0]) else { return Ok(()) };
        let text = Wad::parse(as_text(&wad)).unwrap();
        assert_same(&DoomMap::parse(&text, &list_maps(&text)[0]).unwrap(), &binary);
    }
}

#[test]
fn what_has_no_end_is_named_where_it_begins() {
    for (text, error) in [
        ("a\n  /* b", "line 2, column 3: this comment has no end"),
        ("/*/", "line 1, column 1: this comment has no end"),
        ("a = \"b;\n", "line 1, column 5: this string has no end"),
        ("\"\\\"", "line 1, column 1: this string has no end"),
        ("\"\\", "line 1, column 1: this string has no end"),
    ] {
        assert_eq!(refused(text), error, "{text}");
    }
}

/// A byte order mark, zeros that fill the lump up, line ends of old programs, and numbers that all programs read the same way.
#[test]
fn texts_are_read_as_programs_write_them() {
    let text = triangle("linedef { v1 = 02; v2 = 001; sidefront = -01; special = 00; } // the last\n");
    let expected = read(triangle("linedef { v1 = 2; v2 = 1; }\n").as_bytes()).unwrap();
    let with = |before: &[u8], behind: &[u8]| [before, text.as_bytes(), behind].concat();
    for bytes in [
        with(b"", b""),
        with(b"\xEF\xBB\xBF", b""),
        with(b"", b"\0"),
        with(b"\xEF\xBB\xBF", &[0; 100]),
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
    ] {
        assert_same(&read(&bytes).unwrap(), &expected);
    }
    assert!(read(&with(b"\0", b"")).is_err() && read(&with(b"", b"\0 x")).is_err());
}
