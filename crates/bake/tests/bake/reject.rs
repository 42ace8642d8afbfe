//! REJECT tables of made maps: the traps by hand, any crossing lines against brute force, and what
//! becomes of the file around them.

use proptest::prelude::*;
use sightlines_bake::{MapStatus, RejectError, RejectOptions, RejectOutcome, RejectSummary, reject_table, reject_wad};
use sightlines_formats::doom::{DoomMapSource, Game, ML_TWOSIDED, MapFormat, SourceLine, list_maps, write_doom_map};
use sightlines_formats::wad::WadKind;
use sightlines_formats::{DoomMap, LumpName, RejectTable, Wad, WadBuilder};
use sightlines_progress::Units;
use sightlines_testkit::{draw, sector_visibility_brute_force};

// --- Drawing maps ------------------------------------------------------------------------------------

/// A flag of a line that players cannot cross, whatever sight does.
pub(crate) const BLOCKING: u16 = 1;

/// Flags count, whatever sides lines have; the other engines have tests of their own.
pub(crate) const FOR_DOOM: RejectOptions<'_> = RejectOptions {
    maps: Vec::new(),
    force: false,
    strict: false,
    game: Some(Game::Doom),
    rmb: None,
    threads: 1,
    progress: None,
    units: Units(None),
};

pub(crate) type Corner = [i16; 2];

/// A map, drawn line by line.
#[derive(Debug, Clone)]
pub(crate) struct Sketch(pub(crate) DoomMapSource);

impl Sketch {
    pub(crate) fn new(n_sectors: u16) -> Self {
        let (vertices, lines, things) = Default::default();
        Self(DoomMapSource { vertices, lines, n_sectors, things, reject: None, hexen: false })
    }

    fn vertex(&mut self, corner: Corner) -> u16 {
        let known = self.0.vertices.iter().position(|&v| v == corner);
        let index = known.unwrap_or_else(|| {
            self.0.vertices.push(corner);
            self.0.vertices.len() - 1
        });
        u16::try_from(index).expect("a small map")
    }

    pub(crate) fn line(mut self, [a, b]: [Corner; 2], flags: u16, right: Option<u16>, left: Option<u16>) -> Self {
        let (v1, v2) = (self.vertex(a), self.vertex(b));
        self.0.lines.push(SourceLine { v1, v2, flags, right, left });
        self
    }

    /// One-sided lines from corner to corner, `sector` on their right hand.
    pub(crate) fn walls(self, corners: &[Corner], sector: u16) -> Self {
        corners.windows(2).fold(self, |map, w| map.line([w[0], w[1]], BLOCKING, Some(sector), None))
    }

    /// Two-sided lines from corner to corner.
    pub(crate) fn open(self, corners: &[Corner], right: u16, left: u16) -> Self {
        corners.windows(2).fold(self, |map, w| map.line([w[0], w[1]], ML_TWOSIDED, Some(right), Some(left)))
    }

    /// A closed room, its sides clockwise, so that `sector` is on their right hand.
    pub(crate) fn room(self, low: Corner, high: Corner, sector: u16) -> Self {
        self.walls(&ring(low, high), sector)
    }
}

/// The corners of a box, clockwise, the first again at the end.
pub(crate) fn ring([x0, y0]: Corner, [x1, y1]: Corner) -> [Corner; 5] {
    [[x0, y0], [x0, y1], [x1, y1], [x1, y0], [x0, y0]]
}

/// Rooms 0 (west) and 1 (east), and the line between them, going north.
fn two_rooms(n_sectors: u16, between: impl Fn(Sketch, [Corner; 2]) -> Sketch) -> Sketch {
    let map = Sketch::new(n_sectors).walls(&[[64, 0], [0, 0], [0, 64], [64, 64]], 0);
    between(map.walls(&[[64, 64], [128, 64], [128, 0], [64, 0]], 1), [[64, 0], [64, 64]])
}

pub(crate) fn with_door(n_sectors: u16) -> Sketch {
    two_rooms(n_sectors, |map, line| map.open(&line, 1, 0))
}

pub(crate) fn with_wall(n_sectors: u16) -> Sketch {
    two_rooms(n_sectors, |map, line| map.line(line, BLOCKING, Some(1), None))
}

fn name(text: &str) -> LumpName {
    LumpName::new(text).unwrap()
}

pub(crate) fn wad_of(map: &Sketch) -> Wad {
    Wad::parse(write_doom_map(name("MAP01"), &map.0).unwrap()).unwrap()
}

pub(crate) fn read(wad: &Wad) -> DoomMap {
    DoomMap::parse(wad, &list_maps(wad)[0]).unwrap()
}

/// The table in the lump that is written for a map, by way of the file.
fn table(map: &Sketch) -> RejectTable {
    let outcome = reject_wad(&wad_of(map), &RejectOptions { force: true, ..FOR_DOOM }).unwrap();
    let MapStatus::Written(summary) = outcome.maps[0].status else { panic!("a table is written") };
    let map = read(&Wad::parse(outcome.bytes).unwrap());
    let table = RejectTable::from_bytes(map.n_sectors(), map.reject().expect("a lump")).unwrap();
    assert_eq!(summary.n_rejected, table.n_rejected());
    assert!(!table.has_hand_made_effects(), "tables are symmetric, and no sector is rejected from itself");
    table
}

/// The pairs that are not rejected, each once, without those of a sector and itself.
fn visible(map: &Sketch) -> Vec<(u32, u32)> {
    let table = table(map);
    let pairs = (0..table.n_sectors()).flat_map(|a| (a + 1..table.n_sectors()).map(move |b| (a, b)));
    pairs.filter(|&(a, b)| !table.get(a, b)).collect()
}

// --- The flat model, trap by trap --------------------------------------------------------------------

#[test]
fn a_door_is_seen_through_and_a_wall_is_not() {
    assert_eq!(table(&with_door(2)).as_bytes(), [0]);
    // Rows 01 and 10, least significant bit first.
    assert_eq!(table(&with_wall(2)).as_bytes(), [0b0110]);
    // The same in the other format.
    for (mut map, bits) in [(with_door(2), 0), (with_wall(2), 0b0110)] {
        map.0.hexen = true;
        assert_eq!((map.0.format(), table(&map).as_bytes()), (MapFormat::Hexen, &[bits][..]));
    }
}

/// Rooms 0 and 2 lie side by side in the west, room 1 in the east is open to both. A line that leaves
/// room 0 into room 1 never comes back, so the open way from 0 by 1 to 2 shows nothing of 2.
#[test]
fn open_ways_without_a_line_through_them_are_rejected() {
    let map = |between: u16| {
        let map = Sketch::new(3).walls(&[[64, 0], [0, 0], [0, 64]], 0).walls(&[[0, 64], [0, 128], [64, 128]], 2);
        let map = map.walls(&[[64, 128], [128, 128], [128, 0], [64, 0]], 1);
        let map = map.open(&[[64, 0], [64, 64]], 1, 0).open(&[[64, 64], [64, 128]], 1, 2);
        map.line([[0, 64], [63, 64]], BLOCKING, Some(0), Some(2)).line([[63, 64], [64, 64]], between, Some(0), Some(2))
    };
    assert_eq!(visible(&map(BLOCKING)), [(0, 1), (1, 2)]);
    assert_eq!(visible(&map(ML_TWOSIDED)), [(0, 1), (0, 2), (1, 2)], "through a slit of one unit");
}

/// All lines of sector 1 have it on both sides: it is visible from the room around it and from whatever sees that part
/// of the room, and from nowhere else.
#[test]
fn self_referencing_sectors_are_seen_from_around_and_from_what_sees_them() {
    // A door in the low third of the wall between rooms 0 and 2, a closed room 3.
    let map = Sketch::new(4).walls(&[[64, 0], [0, 0], [0, 192], [64, 192]], 0).open(&[[64, 0], [64, 64]], 2, 0);
    let map = map.line([[64, 64], [64, 192]], BLOCKING, Some(2), Some(0));
    let map = map.walls(&[[64, 192], [128, 192], [128, 0], [64, 0]], 2).room([200, 0], [264, 64], 3);
    assert_eq!(visible(&map), [(0, 2)]);
    let around = map.open(&ring([16, 16], [48, 48]), 1, 1);
    assert_eq!(visible(&around), [(0, 1), (0, 2), (1, 2)]);
    // Of a few lines only, not even closed.
    let open = |lines: &[Corner]| {
        let map = Sketch::new(4).room([0, 0], [64, 64], 0).room([100, 0], [164, 64], 2).room([200, 0], [264, 64], 3);
        visible(&map.open(lines, 1, 1))
    };
    assert_eq!(open(&[[16, 16], [32, 16]]), [(0, 1)]);
    assert_eq!(open(&[[116, 16], [132, 16], [132, 32]]), [(1, 2)]);
    // A ring that is one-sided hides what is in it.
    let closed = ring([16, 16], [48, 48]);
    let pillar = closed
        .windows(2)
        .fold(Sketch::new(3).room([0, 0], [64, 64], 0), |map, w| map.line([w[0], w[1]], BLOCKING, Some(1), Some(0)));
    assert_eq!(visible(&pillar), []);
}

/// Sector 1 names three sides of a box only, so that it leaks into the room around it.
#[test]
fn unclosed_sectors_share_the_region_that_they_leak_into() {
    let niche = ring([16, 16], [48, 48]);
    let room = Sketch::new(3).room([0, 0], [64, 64], 0).room([100, 0], [164, 64], 2);
    let leaking = room.clone().walls(&niche[1..], 1);
    assert_eq!(visible(&leaking), [(0, 1)]);
    // The outside of an unclosed room is its inside.
    let unclosed = Sketch::new(2).walls(&[[0, 0], [0, 64], [64, 64], [64, 0]], 0).room([200, 0], [264, 64], 1);
    assert_eq!(visible(&unclosed), [], "room 1 is closed");
    let both = Sketch::new(2).walls(&[[0, 0], [0, 64], [64, 64], [64, 0]], 0).walls(&[[200, 64], [200, 0]], 1);
    assert_eq!(visible(&both), [(0, 1)], "both lie in the outside");
    // Closed again, the same sectors are rejected.
    assert_eq!(visible(&room.walls(&niche, 1)), []);
}

#[test]
fn two_sided_lines_with_a_missing_side_are_seen_through() {
    for (right, left) in [(Some(1), None), (None, Some(0)), (None, None)] {
        let map = two_rooms(2, |map, line| map.line(line, ML_TWOSIDED, right, left));
        assert_eq!(visible(&map), [(0, 1)], "{right:?} and {left:?}");
        let map = two_rooms(2, |map, line| map.line(line, BLOCKING, right, left));
        assert_eq!(visible(&map), [], "{right:?} and {left:?}, one-sided");
    }
}

#[test]
fn sectors_without_lines_see_only_themselves() {
    let table = table(&with_door(4));
    for (a, b) in (0..4).flat_map(|a| (0..4).map(move |b| (a, b))) {
        let expected = a != b && (a > 1 || b > 1);
        assert_eq!(table.get(a, b), expected, "{a} and {b}");
    }
}

/// For Doom the flag decides, not the number of sides.
#[test]
fn one_sided_lines_with_two_sides_are_opaque() {
    let flagged = |flags| visible(&two_rooms(2, |map, line| map.line(line, flags, Some(1), Some(0))));
    assert_eq!(flagged(0), []);
    assert_eq!(flagged(!ML_TWOSIDED), []);
    assert_eq!(flagged(BLOCKING | ML_TWOSIDED), [(0, 1)]);
}

/// Lines along one line enclose nothing but the outside: sectors that are named towards it see each other there, and
/// where no side names a sector, nothing is visible.
#[test]
fn maps_of_lines_along_one_line_have_the_outside_only() {
    let named = Sketch::new(3).walls(&[[0, 0], [8, 8], [16, 16]], 0).walls(&[[16, 16], [24, 24]], 1);
    assert_eq!(visible(&named), [(0, 1)]);
    let bare = Sketch::new(3).line([[0, 0], [8, 8]], BLOCKING, None, None);
    assert_eq!(table(&bare).n_rejected(), 6);
}

// --- Lines that cross --------------------------------------------------------------------------------

/// Two rooms whose dividing wall is crossed by a slanted two-sided line in no point of the grid.
#[test]
fn a_crossing_of_a_wall_and_an_open_line_hides_and_shows_what_it_should() {
    let map = |flags| {
        let map = Sketch::new(4).walls(&[[0, 0], [0, 5], [7, 5]], 0).walls(&[[7, 5], [7, 0], [0, 0]], 1);
        let map = map.line([[0, 0], [7, 5]], flags, Some(1), Some(0));
        map.line([[2, 4], [5, 0]], ML_TWOSIDED, Some(2), Some(3)).0
    };
    let (closed, open) = (Sketch(map(BLOCKING)), Sketch(map(ML_TWOSIDED)));
    let (_, summary) = reject_table(&read(&wad_of(&closed)), &FOR_DOOM).unwrap();
    assert!(summary.n_rounded_crossings > 0, "the crossing is on no double");
    // The short line divides nothing, so its sectors 2 and 3 are in both rooms.
    let around = [(0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    assert_eq!(visible(&closed), around);
    assert_eq!(visible(&open), [&[(0, 1)], &around[..]].concat());
}

/// Rooms 0 and 1 on both sides of a slanted line, and lines across them that cross it and each other,
/// opaque or not, naming any of four sectors or none.
pub(crate) fn crossing_map() -> impl Strategy<Value = Sketch> {
    let point = || (0i16..8, 0i16..8).prop_map(|(x, y)| [x, y]);
    let sector = || prop::option::of(0u16..4);
    let line = (point(), point(), any::<bool>(), sector(), sector()).prop_filter("of some length", |l| l.0 != l.1);
    let divide = (0i16..8, 0i16..8, any::<bool>());
    (divide, prop::collection::vec(line, 1..5)).prop_map(|((low, high, open), lines)| {
        let (from, to) = ([low, 0], [high, 8]);
        let map = Sketch::new(4).walls(&[from, [-1, 0], [-1, 8], to], 0).walls(&[to, [9, 8], [9, 0], from], 1);
        let flags = |open| if open { ML_TWOSIDED } else { BLOCKING };
        let map = map.line([from, to], flags(open), Some(1), Some(0));
        lines.into_iter().fold(map, |map, (a, b, open, right, left)| map.line([a, b], flags(open), right, left))
    })
}

/// How a table compares with brute force, over ordered pairs of different sectors.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Comparison {
    /// Visible, and rejected: must never be.
    n_wrong: usize,
    /// Hidden, and not rejected.
    n_loose: usize,
    /// Hidden.
    n_hidden: usize,
}

fn compare(truth: &[Vec<bool>], rejected: impl Fn(u32, u32) -> bool) -> Comparison {
    let mut found = Comparison::default();
    for (a, row) in (0u32..).zip(truth) {
        for (b, &visible) in (0u32..).zip(row).filter(|&(b, _)| a != b) {
            found.n_wrong += usize::from(visible && rejected(a, b));
            found.n_loose += usize::from(!visible && !rejected(a, b));
            found.n_hidden += usize::from(!visible);
        }
    }
    found
}

/// The table of a map, what brute force says, and what was done.
fn judged(map: &Sketch) -> (RejectTable, Vec<Vec<bool>>, RejectSummary) {
    let map = read(&wad_of(map));
    let (table, summary) = reject_table(&map, &FOR_DOOM).unwrap();
    (table, sector_visibility_brute_force(&map.plan_for(FOR_DOOM.game).unwrap()), summary)
}

proptest! {
    /// Invariant: nothing that brute force sees is rejected, however lines cross; and where no crossing
    /// had to be rounded, everything else is.
    #[test]
    fn crossing_lines_reject_nothing_visible(map in crossing_map()) {
        let (table, truth, summary) = judged(&map);
        let found = compare(&truth, |a, b| table.get(a, b));
        prop_assert_eq!(found.n_wrong, 0, "{:?}", truth);
        prop_assert!(found.n_loose == 0 || summary.n_rounded_crossings > 0, "{:?} {:?}", found, truth);
        prop_assert!(!table.has_hand_made_effects());
    }
}

/// The tightness twin for what the invariant above lets pass: on maps with rounded crossings, nearly
/// everything hidden is rejected. And the impostors: a table that rejects all, and one that rejects
/// nothing, would be noticed.
#[test]
fn crossing_lines_reject_nearly_all_that_is_hidden() {
    let (mut n_rounded, mut total, mut n_wrong) = (0, Comparison::default(), 0);
    let (mut n_loose_of_none, mut n_maps) = (0, 0);
    for map in draw(&crossing_map(), 150) {
        let (table, truth, summary) = judged(&map);
        n_maps += 1;
        if summary.n_rounded_crossings == 0 {
            continue;
        }
        let found = compare(&truth, |a, b| table.get(a, b));
        assert_eq!(found.n_wrong, 0);
        n_rounded += 1;
        total.n_loose += found.n_loose;
        total.n_hidden += found.n_hidden;
        n_wrong += compare(&truth, |_, _| true).n_wrong;
        n_loose_of_none += compare(&truth, |_, _| false).n_loose;
    }
    assert!(n_rounded > 30, "{n_rounded} of {n_maps} maps have rounded crossings");
    assert!(n_wrong > 100, "a table that rejects all is wrong {n_wrong} times");
    assert!(total.n_hidden > 100 && n_loose_of_none == total.n_hidden, "{total:?}");
    eprintln!("{n_rounded} of {n_maps} maps: {total:?}");
    assert!(total.n_loose * 20 <= total.n_hidden, "{total:?}");
}

// --- The file around the tables ----------------------------------------------------------------------

/// A file with lumps before, between and behind three maps; the second has a table made by hand.
pub(crate) fn three_maps(by_hand: &[u8]) -> Wad {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("BEFORE", b"before").unwrap();
    let mut add = |text: &str, map: Sketch, reject: Option<&[u8]>| {
        let source = DoomMapSource { reject: reject.map(<[u8]>::to_vec), ..map.0 };
        source.add_to(&mut builder, name(text)).unwrap();
        builder.lump(&format!("{text}X"), text.as_bytes()).unwrap();
    };
    add("MAP01", with_wall(2), None);
    add("MAP02", with_wall(2), Some(by_hand));
    add("MAP03", with_wall(3), Some(&[0, 0]));
    Wad::parse(builder.finish().unwrap()).unwrap()
}

/// Asymmetric: 0 does not see 1, but 1 sees 0.
pub(crate) const BLIND: [u8; 1] = [0b0010];
/// Sector 1 is rejected from itself.
const DEAF: [u8; 1] = [0b1000];

pub(crate) fn build(wad: &Wad, maps: &[&str], force: bool) -> Result<RejectOutcome, RejectError> {
    let maps = maps.iter().map(|&m| m.to_owned()).collect();
    reject_wad(wad, &RejectOptions { maps, force, ..FOR_DOOM })
}

/// Names and bytes of all lumps but REJECT, in their order.
pub(crate) fn other_lumps(wad: &Wad) -> Vec<(String, Vec<u8>)> {
    let lumps = wad.lumps().iter().enumerate().filter(|(_, lump)| !lump.name.is("REJECT"));
    lumps.map(|(k, lump)| (lump.name.to_string(), wad.lump_bytes(k).to_vec())).collect()
}

pub(crate) fn rejects(wad: &Wad) -> Vec<Option<Vec<u8>>> {
    let map = |lumps| DoomMap::parse(wad, lumps).unwrap().reject().map(<[u8]>::to_vec);
    list_maps(wad).iter().map(map).collect()
}

#[test]
fn hand_made_effects_are_kept_unless_forced() {
    for by_hand in [BLIND, DEAF] {
        let wad = three_maps(&by_hand);
        let outcome = build(&wad, &[], false).unwrap();
        let status: Vec<MapStatus> = outcome.maps.iter().map(|m| m.status.clone()).collect();
        assert!(matches!(status[..], [MapStatus::Written(_), MapStatus::KeptHandMade, MapStatus::Written(_)]));
        let built = rejects(&Wad::parse(outcome.bytes).unwrap());
        assert_eq!(built[..2], [Some(vec![0b0110]), Some(by_hand.to_vec())]);
        let outcome = build(&wad, &[], true).unwrap();
        assert!(outcome.maps.iter().all(|m| matches!(m.status, MapStatus::Written(_))));
        assert_eq!(rejects(&Wad::parse(outcome.bytes).unwrap())[1], Some(vec![0b0110]));
        // Asked for by name, it is kept as well, and then nothing changes at all.
        let outcome = build(&wad, &["MAP02"], false).unwrap();
        assert_eq!((&outcome.maps[0].status, &outcome.bytes[..]), (&MapStatus::KeptHandMade, wad.as_bytes()));
        assert_eq!((outcome.maps[0].name, outcome.maps[0].n_sectors), (name("MAP02"), 2));
    }
}

/// What no author meant is replaced: tables of zeros, of ones but for the diagonal, of a wrong length.
#[test]
fn tables_without_effects_are_replaced() {
    // The last two are of a map with more sectors: read as that of this one, the first of them would be no symmetric table.
    for old in [&[0][..], &[0b0110], &[], &[0; 7], &[0b0110, 0xFF], &[0b0010, 0b0010], &[0b0010, 0, 0, 0, 0]] {
        let outcome = build(&three_maps(old), &["MAP02"], false).unwrap();
        assert!(matches!(outcome.maps[0].status, MapStatus::Written(_)), "{old:?}");
        assert_eq!(rejects(&Wad::parse(outcome.bytes).unwrap())[1], Some(vec![0b0110]), "{old:?}");
    }
}

#[test]
fn all_other_lumps_stay_byte_for_byte() {
    let wad = three_maps(&BLIND);
    let all = Wad::parse(build(&wad, &[], true).unwrap().bytes).unwrap();
    assert_eq!((all.kind(), other_lumps(&all)), (wad.kind(), other_lumps(&wad)));
    // The map that had none has its table behind its sectors, where engines look for it.
    let behind = all.lumps().iter().position(|lump| lump.name.is("SECTORS")).unwrap() + 1;
    assert!(all.lumps()[behind].name.is("REJECT"));
    assert_eq!(all.lumps().len(), wad.lumps().len() + 1);
    // With only the last map named, the others keep theirs or their lack of it, and the names' case is free.
    let outcome = build(&wad, &["map03"], false).unwrap();
    assert_eq!(outcome.maps.len(), 1);
    let one = Wad::parse(outcome.bytes).unwrap();
    assert_eq!(other_lumps(&one), other_lumps(&wad));
    let (before, after) = (rejects(&wad), rejects(&one));
    assert_eq!(before[..2], after[..2]);
    // Rows 011, 101 and 110, bit 0 first: the rooms do not see each other, and nothing sees sector 2.
    assert_eq!(after[2], Some(vec![0b1110_1110, 0b0]));
    // What was built is built the same again, now in place.
    let again = build(&all, &[], true).unwrap();
    assert_eq!(again.bytes, all.as_bytes());
}

/// The impostor of the comparison above: a lump with one byte changed is noticed.
#[test]
fn a_changed_lump_is_noticed() {
    let wad = three_maps(&BLIND);
    let places = (0..wad.lumps().len()).filter(|&k| !wad.lumps()[k].name.is("REJECT") && wad.lumps()[k].size() > 0);
    let mut n_lumps = 0;
    for lump in places {
        let mut bytes = wad.as_bytes().to_vec();
        bytes[wad.lumps()[lump].range().start] ^= 1;
        assert_ne!(other_lumps(&Wad::parse(bytes).unwrap()), other_lumps(&wad), "lump {lump}");
        n_lumps += 1;
    }
    assert!(n_lumps >= 16, "{n_lumps} lumps");
}

#[test]
fn bytes_are_the_same_with_any_number_of_threads() {
    let wad = wad_of(&with_door(9));
    let bytes = |threads| reject_wad(&wad, &RejectOptions { threads, ..RejectOptions::default() }).unwrap().bytes;
    assert!(bytes(1) == bytes(2) && bytes(1) == bytes(3));
    for map in draw(&crossing_map(), 20) {
        let map = read(&wad_of(&map));
        let by = |threads| reject_table(&map, &RejectOptions { threads, ..RejectOptions::default() }).unwrap().0;
        assert!(by(1) == by(2) && by(1) == by(3));
    }
}

// --- Errors ------------------------------------------------------------------------------------------

#[test]
fn files_without_maps_and_unknown_names_are_errors() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("README", b"no maps here").unwrap();
    let empty = Wad::parse(builder.finish().unwrap()).unwrap();
    assert_eq!(build(&empty, &[], false), Err(RejectError::NoMaps));
    assert_eq!(build(&empty, &["MAP01"], true).unwrap_err().to_string(), "the file has no maps");
    let error = build(&three_maps(&BLIND), &["MAP01", "MAP07"], false).unwrap_err();
    assert_eq!(error, RejectError::NoSuchMap("MAP07".to_owned()));
    assert_eq!(error.to_string(), "map MAP07 is not in the file");
}

/// A map of the consoles is passed through, unless it was asked for.
#[test]
fn maps_in_other_formats_are_skipped_or_refused_by_name() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    with_wall(2).0.add_to(&mut builder, name("MAP02")).unwrap();
    builder.lump("MAP03", b"").unwrap().lump("LINEDEFS", b"").unwrap().lump("LEAFS", b"").unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();

    for strict in [false, true] {
        let outcome = reject_wad(&wad, &RejectOptions { strict, ..RejectOptions::default() }).unwrap();
        let status: Vec<MapStatus> = outcome.maps.iter().map(|m| m.status.clone()).collect();
        assert!(matches!(status[..], [MapStatus::Written(_), MapStatus::SkippedUnsupported]));
        assert_eq!(other_lumps(&Wad::parse(outcome.bytes).unwrap()), other_lumps(&wad));
    }
    assert!(build(&wad, &["MAP02"], false).is_ok());
    let error = build(&wad, &["MAP02", "MAP03"], false).unwrap_err();
    assert_eq!(error.to_string(), "map MAP03: maps in console format are not supported");
}

/// A file of which nothing can be read is an error, asked for by name or not.
#[test]
fn a_file_of_other_formats_only_is_refused() {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("MAP01", b"").unwrap().lump("LINEDEFS", b"").unwrap().lump("LEAFS", b"").unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let error = build(&wad, &[], false).unwrap_err();
    assert!(error.to_string().starts_with("map MAP01: "), "{error}");
}

/// An engine reads a lump that is too long as far as it needs; effects made by hand in there count.
#[test]
fn padded_tables_made_by_hand_are_kept() {
    let mut map = with_wall(2);
    map.0.reject = Some(vec![0b0000_0001, 0, 0]);
    let mut builder = WadBuilder::new(WadKind::Patch);
    map.0.add_to(&mut builder, name("MAP01")).unwrap();
    let wad = Wad::parse(builder.finish().unwrap()).unwrap();
    let kept = build(&wad, &[], false).unwrap();
    assert_eq!((&kept.maps[0].status, &kept.bytes[..]), (&MapStatus::KeptHandMade, wad.as_bytes()));
    assert!(matches!(build(&wad, &[], true).unwrap().maps[0].status, MapStatus::Written(_)));
}

/// Three maps, of which the second is damaged: the others are done, and it keeps its lumps. Asked for by name, or where one such map is
/// too many, or if there is no other, it is an error with its name and place.
#[test]
fn damaged_maps_do_not_stop_the_others() {
    let mut damaged = with_wall(2);
    damaged.0.lines[3].v2 = 99;
    damaged.0.reject = Some(vec![7; 3]);
    let place = "map MAP02: LINEDEFS 3: vertex 99 is not among the ";
    let file = |maps: [(&str, &Sketch); 3]| {
        let mut builder = WadBuilder::new(WadKind::Patch);
        maps.iter().for_each(|(text, map)| map.0.add_to(&mut builder, name(text)).unwrap());
        Wad::parse(builder.finish().unwrap()).unwrap()
    };
    let wad = file([("MAP01", &with_wall(2)), ("MAP02", &damaged), ("MAP03", &with_door(2))]);
    let outcome = build(&wad, &[], false).unwrap();
    let [MapStatus::Written(_), MapStatus::Failed(error), MapStatus::Written(_)] =
        [0, 1, 2].map(|k: usize| outcome.maps[k].status.clone())
    else {
        panic!("{:?}", outcome.maps)
    };
    assert!(error.to_string().starts_with(place), "{error}");
    let built = Wad::parse(outcome.bytes).unwrap();
    assert_eq!(other_lumps(&built), other_lumps(&wad));
    let lumps: Vec<&[u8]> =
        (0..built.lumps().len()).filter(|&k| built.lumps()[k].name.is("REJECT")).map(|k| built.lump_bytes(k)).collect();
    assert_eq!(lumps, [&[0b0110][..], &[7; 3], &[0]]);

    assert!(build(&wad, &["MAP01", "MAP03"], false).is_ok());
    let strict = RejectOptions { strict: true, ..RejectOptions::default() };
    let all_damaged = file([("MAP02", &damaged), ("MAP05", &damaged), ("MAP06", &damaged)]);
    for error in [build(&wad, &["MAP02", "MAP03"], false), reject_wad(&wad, &strict), build(&all_damaged, &[], false)] {
        let error = error.unwrap_err();
        assert!(matches!(error, RejectError::Map(_)), "{error:?}");
        assert!(error.to_string().starts_with(place), "{error}");
    }
}
