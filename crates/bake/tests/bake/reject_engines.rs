//! REJECT tables for the engines of different games, against brute force and against each other; and maps with polyobjects.

use crate::reject::{BLOCKING, Corner, FOR_DOOM, Sketch, crossing_map, read, ring, wad_of};
use crate::reject_text::udmf;
use proptest::prelude::*;
use sightlines_bake::{RejectOptions, reject_table};
use sightlines_formats::doom::{Game, MapLump, list_maps};
use sightlines_formats::wad::Edit;
use sightlines_formats::{DoomMap, RejectTable, Wad};
use sightlines_testkit::{draw, sector_visibility_brute_force};

fn table(map: &DoomMap, game: Option<Game>) -> RejectTable {
    reject_table(map, &RejectOptions { game, ..FOR_DOOM }).unwrap().0
}

/// The map in Hexen's format, its lines with these specials.
pub(crate) fn hexen(sketch: &Sketch, special: impl Fn(usize) -> u8) -> DoomMap {
    let mut sketch = sketch.clone();
    sketch.0.hexen = true;
    let wad = wad_of(&sketch);
    let lump = list_maps(&wad)[0].lump(MapLump::Linedefs).unwrap();
    let mut bytes = wad.lump_bytes(lump).to_vec();
    bytes.chunks_exact_mut(16).enumerate().for_each(|(k, record)| record[6] = special(k));
    read(&Wad::parse(wad.with_edits(&[Edit::Replace { lump, bytes }]).unwrap()).unwrap())
}

/// The map in Doom's format, its lines with these specials, and with a thing of this kind.
pub(crate) fn binary(sketch: &Sketch, thing: u16, special: impl Fn(usize) -> u16) -> DoomMap {
    let wad = wad_of(sketch);
    let [lines, things] = [MapLump::Linedefs, MapLump::Things].map(|lump| list_maps(&wad)[0].lump(lump).unwrap());
    let mut bytes = wad.lump_bytes(lines).to_vec();
    for (k, record) in bytes.chunks_exact_mut(14).enumerate() {
        record[6..8].copy_from_slice(&special(k).to_le_bytes());
    }
    let place: Vec<u8> = [80, 32, 0, thing, 0].into_iter().flat_map(u16::to_le_bytes).collect();
    let edits = [Edit::Replace { lump: lines, bytes }, Edit::Replace { lump: things, bytes: place }];
    read(&Wad::parse(wad.with_edits(&edits).unwrap()).unwrap())
}

/// The map as text in a namespace, its lines with these specials.
pub(crate) fn text<N: std::fmt::Display>(sketch: &Sketch, namespace: &str, special: impl Fn(usize) -> N) -> DoomMap {
    let text = udmf::text_of(&read(&wad_of(sketch))).replace("\"zdoom\"", &format!("\"{namespace}\""));
    let mut k = 0;
    let lines = text.lines().map(|line| match line.strip_prefix("LineDef") {
        Some(rest) => {
            k += 1;
            format!("linedef{} special = {}; }}\n", rest.strip_suffix('}').unwrap(), special(k - 1))
        }
        None => format!("{line}\n"),
    });
    let text: String = lines.collect();
    read(&Wad::parse(udmf::wad_of_text(text.as_bytes(), &[])).unwrap())
}

/// The same map, its flags as engines that look through all lines with a left side take them.
fn flagged(sketch: &Sketch) -> Sketch {
    let mut sketch = sketch.clone();
    sketch.0.lines.iter_mut().filter(|line| line.left.is_some()).for_each(|line| line.flags |= 4);
    sketch
}

proptest! {
    /// Invariant: with nothing said no engine's view is hidden, and a table for Doom may be tighter; formats count more than options.
    #[test]
    fn tables_are_right_for_the_engines_that_they_are_for(sketch in crossing_map()) {
        let map = read(&wad_of(&sketch));
        let open = table(&read(&wad_of(&flagged(&sketch))), Some(Game::Doom));
        for game in [None, Some(Game::Heretic), Some(Game::Hexen)] {
            prop_assert_eq!(&table(&map, game), &open);
        }
        for game in [None, Some(Game::Doom)] {
            prop_assert_eq!(&table(&hexen(&sketch, |_| 0), game), &open);
            prop_assert_eq!(&table(&text(&sketch, "Hexen", |_| 0), game), &open);
            prop_assert_eq!(&table(&text(&sketch, "heretic", |_| 0), game), &open);
        }
        let doom = table(&map, Some(Game::Doom));
        for namespace in ["doom", "zdoom", "strife"] {
            prop_assert_eq!(&table(&text(&sketch, namespace, |_| 0), Some(Game::Doom)), &doom);
            prop_assert_eq!(&table(&text(&sketch, namespace, |_| 0), None), &open);
        }
        let n = map.n_sectors();
        prop_assert!((0..n).all(|a| (0..n).all(|b| doom.get(a, b) || !open.get(a, b))));
        let truth = sector_visibility_brute_force(&map.plan().unwrap());
        let seen = |a: u32, b: u32| truth.get(a as usize).and_then(|row| row.get(b as usize)).copied().unwrap_or(false);
        prop_assert!((0..n).all(|a| (0..n).all(|b| !(seen(a, b) && open.get(a, b)))));
    }
}

/// The impostor: a table for Doom would hide from the other engines what they show.
#[test]
fn tables_for_doom_are_wrong_for_heretic() {
    let differ = |sketch: &&Sketch| {
        let map = read(&wad_of(sketch));
        table(&map, Some(Game::Doom)) != table(&map, Some(Game::Heretic))
    };
    let n = draw(&crossing_map(), 100).iter().filter(differ).count();
    assert!(n > 3, "{n} of 100");
}

/// Rooms 0, 1 and 2 in a row, and a polyobject in the middle one: the lines from the tenth on.
fn three_rooms(corners: &[Corner]) -> Sketch {
    let rooms = Sketch::new(3).walls(&[[64, 0], [0, 0], [0, 64], [64, 64]], 0);
    let rooms = rooms.walls(&[[64, 64], [128, 64]], 1).walls(&[[128, 0], [64, 0]], 1);
    let rooms = rooms.walls(&[[128, 64], [192, 64], [192, 0], [128, 0]], 2);
    let rooms = rooms.open(&[[64, 64], [64, 0]], 0, 1).open(&[[128, 64], [128, 0]], 1, 2);
    assert_eq!(rooms.0.lines.len(), N_FIXED);
    rooms.walls(corners, 1)
}

const N_FIXED: usize = 10;

fn is_hidden(map: &DoomMap) -> bool {
    let table = table(map, None);
    assert!(!table.get(0, 1) && !table.get(1, 2));
    table.get(0, 2)
}

/// Lines of a polyobject hide nothing, however they are noted and wherever they were drawn; others do.
#[test]
fn polyobjects_hide_nothing() {
    let mut n_hidden = 0;
    for x in [70i16, 90, 120] {
        // Across the whole room, walls to its walls; its corners are none of the room's.
        let corners = ring([x, 0], [x + 4, 64]);
        let sketch = three_rooms(&corners);
        // The first line may be any of them, and all may be listed.
        let start = |first: usize| move |k: usize| u8::from(k == N_FIXED + first);
        let all = |k: usize| if k >= N_FIXED { 5 } else { 0 };
        for first in 0..4 {
            assert!(!is_hidden(&hexen(&sketch, start(first))) && !is_hidden(&text(&sketch, "zdoom", start(first))));
        }
        assert!(!is_hidden(&hexen(&sketch, all)) && !is_hidden(&text(&sketch, "HEXEN", all)));
        // Impostors: no special, another one, one of the listed lines without it, the numbers of Doom, and a line that is no part of it.
        n_hidden += usize::from(is_hidden(&hexen(&sketch, |_| 0))) + usize::from(is_hidden(&hexen(&sketch, |_| 2)));
        let but_one_side = |k: usize| if k == N_FIXED { 5 } else { 0 };
        n_hidden += usize::from(is_hidden(&hexen(&sketch, but_one_side)));
        for namespace in ["doom", "heretic", "strife"] {
            n_hidden += usize::from(is_hidden(&text(&sketch, namespace, start(0))));
        }
        let with_wall = sketch.line([[x + 2, 0], [x + 2, 64]], BLOCKING, Some(1), None);
        n_hidden += usize::from(is_hidden(&hexen(&with_wall, start(0))));
        // One that leaves a gap hides nothing anyway.
        assert!(!is_hidden(&hexen(&three_rooms(&ring([x, 8], [x + 4, 56])), |_| 0)));
    }
    assert_eq!(n_hidden, 3 * 7);
}

/// The numbers of Eternity and of Sonic Robo Blast 2 count where they are theirs, and nowhere else.
#[test]
fn polyobjects_have_the_numbers_of_their_engine() {
    let (mut n_seen, mut n_hidden) = (0, 0);
    let rooms = three_rooms(&ring([90, 0], [94, 64]));
    for first in 0..4 {
        let start = |number: u16| move |k: usize| if k == N_FIXED + first { number } else { 0 };
        let all = |number: u16| move |k: usize| if k >= N_FIXED { number } else { 0 };
        let of_doom = |thing: u16, [one, each]: [u16; 2]| {
            [is_hidden(&binary(&rooms, thing, start(one))), is_hidden(&binary(&rooms, thing, all(each)))]
        };
        let as_text = |namespace: &str, [one, each]: [u16; 2]| {
            [is_hidden(&text(&rooms, namespace, start(one))), is_hidden(&text(&rooms, namespace, all(each)))]
        };
        // A thing 761, with bits above its kind, too.
        let seen = [
            of_doom(3001, [348, 349]),
            of_doom(761, [20, 21]),
            of_doom(761, [348, 349]),
            of_doom(761 | 3 << 12, [20, 21]),
            of_doom(762, [20, 21]),
            as_text("Doom", [348, 349]),
            as_text("heretic", [348, 349]),
            as_text("srb2", [20, 21]),
        ];
        // Impostors: the same numbers where they mean something else.
        let hidden = [
            of_doom(3001, [20, 21]),
            of_doom(3001, [1, 5]),
            of_doom(760, [20, 21]),
            of_doom(761, [22, 22]),
            of_doom(3001, [349 + 1, 349 + 1]),
            as_text("doom", [20, 21]),
            as_text("zdoom", [348, 349]),
            as_text("srb2", [1, 5]),
        ];
        assert_eq!((seen.as_flattened().contains(&true), hidden.as_flattened().contains(&false)), (false, false));
        (n_seen, n_hidden) = (n_seen + seen.len(), n_hidden + hidden.len());
    }
    assert_eq!((n_seen, n_hidden), (32, 32));
}

/// Engines begin at either end of the first line, and take places as equal that are so near that they cannot tell them apart.
#[test]
fn polyobjects_go_on_from_both_ends_of_their_first_line() {
    let start = |k: usize| u8::from(k == N_FIXED);
    let across = |from: Corner| {
        let rooms = three_rooms(&[]).line([[90, 64], [91, 64]], BLOCKING, Some(1), None);
        rooms.line([from, [90, 0]], BLOCKING, Some(1), None)
    };
    assert!(!is_hidden(&hexen(&across([90, 64]), start)) && !is_hidden(&text(&across([90, 64]), "zdoom", start)));
    // The impostor: the first line ends elsewhere.
    let apart = three_rooms(&[]).line([[92, 64], [91, 64]], BLOCKING, Some(1), None);
    let apart = apart.line([[90, 64], [90, 0]], BLOCKING, Some(1), None);
    assert!(is_hidden(&hexen(&apart, start)) && is_hidden(&text(&apart, "zdoom", start)));
}
