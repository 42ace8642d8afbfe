//! The sweeps with axis-aligned doors, and the sequences that they test.

use super::methods::{AxialDoors, methods};
use crate::stability::draws::{between, nudged, powers_of_ten, signed_unit, up_by};
use crate::stability::plane::gaps;
use crate::stability::sweep::Sweep;
use sightlines::geometry::{Aabb, AxialDoor, Random, check_coordinate};
use sightlines_testkit::{AXIS_ORDERS, axial_moved, axial_stabbable_brute_force};

/// A door in integers: its axis, and low and high along each axis.
type GridDoor = (usize, [[i64; 2]; 3]);

/// Doors of a corridor of boxes, as a k-d tree makes them, for a walk that goes forward along every axis. Edges on one
/// line and equal extents are frequent.
pub fn walk(random: &mut Random, n_doors: usize) -> Vec<GridDoor> {
    let mut cell = [[0, 3]; 3];
    let mut doors = Vec::with_capacity(n_doors);
    for _ in 0..n_doors {
        let axis = random.below(3);
        let at = cell[axis][1];
        let mut hole = cell;
        hole[axis] = [at, at];
        cell[axis] = [at, at + between(random, 1, 3)];
        for other in [(axis + 1) % 3, (axis + 2) % 3] {
            let [low, high] = hole[other];
            let from = low + between(random, 0, high - low - 1);
            let to = from + between(random, 1, high - from);
            hole[other] = [from, to];
            cell[other] = [from - between(random, 0, 2), to + between(random, 0, 2)];
        }
        doors.push((axis, hole));
    }
    doors
}

/// Doors whose coordinates are made of integers, some mirrored or with axes exchanged. Both sides of a flat box are one
/// coordinate, placed once.
fn placed(
    random: &mut Random,
    doors: &[GridDoor],
    mut place: impl FnMut(&mut Random, usize, i64) -> f64,
) -> Vec<AxialDoor> {
    let order = AXIS_ORDERS[random.below(6)];
    let mirror = [0, 1, 2].map(|_| random.below(2) == 1);
    let mut door = |&(axis, hole): &GridDoor| {
        let mut extent = Aabb { min: [0.0; 3], max: [0.0; 3] };
        for (k, [low, high]) in hole.into_iter().enumerate() {
            extent.min[k] = place(random, k, low);
            extent.max[k] = if k == axis { extent.min[k] } else { place(random, k, high) };
        }
        AxialDoor { extent, axis: axis as u8, forward: true }
    };
    let doors: Vec<AxialDoor> = doors.iter().map(&mut door).collect();
    axial_moved(&doors, order, mirror)
}

/// Whether the doors are some: finite, and not of width zero.
fn are_doors(doors: &[AxialDoor]) -> bool {
    doors.iter().all(|d| {
        (0..3).all(|k| {
            let [low, high] = [d.extent.min[k], d.extent.max[k]];
            let is_side = k != usize::from(d.axis);
            check_coordinate(low).is_ok() && check_coordinate(high).is_ok() && (!is_side || low < high)
        })
    })
}

fn case(doors: Vec<AxialDoor>) -> Option<(AxialDoors, bool)> {
    are_doors(&doors).then(|| {
        let open = axial_stabbable_brute_force(&doors);
        (AxialDoors(doors), open)
    })
}

/// All sweeps with axis-aligned doors.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let cases = if quick { 50 } else { 300 };
    let step = if quick { 3 } else { 1 };
    let sweep = |texts, levels, cases, make: fn(f64, &mut Random) -> Option<(AxialDoors, bool)>| {
        Sweep::of_cases(texts, levels, cases, methods(), make)
    };
    vec![
        sweep(
            [
                "axial-distance",
                "Corridors of 2 to 7 axis-aligned doors in space, some metres long and with many edges on one plane, are \
                 moved away from the origin and rounded there; a quarter of the coordinates is moved by up to three \
                 units in the last place.",
                "distance from the origin",
            ],
            powers_of_ten(0, 9, step),
            cases,
            distance,
        ),
        sweep(
            ["axial-scale", "The same corridors at the origin, scaled.", "scale"],
            powers_of_ten(-6, 6, step),
            cases,
            scale,
        ),
        sweep(
            [
                "axial-gap",
                "The same corridors about 1000 metres from the origin, with a quarter of the coordinates moved up or \
                 down by just the parameter: where edges were on one plane, there is a gap of that width, or an overlap.",
                "gap in units in the last place",
            ],
            gaps(quick).into_iter().filter(|&g| g >= 0.0).collect(),
            cases,
            gap,
        ),
        sweep(
            [
                "axial-coplanar",
                "The same corridors pressed flat along one axis, so that doors across it are nearly on one plane.",
                "flatness: height by width",
            ],
            powers_of_ten(-12, 0, if quick { 6 } else { 2 }),
            cases,
            coplanar,
        ),
        sweep(
            [
                "axial-slivers",
                "Three to six doors across one axis or three, all as wide as the parameter says along one of their sides \
                 and a metre along the other, some metres apart, round a line and aside by about half of their width.",
                "width of the doors",
            ],
            powers_of_ten(-12, 4, if quick { 8 } else { 2 }),
            cases,
            sliver,
        ),
        sweep(
            [
                "axial-length",
                "Long sequences of doors round a line of integers, with edges at the next points of a grid beside it. The \
                 truth is that line, checked in integers, or six of the doors that brute force finds blocked.",
                "number of doors",
            ],
            if quick { vec![4.0, 16.0] } else { vec![2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 200.0] },
            cases.min(100),
            length,
        ),
    ]
}

fn distance(far: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = 2 + random.below(6);
    let doors = walk(random, n);
    let by = [0, 1, 2].map(|_| far * (0.5 + 0.5 * random.unit()));
    let unit = 0.1 + 0.4 * random.unit();
    case(placed(random, &doors, |random, k, x| nudged(random, by[k] + unit * x as f64, 3)))
}

fn scale(factor: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = 2 + random.below(6);
    let doors = walk(random, n);
    let unit = factor * (0.1 + 0.4 * random.unit());
    case(placed(random, &doors, |random, _, x| nudged(random, unit * x as f64, 3)))
}

fn gap(ulps: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = 2 + random.below(6);
    let doors = walk(random, n);
    // Wide as up to 30, so that all coordinates are from 512 to before 1024 and the largest gap is an eighth.
    let place = |random: &mut Random, _, x: i64| {
        let x = (700 + x) as f64;
        match random.below(8) {
            0 => up_by(x, ulps as i64),
            1 => up_by(x, -(ulps as i64)),
            _ => x,
        }
    };
    case(placed(random, &doors, place))
}

fn coplanar(flat: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = 2 + random.below(6);
    let doors = walk(random, n);
    let unit = 0.1 + 0.4 * random.unit();
    let base = [0, 1, 2].map(|_| 10.0 * signed_unit(random));
    let flattened = random.below(3);
    let place = |random: &mut Random, k: usize, x: i64| {
        let x = unit * x as f64;
        nudged(random, base[k] + if k == flattened { flat * x } else { x }, 1)
    };
    case(placed(random, &doors, place))
}

fn sliver(width: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = 3 + random.below(4);
    let start = [0, 1, 2].map(|_| 10.0 * signed_unit(random));
    let towards = [0, 1, 2].map(|_| 0.3 + random.unit());
    let is_straight = random.below(2) == 0;
    let mut t = 0.0;
    let doors = (0..n).map(|_| {
        t += 1.0 + 3.0 * random.unit();
        let axis = if is_straight { 0 } else { random.below(3) };
        let thin = (axis + 1 + random.below(2)) % 3;
        let mut extent = Aabb { min: [0.0; 3], max: [0.0; 3] };
        for k in 0..3 {
            let middle = start[k] + t * towards[k];
            let size = if k == thin { width } else { 1.0 };
            let middle = if k == axis { middle } else { middle + 0.6 * size * signed_unit(random) };
            let half = if k == axis { 0.0 } else { size / 2.0 };
            (extent.min[k], extent.max[k]) = (middle - half, middle + half);
        }
        AxialDoor { extent, axis: axis as u8, forward: true }
    });
    case(doors.collect())
}

fn length(n_doors: f64, random: &mut Random) -> Option<(AxialDoors, bool)> {
    let n = n_doors as usize;
    let towards = [0, 1, 2].map(|_| between(random, 1 << 10, 1 << 14));
    let mut t = 0;
    let mut is_open = true;
    let mut wrong = None;
    let mut doors = Vec::with_capacity(n);
    for i in 0..n {
        t += between(random, 1, 5);
        let axis = random.below(3);
        let mut hole = [[0; 2]; 3];
        // The line is at t · towards when it is in the plane; t is a whole number plus a fraction of this axis.
        let at = t * towards[axis] + between(random, 0, towards[axis] - 1);
        hole[axis] = [at, at];
        for k in (0..3).filter(|&k| k != axis) {
            let (numerator, denominator) = (i128::from(at) * i128::from(towards[k]), i128::from(towards[axis]));
            let below = numerator.div_euclid(denominator) as i64;
            let is_whole = numerator.rem_euclid(denominator) == 0;
            let [low, high] = [below - between(random, 0, 2), below + 1 + between(random, 0, 2)];
            hole[k] = [if is_whole && low == below { low - 1 } else { low }, high];
        }
        if random.below(2 * n) == 0 {
            let k = (axis + 1 + random.below(2)) % 3;
            let by = between(random, 2, 6);
            hole[k] = hole[k].map(|x| x + by);
            (is_open, wrong) = (false, Some(i));
        }
        doors.push((axis, hole));
    }
    let passes = |(axis, hole): &GridDoor| {
        (0..3).filter(|k| k != axis).all(|k| {
            let at = i128::from(hole[*axis][0]) * i128::from(towards[k]);
            let scale = i128::from(towards[*axis]);
            i128::from(hole[k][0]) * scale < at && at < i128::from(hole[k][1]) * scale
        })
    };
    let is_open = is_open || doors.iter().all(passes);
    debug_assert!(!is_open || doors.iter().all(passes));
    let doors = placed(random, &doors, |_, _, x| x as f64);
    let doors = AxialDoors(doors);
    if is_open {
        return Some((doors, true));
    }
    // Blocked, if few of them are.
    let wrong = wrong?;
    let others = [wrong.saturating_sub(2), wrong.saturating_sub(1), wrong, wrong + 1, wrong + 2, 0, n - 1];
    let mut few: Vec<usize> = others.into_iter().filter(|&i| i < n).collect();
    few.sort_unstable();
    few.dedup();
    let few: Vec<AxialDoor> = few.into_iter().map(|i| doors.0[i]).collect();
    (!axial_stabbable_brute_force(&few)).then_some((doors, false))
}
