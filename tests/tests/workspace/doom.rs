//! REJECT tables of real Doom maps against what an independent program saw.

use sightlines::bake::reject::{RejectOptions, reject_table, reject_wad};
use sightlines::formats::doom::{DoomMap, list_maps};
use sightlines::formats::{RejectTable, Wad};
use sightlines_testkit::sampled_sector_visibility;
use sightlines_tests::{Comparison, data_folder, files};
use std::path::Path;

#[path = "../../../crates/formats/tests/formats/common/udmf.rs"]
mod udmf;

/// Rejected over not seen that the pooled tables must reach.
const TIGHT: f64 = 0.9997;

/// The only map of a WAD, its old REJECT ignored, with the new one.
fn reject_of(path: &Path, threads: usize) -> (Wad, u32, Vec<u8>) {
    let wad = Wad::read(path).unwrap_or_else(|e| panic!("{e}"));
    let options = RejectOptions { force: true, threads, ..RejectOptions::default() };
    let outcome = reject_wad(&wad, &options).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let new = Wad::parse(outcome.bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let maps = list_maps(&new);
    let map = DoomMap::parse(&new, &maps[0]).unwrap_or_else(|e| panic!("{e}"));
    let bytes = map.reject().expect("a REJECT lump was written").to_vec();
    (wad, map.n_sectors(), bytes)
}

#[test]
fn real_maps_reject_nothing_that_was_seen_and_almost_all_that_was_not() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    let mut all = Comparison::default();
    let mut n_maps = 0;
    for path in files(&folder.join("doom"), "wad") {
        let seen = std::fs::read(path.with_extension("seen.bin")).expect("a witness table");
        let (_, n_sectors, reject) = reject_of(&path, 1);
        let one = Comparison::of(n_sectors, &reject, &seen);
        assert_eq!(one.n_wrong, 0, "{} rejects pairs that were seen", path.display());
        all = all.plus(one);
        n_maps += 1;
    }
    assert!(n_maps >= 18, "{n_maps} maps");
    assert!(all.tightness() >= TIGHT, "{} over {n_maps} maps", all.tightness());
    eprintln!("{n_maps} maps: {all:?}, tightness {:.6}", all.tightness());
}

#[test]
fn real_maps_give_symmetric_tables_with_any_number_of_threads() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    for path in files(&folder.join("doom"), "wad").into_iter().step_by(3) {
        let (_, n, one) = reject_of(&path, 1);
        let (_, _, three) = reject_of(&path, 3);
        assert_eq!(one, three, "{}", path.display());
        let table = RejectTable::from_bytes(n, &one).expect("the right length");
        assert!(!table.has_hand_made_effects(), "{}", path.display());
    }
}

/// All 100 maps of Freedoom: no pair that a random chord joins is rejected, and the tables are within
/// a few pairs of the shipped ones, which another builder made.
#[test]
fn freedoom_maps_reject_nothing_that_chords_join() {
    const CHORDS: usize = 3_000;
    let Some(folder) = data_folder("SIGHTLINES_FREEDOOM") else { return };
    let (mut n_maps, mut n_seen) = (0, 0u64);
    let (mut only_shipped, mut only_ours) = (0u64, 0u64);
    for name in ["freedoom1.wad", "freedoom2.wad", "freedm.wad"] {
        let wad = Wad::read(folder.join(name)).unwrap_or_else(|e| panic!("{e}"));
        for lumps in list_maps(&wad) {
            let map = DoomMap::parse(&wad, &lumps).unwrap_or_else(|e| panic!("{name}: {e}"));
            let (table, _) = reject_table(&map, &RejectOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            let plan = map.plan().expect("a plan");
            let seen = sampled_sector_visibility(&plan, n_maps, CHORDS);
            for (a, b) in
                (0..).zip(&seen).flat_map(|(a, row)| (0..).zip(row).filter(|(_, v)| **v).map(move |(b, _)| (a, b)))
            {
                assert!(!table.get(a, b), "{name} {}: sector {a} sees {b}", map.name());
                n_seen += 1;
            }
            let shipped = map.reject().and_then(|b| RejectTable::from_bytes(map.n_sectors(), b).ok());
            let shipped = shipped.unwrap_or_else(|| panic!("{name} {}: no REJECT", map.name()));
            for (&s, &t) in shipped.as_bytes().iter().zip(table.as_bytes()) {
                only_shipped += u64::from((s & !t).count_ones());
                only_ours += u64::from((t & !s).count_ones());
            }
            n_maps += 1;
        }
    }
    assert_eq!(n_maps, 100);
    assert!(n_seen > 30_000, "{n_seen} pairs seen");
    // The other builder hides 662 entries that an independent program proved visible, and ten that the
    // flat model shows because two sectors share a region; it shows 46 that nothing sees.
    assert_eq!((only_shipped, only_ours), (672, 46), "entries rejected by one of the two builders only");
    eprintln!("{n_maps} maps: {n_seen} entries seen");
}

/// Invariant: a real map as text has the table of the binary one, byte for byte.
#[test]
fn real_maps_as_text_have_the_same_tables() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    let mut n_maps = 0;
    for path in files(&folder.join("doom"), "wad") {
        let (wad, n_sectors, reject) = reject_of(&path, 1);
        let text = Wad::parse(udmf::as_text(&wad)).expect("a sound WAD");
        let map = DoomMap::parse(&text, &list_maps(&text)[0]).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(map.n_sectors(), n_sectors);
        let options = RejectOptions { threads: 1, ..RejectOptions::default() };
        let (table, _) = reject_table(&map, &options).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert!(table.as_bytes() == reject, "{}", path.display());
        // The impostor: the other hand of each line.
        let swapped = udmf::text_of(&map).replace("sidefront", "side").replace("sideback", "sidefront");
        let swapped = swapped.replace("side =", "sideback =");
        let swapped = Wad::parse(udmf::wad_of_text(swapped.as_bytes(), &[])).expect("a sound WAD");
        let other = DoomMap::parse(&swapped, &list_maps(&swapped)[0]).unwrap_or_else(|e| panic!("{e}"));
        let (other, _) = reject_table(&other, &options).unwrap_or_else(|e| panic!("{e}"));
        assert!(other != table, "{}", path.display());
        n_maps += 1;
    }
    assert!(n_maps >= 18, "{n_maps} maps");
    eprintln!("{n_maps} maps as text");
}

/// Known traps: a sector all of whose lines have it on both sides, and a slit of 0.06 units.
#[test]
fn real_maps_known_traps_are_avoided() {
    let Some(folder) = data_folder("SIGHTLINES_DATA") else { return };
    let (_, n, bytes) = reject_of(&folder.join("doom/freedoom1_E1M6.wad"), 1);
    let table = RejectTable::from_bytes(n, &bytes).expect("the right length");
    let seen_from_390 = (0..n).filter(|&s| !table.get(390, s)).count();
    assert!(seen_from_390 > 100, "sector 390 sees {seen_from_390} sectors");
    let (_, n, bytes) = reject_of(&folder.join("doom/freedoom1_E1M3.wad"), 1);
    let table = RejectTable::from_bytes(n, &bytes).expect("the right length");
    assert!(!table.get(101, 200) && !table.get(200, 101));
}

/// The impostor: a table with one seen pair rejected is found wrong, and one that rejects nothing is
/// found loose.
#[test]
fn comparisons_can_fail() {
    let seen = [0b0000_1001u8, 0];
    let right = [0b1111_0110u8, 0b1];
    assert_eq!(Comparison::of(3, &right, &seen).n_wrong, 0);
    assert_eq!(Comparison::of(3, &right, &seen).tightness(), 1.0);
    assert_eq!(Comparison::of(3, &[0b1111_1110, 1], &seen).n_wrong, 1);
    assert!(Comparison::of(3, &[0, 0], &seen).tightness() < TIGHT);
}
