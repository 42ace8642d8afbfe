//! A thousand siblings each of small maps whose tables were once wrong, against brute force over a plan that is made here: which lines of which engine
//! hide, what a polyobject does, and an entry of REJECT that is not inside its file.

use crate::reject::{BLOCKING, Corner, FOR_DOOM, Sketch, other_lumps, read, rejects, wad_of};
use crate::reject_engines::{binary, hexen, text};
use sightlines_bake::{RejectOptions, reject_table, reject_wad};
use sightlines_cells::{Plan, PlanLine};
use sightlines_formats::doom::{Game, ML_TWOSIDED};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{DoomMap, LumpName, Wad};
use sightlines_geometry::{Point2, Random};
use sightlines_testkit::{sector_visibility_brute_force, siblings};

/// A point of a grid that is turned by quarters.
fn turned(quarters: usize, [x, y]: [i16; 2]) -> Corner {
    (0..quarters).fold([x - 100, y + 30], |[x, y], _| [-y, x])
}

/// Rooms in a row, with the box of each before it is turned by quarters. Each stretch between two of them is a wall of one side as often as `walls` of
/// three, or else has two sides and the flag or not.
fn row(random: &mut Random, n: usize, quarters: usize, walls: usize) -> (Sketch, Vec<[[i16; 2]; 2]>) {
    let at = |x: usize, y: usize| turned(quarters, [x, y].map(|x| 64 * x as i16));
    let (mut low, mut high) = (0, 1 + random.below(3));
    let mut boxes = Vec::new();
    let mut x = 0;
    let mut map = Sketch::new(n as u16).walls(&[at(0, low), at(0, high)], 0);
    for room in 0..n {
        let next = x + 1 + random.below(3);
        let [from, to] = [room as u16, room as u16 + 1];
        boxes.push([[x, low], [next, high]].map(|p| p.map(|x| 64 * x as i16)));
        map = map.walls(&[at(x, high), at(next, high)], from).walls(&[at(next, low), at(x, low)], from);
        if room + 1 == n {
            map = map.walls(&[at(next, high), at(next, low)], from);
            break;
        }
        // What is between, stretch by stretch; the next room may be higher or lower.
        let next_low = low + random.below(2);
        let next_high = (high + random.below(2)).max(next_low + 1);
        for y in low..high.max(next_high) {
            let [is_here, is_there] = [(low, high), (next_low, next_high)].map(|(low, high)| low <= y && y < high);
            let line = [at(next, y + 1), at(next, y)];
            map = match (is_here, is_there) {
                (true, true) => {
                    let flags = [0, 0, BLOCKING, ML_TWOSIDED][random.below(4)];
                    if random.below(3) >= walls {
                        map.line(line, flags, Some(from), Some(to))
                    } else {
                        map.line(line, BLOCKING, Some(from), None).line([line[1], line[0]], BLOCKING, Some(to), None)
                    }
                }
                (true, false) => map.line(line, BLOCKING, Some(from), None),
                (false, true) => map.line([line[1], line[0]], BLOCKING, Some(to), None),
                (false, false) => map,
            };
        }
        (low, high, x) = (next_low, next_high, next);
    }
    (map, boxes)
}

/// One of some rooms, with walls between them and without.
fn any_row(random: &mut Random) -> Sketch {
    let (n, quarters) = (3 + random.below(2), random.below(4));
    row(random, n, quarters, 1).0
}

/// Which sectors see which, by brute force, if lines are seen through for which `open` is true.
fn truth(sketch: &Sketch, open: impl Fn(usize) -> bool) -> Vec<Vec<bool>> {
    let source = &sketch.0;
    let at = |v: u16| Point2::from(source.vertices[usize::from(v)].map(f64::from));
    let line = |(k, l): (usize, &sightlines_formats::doom::SourceLine)| PlanLine {
        a: at(l.v1),
        b: at(l.v2),
        opaque: !open(k),
        left: l.left.map(u32::from),
        right: l.right.map(u32::from),
    };
    sector_visibility_brute_force(
        &Plan::new(source.lines.iter().enumerate().map(line).collect(), vec![]).expect("a plan"),
    )
}

/// How many pairs are rejected that are seen, how many are hidden, and how many of these are rejected.
fn compared(map: &DoomMap, game: Option<Game>, truth: &[Vec<bool>]) -> [usize; 3] {
    let (table, summary) = reject_table(map, &RejectOptions { game, ..FOR_DOOM }).expect("a table");
    assert_eq!(summary.n_rounded_crossings, 0);
    let pairs = (0..truth.len()).flat_map(|a| (0..truth.len()).map(move |b| (a, b))).filter(|(a, b)| a != b);
    let mut found = [0; 3];
    for (a, b) in pairs {
        let (seen, rejected) = (truth[a][b], table.get(a as u32, b as u32));
        for (n, is) in found.iter_mut().zip([seen && rejected, !seen, !seen && rejected]) {
            *n += usize::from(is);
        }
    }
    found
}

/// For each engine a line with two sides hides or does not, by its flag, as a table here states; all that is hidden is rejected, and nothing else. The
/// impostor is the table for Doom.
#[test]
fn lines_hide_from_the_engines_that_do_not_look_through_them() {
    let [mut n, mut n_hidden, mut n_differ, mut n_wrong] = [0; 4];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let sketch = any_row(&mut random);
        // Whether the flag is what counts, by format, namespace and option.
        let plain = || read(&wad_of(&sketch));
        let named = |namespace: &str| text(&sketch, namespace, |_| 0);
        let (map, game, flag_counts) = match random.below(12) {
            0 => (plain(), Some(Game::Doom), true),
            1 => (plain(), None, false),
            2 => (plain(), Some(Game::Heretic), false),
            3 => (plain(), Some(Game::Hexen), false),
            4 => (hexen(&sketch, |_| 0), None, false),
            5 => (hexen(&sketch, |_| 0), Some(Game::Doom), false),
            6 => (hexen(&sketch, |_| 0), Some(Game::Heretic), false),
            7 => (named("heretic"), Some(Game::Doom), false),
            8 => (named("Hexen"), None, false),
            9 => (named(["doom", "zdoom", "strife"][random.below(3)]), Some(Game::Doom), true),
            10 => (named(["doom", "zdoom", "strife"][random.below(3)]), None, false),
            _ => (named("doom"), Some(Game::Heretic), false),
        };
        let lines = &sketch.0.lines;
        let by_flag = truth(&sketch, |k| lines[k].flags & 4 != 0);
        let by_side = truth(&sketch, |k| lines[k].left.is_some());
        let expected = if flag_counts { &by_flag } else { &by_side };
        let [wrong, hidden, rejected] = compared(&map, game, expected);
        assert_eq!((wrong, rejected), (0, hidden), "{seed}: {game:?} {:?} {sketch:?}", map.format());
        n_hidden += hidden;
        n_differ += usize::from(by_flag != by_side);
        n_wrong += usize::from(compared(&plain(), Some(Game::Doom), &by_side)[0] > 0);
        n += 1;
    }
    eprintln!(
        "{n} maps, {n_differ} that engines differ in; {n_hidden} hidden pairs; Doom's table is wrong for {n_wrong}"
    );
    assert!(
        n == siblings().len() && n_hidden > n && 3 * n_differ > n && n_wrong == n_differ,
        "{n_hidden} {n_differ} {n_wrong}"
    );
}

/// Polyobjects of any size, at any place, wherever they are noted, hide nothing; the twin is all else that hides, and the impostor takes their lines for
/// walls, as those of the same map without the special are.
#[test]
fn polyobjects_of_any_size_anywhere_hide_nothing() {
    let [mut n, mut n_hidden, mut n_differ] = [0; 3];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let quarters = random.below(4);
        let walls = random.below(2);
        let (fixed, rooms) = row(&mut random, 3, quarters, walls);
        let first = fixed.0.lines.len();
        // In a room, from wall to wall or not, or across the walls.
        let [low, high] = rooms[random.below(3)];
        let x = low[0] + 8 + 8 * random.below(4) as i16;
        let width = 8 * random.below(3) as i16;
        let [y0, y1] = match random.below(4) {
            0 => [low[1] + 8 * random.below(3) as i16, high[1] - 8 * random.below(3) as i16],
            1 => [low[1] - 8, high[1] + 8],
            _ => [low[1], high[1]],
        };
        let mut corners = match width {
            0 => vec![[x, y0], [x, y1]],
            _ => vec![[x, y0], [x, y1], [x + width, y1], [x + width, y0]],
        };
        corners.push(corners[0]);
        let corners: Vec<Corner> = corners.into_iter().map(|p| turned(quarters, p)).collect();
        let sector = random.below(3) as u16;
        let sketch = fixed.clone().walls(&corners, sector);
        let n_lines = sketch.0.lines.len() - first;
        let start = random.below(n_lines);
        let of = |one: u16, each: u16, all: bool| {
            move |k: usize| {
                if all && k >= first {
                    each
                } else if !all && k == first + start {
                    one
                } else {
                    0
                }
            }
        };
        let all = random.below(2) == 0;
        let (map, plain) = match random.below(5) {
            0 | 1 => (hexen(&sketch, |k| of(1, 5, all)(k) as u8), hexen(&sketch, |_| 0)),
            2 => (text(&sketch, ["zdoom", "hexen"][start % 2], of(1, 5, all)), text(&sketch, "zdoom", of(0, 7, all))),
            3 => (text(&sketch, "doom", of(348, 349, all)), text(&sketch, "doom", of(1, 5, all))),
            _ => (binary(&sketch, 3001, of(348, 349, all)), binary(&sketch, 3001, of(20, 21, all))),
        };
        let is_open = |k: usize| sketch.0.lines[k].left.is_some();
        let expected = truth(&sketch, |k| k >= first || is_open(k));
        let [wrong, hidden, rejected] = compared(&map, None, &expected);
        assert_eq!((wrong, rejected), (0, hidden), "{seed}: {all} {start} {sketch:?}");
        n_hidden += hidden;
        n_differ += usize::from(compared(&plain, None, &expected)[0] > 0);
        n += 1;
    }
    eprintln!("{n} maps, {n_hidden} hidden pairs; as walls {n_differ} polyobjects hide what they must not");
    assert!(n == siblings().len() && 2 * n_hidden > n && 8 * n_differ > n, "{n_hidden} {n_differ} of {n}");
}

/// An entry of REJECT that is not inside the file is replaced, and all else stays. The twin is such an entry of another lump, which is refused; the
/// impostor keeps an empty table, which rejects nothing.
#[test]
fn entries_of_reject_outside_of_the_file_are_replaced() {
    let [mut n, mut n_tables] = [0; 2];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let mut builder = WadBuilder::new(WadKind::Patch);
        builder.lump("FIRST", b"something else").unwrap();
        let n_maps = 1 + random.below(3);
        for k in 1..=n_maps {
            let mut map = any_row(&mut random);
            map.0.reject = Some(vec![0; usize::from(map.0.n_sectors).pow(2).div_ceil(8)]);
            map.0.hexen = random.below(3) == 0;
            map.0.add_to(&mut builder, LumpName::new(&format!("MAP0{k}")).unwrap()).unwrap();
        }
        let sound = builder.finish().unwrap();
        let [count, offset] = [4, 8].map(|at| u32::from_le_bytes(sound[at..at + 4].try_into().unwrap()) as usize);
        let entries: Vec<usize> = (0..count).map(|k| offset + 16 * k).collect();
        let (of_reject, others): (Vec<usize>, Vec<usize>) =
            entries.into_iter().partition(|&at| sound[at + 8..].starts_with(b"REJECT"));
        let (len, far) = (sound.len() as i32, 1 + random.below(1 << 20) as i32);
        let [start, size] = match random.below(4) {
            0 => [len, far],
            1 => [len + far, 2],
            2 => [12, len + far],
            _ => [-far, 2],
        };
        let damaged = |at: usize| {
            let mut bytes = sound.clone();
            bytes[at..at + 4].copy_from_slice(&start.to_le_bytes());
            bytes[at + 4..at + 8].copy_from_slice(&size.to_le_bytes());
            Wad::parse(bytes)
        };
        let at = of_reject[random.below(n_maps)];
        let wad = damaged(at).unwrap_or_else(|error| panic!("{seed}: {start} {size} {error}"));
        assert_eq!(wad.lumps().iter().filter(|lump| lump.is_lost()).count(), 1, "{seed}");
        let made = |wad: &Wad| Wad::parse(reject_wad(wad, &FOR_DOOM).unwrap().bytes).unwrap();
        let (found, expected) = (made(&wad), made(&Wad::parse(sound.clone()).unwrap()));
        assert_eq!(rejects(&found), rejects(&expected), "{seed}");
        assert_eq!(other_lumps(&found), other_lumps(&expected), "{seed}");
        assert!(found.lumps().iter().all(|lump| !lump.is_lost()));
        let named = others.iter().filter(|&&at| sound[at + 4..at + 8] != [0; 4]).collect::<Vec<_>>();
        assert!(damaged(*named[random.below(named.len())]).is_err(), "{seed}");
        n_tables += usize::from(rejects(&expected).iter().flatten().any(|bits| bits.iter().any(|&b| b != 0)));
        n += 1;
    }
    assert!(n == siblings().len() && 2 * n_tables > n, "{n_tables} of {n}");
}
