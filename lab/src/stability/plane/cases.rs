//! The sweeps in the plane, and the sequences that they test.

use super::methods::{Doors, funnel, methods, said};
use super::naive::{Doubles, passes};
use super::truth::{is_chain, is_open};
use crate::stability::draws::{between, nudged, powers_of_ten, signed_unit};
use crate::stability::method::{Decide, Kind, method};
use crate::stability::sweep::Sweep;
use sightlines::geometry::{Point2, Portal2, Random};

type Grid = [i64; 2];

/// Integer matrices that keep convex cells convex: turns, mirrors, shears.
const MATRICES: [[i64; 4]; 6] = [[1, 0, 0, 1], [0, -1, 1, 0], [1, 1, 0, 1], [2, 1, 1, 1], [1, -2, 1, 3], [-1, 2, 2, 1]];

/// Doors between boxes, as a k-d tree makes them, for a walk towards +x and +y; then moved by an integer matrix. Ends on
/// one line and ends in common are frequent.
pub fn corridor(random: &mut Random, n_doors: usize) -> Vec<[Grid; 2]> {
    let mut cell = [[0, 3], [0, 3]];
    let [a, b, c, d] = MATRICES[random.below(MATRICES.len())];
    let image = |[x, y]: Grid| [a * x + b * y, c * x + d * y];
    let mut doors = Vec::with_capacity(n_doors);
    for _ in 0..n_doors {
        let (axis, across) = if random.below(2) == 0 { (1, 0) } else { (0, 1) };
        let [low, high] = cell[across];
        let from = low + between(random, 0, high - low - 1);
        let to = from + between(random, 1, high - from);
        let at = cell[axis][1];
        let [left, right] = if axis == 1 { [[from, at], [to, at]] } else { [[at, to], [at, from]] };
        let mirrored = a * d - b * c < 0;
        let [left, right] = [left, right].map(image);
        doors.push(if mirrored { [right, left] } else { [left, right] });
        cell[axis] = [at, at + between(random, 1, 3)];
        cell[across] = [from - between(random, 0, 2), to + between(random, 0, 2)];
    }
    doors
}

/// Doors whose coordinates are made of integers.
fn placed(doors: &[[Grid; 2]], mut place: impl FnMut(Grid) -> [f64; 2]) -> Vec<Portal2> {
    let mut end = |p: Grid| {
        let [x, y] = place(p);
        Point2::new(x, y)
    };
    doors.iter().map(|&[left, right]| Portal2 { left: end(left), right: end(right) }).collect()
}

/// A case, if cells could have made the doors.
fn case(doors: Vec<Portal2>) -> Option<(Doors, bool)> {
    let is_bounded = doors.iter().all(|d| [d.left, d.right].iter().all(|p| p.x.is_finite() && p.y.is_finite()));
    (is_bounded && is_chain(&doors)).then(|| {
        let open = is_open(&doors);
        (Doors(doors), open)
    })
}

/// All sweeps in the plane.
pub fn sweeps(quick: bool) -> Vec<Sweep> {
    let cases = if quick { 100 } else { 1000 };
    let step = if quick { 3 } else { 1 };
    let sweep = |texts, levels, cases, make: fn(f64, &mut Random) -> Option<(Doors, bool)>| {
        Sweep::of_cases(texts, levels, cases, methods(), make)
    };
    let lengths = if quick { vec![2.0, 20.0, 200.0] } else { vec![2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0] };
    vec![
        sweep(
            [
                "plane-distance",
                "Corridors of 2 to 8 doors, some metres long and with many ends on one line, are moved away from the \
                 origin and rounded there; a quarter of the coordinates is moved by up to three units in the last place.",
                "distance from the origin",
            ],
            powers_of_ten(0, 9, step),
            cases,
            distance,
        ),
        sweep(
            ["plane-scale", "The same corridors across the origin, scaled.", "scale"],
            powers_of_ten(-6, 6, step),
            cases,
            scale,
        ),
        sweep(
            [
                "plane-gap",
                "Three doors of which the first and the last leave what is right of a slanted line, and the middle one \
                 what is left of it. The last is moved aside: lines pass by a gap of so many units in the last place of \
                 its coordinates, which are about 10^3, 10^6 or 10^9, graze at 0, and are blocked below.",
                "gap in units in the last place",
            ],
            gaps(quick),
            cases,
            gap,
        ),
        sweep(
            [
                "plane-parallel",
                "Corridors pressed flat, so that all doors are nearly parallel, nearly on one line, and seen edge on.",
                "flatness: height by width",
            ],
            powers_of_ten(-14, 0, if quick { 7 } else { 2 }),
            cases,
            parallel,
        ),
        sweep(
            [
                "plane-grazing",
                "Doors with an end each on one slanted line through points of a grid, left and right ends in any order; \
                 some ends are one unit in the last place aside.",
                "number of doors",
            ],
            if quick { vec![3.0, 16.0] } else { vec![3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 32.0] },
            cases,
            grazing,
        ),
        sweep(
            [
                "plane-slivers",
                "Three to six doors across a line, all as wide as the parameter says, some metres apart, and aside by \
                 about half of their width.",
                "width of the doors",
            ],
            powers_of_ten(-12, 6, if quick { 6 } else { 2 }),
            cases,
            sliver,
        ),
        sweep(
            [
                "plane-length",
                "Long sequences of doors along a line, with ends at the next points of a fine grid beside it.",
                "number of doors",
            ],
            lengths,
            if quick { 50 } else { 200 },
            length,
        ),
        storage(
            if quick { vec![11.0, 24.0, 53.0] } else { vec![8.0, 11.0, 16.0, 20.0, 24.0, 32.0, 40.0, 48.0, 53.0] },
            cases,
        ),
    ]
}

/// Gaps in units in the last place: negative ones, zero, positive ones.
pub fn gaps(quick: bool) -> Vec<f64> {
    let positive: &[f64] = if quick {
        &[1.0, 256.0, 1_048_576.0, 1_099_511_627_776.0]
    } else {
        &[
            1.0,
            2.0,
            4.0,
            16.0,
            256.0,
            4096.0,
            65536.0,
            1_048_576.0,
            16_777_216.0,
            268_435_456.0,
            4_294_967_296.0,
            68_719_476_736.0,
            1_099_511_627_776.0,
        ]
    };
    let negative = positive.iter().rev().map(|g| -g);
    negative.chain([0.0]).chain(positive.iter().copied()).collect()
}

pub(in crate::stability) fn distance(far: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let n = 2 + random.below(7);
    let doors = corridor(random, n);
    // The same for all ends, so that what is on one line is rounded alike.
    let by = [far * (0.5 + 0.5 * random.unit()), far * signed_unit(random)];
    let unit = 0.1 + 0.4 * random.unit();
    case(placed(&doors, |p| [0, 1].map(|k| nudged(random, by[k] + unit * p[k] as f64, 3))))
}

pub(in crate::stability) fn scale(factor: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let n = 2 + random.below(7);
    let doors = corridor(random, n);
    let unit = factor * (0.1 + 0.4 * random.unit());
    // Across the origin, where coordinates are small and large, so that their differences are rounded.
    let by = [0, 1].map(|_| 6.0 * unit * signed_unit(random));
    case(placed(&doors, |p| [0, 1].map(|k| nudged(random, by[k] + unit * p[k] as f64, 3))))
}

pub(in crate::stability) fn gap(ulps: f64, random: &mut Random) -> Option<(Doors, bool)> {
    // All coordinates are from 512 to before 1024, where a unit in the last place is 2^-43.
    let unit = 2f64.powi(-43);
    let [p, q] = [between(random, 3, 60), between(random, 3, 60)];
    let width = between(random, 1, 2);
    let start = [between(random, 600, 640), between(random, 600, 640)];
    let (along, left) = ([p, q], [-q, p]);
    // Places along the line in those units too, so that points of it are doubles with all their bits in use.
    let places = [0.0, 1.2, 2.5].map(|t| ((t + 0.5 * random.unit()) / unit).floor() * unit);
    let at = |i: usize, w: i64| [0, 1].map(|k| start[k] as f64 + places[i] * along[k] as f64 + (w * left[k]) as f64);
    // A left end on the line; a right end on it; a left end that the gap moves to the left.
    let mut third_left = at(2, 0);
    let k = random.below(2);
    third_left[k] += ulps * unit * left[k].signum() as f64;
    let doors = [[at(0, 0), at(0, -width)], [at(1, width), at(1, 0)], [third_left, at(2, -width)]];
    let mirror = random.below(2) == 1;
    let size = 2f64.powi([0, 10, 20][random.below(3)]);
    let point = |[x, y]: [f64; 2]| Point2::new(size * if mirror { 1536.0 - x } else { x }, size * y);
    let door = |[l, r]: [[f64; 2]; 2]| {
        let (l, r) = (point(l), point(r));
        if mirror { Portal2 { left: r, right: l } } else { Portal2 { left: l, right: r } }
    };
    let (doors, open) = case(doors.map(door).to_vec())?;
    debug_assert_eq!(open, ulps > 0.0, "{doors:?}");
    Some((doors, open))
}

pub(in crate::stability) fn parallel(flat: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let n = 3 + random.below(5);
    let doors = corridor(random, n);
    let unit = 0.1 + 0.4 * random.unit();
    let turn = [0.8, 0.6];
    case(placed(&doors, |p| {
        let [x, y] = [unit * p[0] as f64, flat * (unit * p[1] as f64)];
        [turn[0] * x - turn[1] * y, turn[1] * x + turn[0] * y].map(|x| nudged(random, x, 1))
    }))
}

pub(in crate::stability) fn grazing(n_doors: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let [p, q] = [between(random, 1, 9), between(random, 1, 9)];
    let start = [between(random, -50, 50), between(random, -50, 50)];
    let unit = [1.0, 0.1, 1e-3, 12345.678][random.below(4)];
    // Few ends are moved in long sequences, or none would be open.
    let rarely = n_doors as usize;
    let doors: Vec<Portal2> = (0..n_doors as i64)
        .map(|t| {
            let width = between(random, 1, 3);
            let at = |w: i64| [start[0] + t * p - w * q, start[1] + t * q + w * p].map(|x| unit * x as f64);
            let (is_left, is_moved) = (random.below(2) == 0, random.below(3 * rarely) < rarely + 2);
            let mut end = at(0);
            if is_moved {
                let k = random.below(2);
                // Mostly away from the opening.
                let out = (if k == 0 { -1 } else { 1 }) * if is_left { 1 } else { -1 };
                let ulps = if random.below(rarely) == 0 { -out } else { out };
                end[k] = crate::stability::draws::up_by(end[k], ulps);
            }
            let [end, other] = [end, at(if is_left { -width } else { width })].map(|[x, y]| Point2::new(x, y));
            if is_left { Portal2 { left: end, right: other } } else { Portal2 { left: other, right: end } }
        })
        .collect();
    case(doors)
}

pub(in crate::stability) fn sliver(width: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let n = 3 + random.below(4);
    let start = [10.0 * signed_unit(random), 10.0 * signed_unit(random)];
    let towards = [0.5 + random.unit(), signed_unit(random)];
    let mut t = 0.0;
    let mut doors = Vec::with_capacity(n);
    for _ in 0..n {
        t += 1.0 + 3.0 * random.unit();
        let middle = [0, 1].map(|k| start[k] + t * towards[k]);
        let aside = 0.6 * signed_unit(random);
        let tilt = 0.3 * signed_unit(random);
        // Across the way, tilted; wide doors would cross each other if they were.
        let along = if width < 1.0 { tilt } else { 0.0 };
        let across = [0, 1].map(|k| [-towards[1], towards[0]][k] + along * towards[k]);
        let end = |side: f64| {
            let [x, y] = [0, 1].map(|k| middle[k] + width * (aside + side) * across[k]);
            Point2::new(x, y)
        };
        doors.push(Portal2 { left: end(0.5), right: end(-0.5) });
    }
    case(doors)
}

pub(in crate::stability) fn length(n_doors: f64, random: &mut Random) -> Option<(Doors, bool)> {
    let n = n_doors as i64;
    let rise = between(random, -(1 << 18), 1 << 18);
    let base = between(random, -(1 << 20), 1 << 20);
    let (step, by) = (between(random, 3, 40), between(random, 1, 40));
    let unit = [1.0, 2f64.powi(-10)][random.below(2)];
    let doors: Vec<Portal2> = (0..n)
        .map(|i| {
            // The line in units of 1 / by of the grid.
            let height = base * by + i * rise;
            let (below, above) = (height.div_euclid(by), (height + by - 1).div_euclid(by));
            // Half of the sequences have an end on the wrong side of the line now and then.
            let wrong = random.below(8 * n as usize) == 0;
            let slack = [between(random, 0, 3), between(random, 0, 3)];
            let (left, right) = (above + slack[0], below - slack[1] - i64::from(above == below && slack == [0, 0]));
            let (left, right) = if wrong { (left + 5, right + 5) } else { (left, right) };
            let point = |y: i64| Point2::new((i * step) as f64 * unit, y as f64 * unit);
            Portal2 { left: point(left), right: point(right) }
        })
        .collect();
    case(doors)
}

/// Doors, and how many significant bits storage keeps of their coordinates.
#[derive(Debug, Clone)]
struct Stored(Doors, u32);

impl Stored {
    fn stored(&self) -> Vec<Portal2> {
        let round = |x: f64| {
            // Adding and taking away half of what is cut off, in the integers of the bits, rounds to nearest.
            let cut = 53 - self.1.min(53);
            let half = (1u64 << cut) >> 1;
            f64::from_bits(((x.to_bits() + half) >> cut) << cut)
        };
        let point = |p: Point2| Point2::new(round(p.x), round(p.y));
        self.0.0.iter().map(|d| Portal2 { left: point(d.left), right: point(d.right) }).collect()
    }
}

fn storage(levels: Vec<f64>, cases: usize) -> Sweep {
    let methods: Vec<Decide<Stored>> = vec![
        method("funnel", Kind::Shipped, |c| funnel(&c.0.0)),
        method("funnel exact of stored", Kind::Naive, |c| funnel(&c.stored())),
        method("funnel f64 of stored", Kind::Naive, |c| said(passes(&Doubles, &c.stored()))),
    ];
    let texts = [
        "plane-storage",
        "Corridors about 1000 metres from the origin, given in doubles. The shipped funnel gets these; the others get \
         coordinates of which storage has kept the leading bits: 11 is half precision, 24 single, 53 double. \
         However exact the arithmetic is, it decides about other doors.",
        "significant bits kept",
    ];
    Sweep::of_cases(texts, levels, cases, methods, |bits, random| {
        let (doors, open) = distance(1000.0, random)?;
        Some((Stored(doors, bits as u32), open))
    })
}
