//! Maps as text through every command that takes maps of Doom, and WADs with a map that cannot be done.

use crate::common::{Folder, doom_map, udmf, wad};
use serde_json::json;
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::wad::{WadBuilder, WadKind};
use sightlines::formats::{LumpName, Wad};

/// The REJECT lump of each map.
fn rejects(bytes: Vec<u8>) -> Vec<Vec<u8>> {
    let wad = Wad::parse(bytes).expect("a sound WAD");
    let lump = |map: DoomMap| map.reject().expect("a lump").to_vec();
    list_maps(&wad).iter().map(|lumps| lump(DoomMap::parse(&wad, lumps).expect("a sound map"))).collect()
}

/// A folder with `maps.wad`, and the same maps as text in `text.wad`.
fn with_both() -> Folder {
    let folder = Folder::new();
    let maps = wad(&["MAP01", "MAP03", "MAP04"]);
    folder.write("text.wad", udmf::as_text(&Wad::parse(maps.clone()).expect("a sound WAD")));
    folder.write("maps.wad", maps);
    folder
}

#[test]
fn texts_are_taken_like_binary_maps() {
    let folder = with_both();
    for (maps, out) in [("maps.wad", "binary.wad"), ("text.wad", "out.wad")] {
        folder.run(&["reject", maps, "-o", out]).expect(0);
    }
    assert_eq!(rejects(folder.read("out.wad")), rejects(folder.read("binary.wad")));
    let [before, after] = ["text.wad", "out.wad"].map(|name| Wad::parse(folder.read(name)).expect("a sound WAD"));
    let names = |wad: &Wad| wad.lumps().iter().map(|l| l.name.to_string()).collect::<Vec<_>>();
    assert_eq!(names(&after)[..5], ["MAP01", "TEXTMAP", "ZNODES", "REJECT", "ENDMAP"]);
    assert_eq!((before.lumps().len(), after.lumps().len()), (12, 15));

    let info = folder.run(&["info", "out.wad", "--json"]).expect(0).json();
    for map in info["maps"].as_array().expect("maps") {
        assert_eq!((&map["format"], &map["error"]), (&json!("UDMF"), &json!(null)), "{map}");
        assert!(map["n_rejected"].as_u64() > Some(0), "{map}");
    }
    // Tables of both forms are the same, and so is what is said of them.
    for (maps, table) in [("maps.wad", "binary.pvs"), ("text.wad", "text.pvs")] {
        folder.run(&["build", maps, "--map", "MAP03", "-o", table]).expect(0);
        folder.run(&["verify", table, maps, "--map", "MAP03", "--rays", "5000"]).expect(0);
        folder.run(&["draw", table, "--cell", "0", "-o", &format!("{table}.svg")]).expect(0);
    }
    assert!(folder.read("binary.pvs") == folder.read("text.pvs"));
    assert!(folder.read("binary.pvs.svg") == folder.read("text.pvs.svg"));
    let explain = |table| folder.run(&["explain", table, "0", "1"]);
    let [binary, text] = ["binary.pvs", "text.pvs"].map(explain);
    assert_eq!((binary.code, binary.out.replace("binary", "text")), (text.code, text.out));
    folder.run(&["verify", "out.wad", "text.wad", "--map", "MAP01", "--rays", "5000"]).expect(0);
    // The impostor: a table that hides everything is found out.
    let mut hidden = after.lumps().to_vec();
    hidden.retain(|l| l.name.is("REJECT"));
    let mut bytes = folder.read("out.wad");
    bytes[hidden[0].range()].fill(0xff);
    folder.write("hidden.wad", bytes);
    folder.run(&["verify", "hidden.wad", "text.wad", "--map", "MAP01", "--rays", "5000"]).expect(1);
}

/// A text that is wrong somewhere: file, map, line and column are named, and an output that was there stays.
#[test]
fn damaged_texts_are_named_with_their_place() {
    let folder = with_both();
    let wad = Wad::parse(folder.read("text.wad")).expect("a sound WAD");
    let whole = String::from_utf8(wad.lump_bytes(1).to_vec()).expect("a text");
    let at = whole.find("v2 = ").expect("a line");
    let line = whole[..at].lines().count();
    for (bad, place) in [
        (whole.replacen("v2 = ", "v2 = 99999", 1), format!("map MAP01: TEXTMAP: line {line}, column ")),
        (whole.replacen("v2 = ", "v2 ? ", 1), format!("map MAP01: TEXTMAP: line {line}, column ")),
        (
            format!("{whole}\"open"),
            format!("map MAP01: TEXTMAP: line {}, column 1: this string", whole.lines().count() + 1),
        ),
        (String::new(), "map MAP01: LINEDEFS: the map is empty".to_owned()),
    ] {
        folder.write("bad.wad", udmf::wad_of_text(bad.as_bytes(), &[]));
        for (command, out) in [("build", "out.pvs"), ("reject", "out.wad")] {
            folder.write(out, "precious");
            let error = folder.refused(&[command, "bad.wad", "-o", out]);
            assert!(error.starts_with(&format!("bad.wad: {place}")), "{error}");
            assert_eq!(folder.read(out), b"precious");
        }
        let info = folder.run(&["info", "bad.wad", "--json"]).expect(0).json();
        assert!(
            info["maps"][0]["error"].as_str().is_some_and(|e| place.contains(e) || e.contains("TEXTMAP")),
            "{info}"
        );
    }
    assert_eq!(folder.names(), ["bad.wad", "maps.wad", "out.pvs", "out.wad", "text.wad"]);
}

/// A WAD of three maps; the second has a line to nowhere, the third one without length.
fn with_bad_map() -> Folder {
    let folder = Folder::new();
    let mut builder = WadBuilder::new(WadKind::Patch);
    let [good, mut bad, mut odd] = [1, 2, 3].map(doom_map);
    bad.lines[4].v2 = 60_000;
    let line = odd.lines[0];
    odd.lines.push(sightlines::formats::doom::SourceLine { v2: line.v1, ..line });
    for (map, name) in [(good, "MAP01"), (bad, "MAP02"), (odd, "MAP03")] {
        map.add_to(&mut builder, LumpName::new(name).expect("a short name")).expect("a small map");
    }
    folder.write("some.wad", builder.finish().expect("a small file"));
    folder
}

#[test]
fn a_map_that_cannot_be_done_does_not_stop_the_others() {
    let folder = with_bad_map();
    let place = "map MAP02: LINEDEFS 4: vertex 60000 is not among the ";
    let run = folder.run(&["reject", "some.wad", "-o", "out.wad"]).expect(0);
    assert!(run.out.ends_with("wrote out.wad: 2 of 3 maps built\n"), "{}", run.out);
    assert!(run.out.contains(&format!("MAP02    failed: {place}")), "{}", run.out);
    let warnings: Vec<&str> = run.err.lines().collect();
    assert_eq!(warnings.len(), 2, "{}", run.err);
    assert!(warnings[0].contains(&format!("some.wad: not done: {place}")), "{}", run.err);
    assert!(warnings[1].contains("some.wad: map MAP03: 1 line without length left out"), "{}", run.err);

    let reply = folder.run(&["reject", "some.wad", "-o", "again.wad", "--json", "-q"]).expect(0);
    let maps = reply.json()["maps"].clone();
    let status = |k: usize| maps[k]["status"].as_str().expect("a word").to_owned();
    assert_eq!([status(0), status(1), status(2)], ["written", "failed", "written"]);
    assert!(maps[1]["reason"].as_str().is_some_and(|r| r.starts_with(place)), "{maps}");
    assert_eq!((&maps[0]["reason"], &maps[1]["n_rejected"]), (&json!(null), &json!(null)));
    let without_length = [0, 1, 2].map(|k| maps[k]["n_lines_without_length"].clone());
    assert_eq!(without_length, [json!(0), json!(null), json!(1)]);
    assert_eq!((reply.err.as_str(), folder.read("again.wad")), ("", folder.read("out.wad")));

    // With --strict, or asked for by name, it is an error, and nothing is written.
    for more in [&["--strict"][..], &["--map", "MAP02"], &["--map", "MAP01", "--map", "MAP02"]] {
        let error = folder.refused(&[&["reject", "some.wad", "-o", "none.wad"], more].concat());
        assert!(error.starts_with(&format!("some.wad: {place}")), "{error}");
    }
    folder.run(&["reject", "some.wad", "-o", "one.wad", "--map", "MAP01", "--strict"]).expect(0);
    assert_eq!(folder.names(), ["again.wad", "one.wad", "out.wad", "some.wad"]);
}
