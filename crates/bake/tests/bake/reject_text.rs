//! REJECT tables of maps as text: those of the binary maps that they say the same as, and of coordinates that only texts have.

use crate::reject::{BLIND, FOR_DOOM, build, crossing_map, other_lumps, read, rejects, three_maps, wad_of};
use proptest::prelude::*;
use sightlines_bake::{MapStatus, RejectOptions, reject_wad};
use sightlines_formats::Wad;
use sightlines_formats::doom::RmbFile;
use sightlines_testkit::draw;

#[path = "../../../formats/tests/formats/common/udmf.rs"]
pub(crate) mod udmf;

fn reject_lumps(wad: &Wad) -> Vec<Option<Vec<u8>>> {
    let outcome = reject_wad(wad, &RejectOptions { force: true, ..FOR_DOOM }).unwrap();
    rejects(&Wad::parse(outcome.bytes).unwrap())
}

proptest! {
    /// Invariant: a binary map and its text have the same table, byte for byte, also after the table was written once.
    #[test]
    fn texts_have_the_tables_of_binary_maps(map in crossing_map()) {
        let wad = wad_of(&map);
        let text = Wad::parse(udmf::as_text(&wad)).unwrap();
        let lumps = reject_lumps(&text);
        prop_assert_eq!(&lumps, &reject_lumps(&wad));
        let outcome = build(&text, &[], true).unwrap();
        let again = Wad::parse(outcome.bytes).unwrap();
        prop_assert_eq!(other_lumps(&again), other_lumps(&text));
        prop_assert_eq!(build(&again, &[], true).unwrap().bytes, again.as_bytes());
    }
}

/// The impostor: a text whose walls are open has another table.
#[test]
fn a_text_that_says_something_else_has_another_table() {
    let mut n_different = 0;
    for map in draw(&crossing_map(), 40) {
        let wad = wad_of(&map);
        let text = String::from_utf8(udmf::text_of(&read(&wad)).into_bytes()).unwrap();
        let open = text.replace("sideback", "twosided = true; sideback").replace("twosided = false;", "");
        let open = Wad::parse(udmf::wad_of_text(open.as_bytes(), &[])).unwrap();
        n_different += usize::from(reject_lumps(&open) != reject_lumps(&wad));
    }
    assert!(n_different > 5, "{n_different} of 40");
}

/// Coordinates between those of binary maps count: a slit of 1/1000 unit shows, and shut it does not.
#[test]
fn slits_between_fractions_are_seen_through() {
    let text = |gap: &str| {
        let mut text = String::new();
        for [x, y] in [["0", "0"], ["0", "4"], ["4", "4"], ["8", "4"], ["8", "0"], ["4", "0"], ["4", "2"], ["4", gap]] {
            text += &format!("vertex {{ x = {x}; y = {y}; }}\n");
        }
        let lines = [(5, 0, 0, -1), (0, 1, 0, -1), (1, 2, 0, -1), (2, 3, 1, -1), (3, 4, 1, -1), (4, 5, 1, -1)];
        let walls = [(5, 6, 1, 0), (7, 2, 1, 0)];
        for (v1, v2, right, left) in lines.into_iter().chain(walls) {
            text += &format!("linedef {{ v1 = {v1}; v2 = {v2}; sidefront = {right}; sideback = {left}; }}\n");
        }
        text += "linedef { v1 = 6; v2 = 7; sidefront = 1; sideback = 0; twosided = true; }\n";
        text + "sidedef { sector = 0; } sidedef { sector = 1; } sector {} sector {}"
    };
    let lump = |gap| reject_lumps(&Wad::parse(udmf::wad_of_text(text(gap).as_bytes(), &[])).unwrap());
    assert_eq!(lump("2.001"), [Some(vec![0])]);
    assert_eq!(lump("2.0000000000001"), [Some(vec![0])]);
    // Shut: a line without length, which is left out.
    assert_eq!(lump("2"), [Some(vec![0b0110])]);
    assert_eq!(lump("2.00000000000000000000000001"), [Some(vec![0b0110])]);
    let shut = Wad::parse(udmf::wad_of_text(text("2").as_bytes(), &[])).unwrap();
    let outcome = build(&shut, &[], false).unwrap();
    let MapStatus::Written(summary) = outcome.maps[0].status else { panic!("{:?}", outcome.maps) };
    assert_eq!((summary.n_lines_without_length, summary.n_rejected), (1, 2));
}

// --- Effects of option files -------------------------------------------------------------------------

/// Effects are made in the table that was built, on the maps that they are for; their tables are replaced whatever they were.
#[test]
fn effects_are_made_in_built_tables() {
    let wad = three_maps(&BLIND);
    let plain = rejects(&Wad::parse(build(&wad, &[], true).unwrap().bytes).unwrap());
    let with = |text: &[u8]| {
        let rmb = RmbFile::parse(text).unwrap();
        reject_wad(&wad, &RejectOptions { rmb: Some(&rmb), threads: 1, ..RejectOptions::default() })
    };
    let outcome = with(b"MAP02\nINCLUDE (0) (1)\nMAP01\nBLIND 0 (1)").unwrap();
    let numbers: Vec<(u64, u64)> = outcome
        .maps
        .iter()
        .map(|m| match &m.status {
            MapStatus::Written(summary) => (summary.n_effects, summary.n_rejected),
            other => panic!("{other:?}"),
        })
        .collect();
    let rejected = |k: usize| u64::from(plain[k].as_ref().unwrap().iter().map(|b| b.count_ones()).sum::<u32>());
    assert_eq!(numbers, [(1, rejected(0) + 1), (1, rejected(1) - 1), (0, rejected(2))]);
    let made = rejects(&Wad::parse(outcome.bytes).unwrap());
    assert_eq!(made, [Some(vec![0b1110]), Some(vec![0b0100]), plain[2].clone()]);
    // A map without effects keeps what was made by hand.
    assert_eq!(with(b"MAP01\nSAFE 0 (1)").unwrap().maps[1].status, MapStatus::KeptHandMade);
    let error = with(b"# all maps\nSAFE 0 (2)").unwrap_err();
    assert_eq!(error.to_string(), "line 2: sector 2 is not among the 2 of map MAP01");
}
