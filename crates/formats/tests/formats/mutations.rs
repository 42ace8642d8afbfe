//! Broken input: thousands of damaged files, none of which may cause a panic or a value that is
//! inconsistent in itself.
//!
//! The same files every time, unless `SIGHTLINES_FUZZ_ROUNDS` asks for another number of files per
//! reader and `SIGHTLINES_FUZZ_SEED` for others. A failure names what replays its one file.

use crate::common::{SMALL_GEOJSON, difference_besides_reject, setting, small_wad, two_rooms};
use sightlines_formats::doom::{MapLump, list_maps};
use sightlines_formats::geojson::{parse_plan, write_plan};
use sightlines_formats::{DoomMap, RejectTable, Wad};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

/// Reads a WAD and all its maps as far as they can be read; returns how many maps could.
fn check_wad(bytes: &[u8]) -> Option<usize> {
    let wad = Wad::parse(bytes.to_vec()).ok()?;
    assert_eq!(wad.with_rejects(&[]).unwrap(), bytes);
    for (k, lump) in wad.lumps().iter().enumerate() {
        assert_eq!(wad.lump_bytes(k).len(), lump.size());
    }
    let maps = list_maps(&wad);
    let mut n_readable = 0;
    for lumps in &maps {
        match DoomMap::parse(&wad, lumps) {
            Ok(map) => {
                check_map(&map);
                n_readable += 1;
            }
            Err(error) => assert!(error.to_string().starts_with(&format!("map {}: ", lumps.name()))),
        }
    }
    let tables: Vec<_> = maps.iter().filter(|m| m.lump(MapLump::Sectors).is_some()).map(|m| (m, vec![7; 5])).collect();
    let after = Wad::parse(wad.with_rejects(&tables).unwrap()).unwrap();
    assert_eq!(difference_besides_reject(&wad, &after), None);
    for map in list_maps(&after).iter().filter(|m| m.lump(MapLump::Sectors).is_some()) {
        assert_eq!(after.lump_bytes(map.lump(MapLump::Reject).unwrap()), [7; 5]);
    }
    Some(n_readable)
}

/// Uses every index of a map.
fn check_map(map: &DoomMap) {
    let plan = map.plan().unwrap();
    assert_eq!(plan.lines().len() + map.n_lines_without_length(), map.lines().len());
    assert_eq!(plan.objects().len(), map.things().len());
    assert!(!plan.lines().is_empty() && plan.n_groups() <= map.n_sectors());
    let corners = |l: &sightlines_formats::doom::LineDef| [l.v1, l.v2].map(|v| map.vertices()[v as usize]);
    let with_length = map.lines().iter().filter(|l| corners(l)[0] != corners(l)[1]);
    for (line, def) in plan.lines().iter().zip(with_length) {
        assert!(line.a != line.b && line.opaque <= !(def.is_two_sided() || def.left.is_some()));
        assert_eq!([line.right, line.left], map.sectors_of(def));
    }
    if let Some(Ok(table)) = map.reject().map(|bytes| RejectTable::from_bytes(map.n_sectors(), bytes)) {
        table.has_hand_made_effects();
    }
}

fn check_geojson(text: &[u8]) -> Option<usize> {
    let plan = parse_plan(text).ok()?;
    assert_eq!(parse_plan(write_plan(&plan).as_bytes()).unwrap(), plan);
    Some(plan.lines().len())
}

/// Runs the mutations of `seed`; both what is accepted and what is refused must be well represented, or
/// the mutations would not test what they should.
fn run(seed: &[u8], check: fn(&[u8]) -> Option<usize>) {
    assert!(check(seed).is_some_and(|n| n > 0), "the seed itself is read");
    let (rounds, first) = (setting("SIGHTLINES_FUZZ_ROUNDS", 5_000), setting("SIGHTLINES_FUZZ_SEED", 0));
    let mut accepted = 0;
    for number in first..first + rounds {
        let broken = mutate(seed, &mut SplitMix::new(number));
        let checked = std::panic::catch_unwind(|| check(&broken));
        let Ok(result) = checked else {
            panic!("replay with SIGHTLINES_FUZZ_ROUNDS=1 SIGHTLINES_FUZZ_SEED={number}: {broken:?}")
        };
        accepted += u64::from(result.is_some());
    }
    let both = (rounds / 100..=rounds * 95 / 100).contains(&accepted);
    assert!(both || rounds < 1000, "{accepted} of {rounds} accepted");
}

#[test]
fn damaged_doom_wads_are_read_or_refused() {
    run(&small_wad(&two_rooms(false)), check_wad);
}

#[test]
fn damaged_hexen_wads_are_read_or_refused() {
    run(&small_wad(&two_rooms(true)), check_wad);
}

#[test]
fn damaged_geojson_is_read_or_refused() {
    run(SMALL_GEOJSON.as_bytes(), check_geojson);
}

#[test]
fn every_prefix_is_refused() {
    for wad in [small_wad(&two_rooms(false)), small_wad(&two_rooms(true))] {
        // The directory is at the end, so no prefix has all of it.
        assert!((0..wad.len()).all(|len| check_wad(&wad[..len]).is_none()));
    }
    let text = SMALL_GEOJSON.as_bytes();
    assert!((0..text.len()).all(|len| check_geojson(&text[..len]).is_none()));
}

#[test]
fn every_flipped_bit_is_read_or_refused() {
    for seed in [small_wad(&two_rooms(false)), small_wad(&two_rooms(true))] {
        for bytes in flipped_bits(&seed) {
            check_wad(&bytes);
        }
    }
    for text in flipped_bits(SMALL_GEOJSON.as_bytes()) {
        check_geojson(&text);
    }
}
