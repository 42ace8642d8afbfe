//! REJECT tables of maps as text: those of the binary maps that they say the same as, and of coordinates that only texts have.

use crate::reject::{build, crossing_map, other_lumps, read, rejects, wad_of};
use proptest::prelude::*;
use sightlines_bake::{MapStatus, RejectOptions, reject_wad};
use sightlines_formats::Wad;
use sightlines_testkit::draw;

#[path = "../../../formats/tests/formats/common/udmf.rs"]
mod udmf;

fn reject_lumps(wad: &Wad) -> Vec<Option<Vec<u8>>> {
    let outcome = reject_wad(wad, &RejectOptions { force: true, threads: 1, ..RejectOptions::default() }).unwrap();
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
