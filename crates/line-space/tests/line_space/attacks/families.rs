//! Families of scenes on a small lattice, where touching, coplanar and coincident parts are common.

use super::lattice::{At, Cuboid, GRAIN, Goal, STEP};
use sightlines_geometry::Random;

type Soup = Vec<[At; 3]>;

/// What a scene is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    /// Triangles between any points.
    Junk,
    /// Squares between the cells of a grid, most of them there.
    Faces,
    /// A sheet of one height above each point of a grid: a bowl around one end, or noise.
    Sheet,
    /// Boxes that overlap.
    Solids,
    /// Steps up and down, forth and back, some through each other.
    Stairs,
    /// Slats that overlap, touch or leave gaps as seen.
    Louvre,
    /// Tubes around an end, twisted or not, some with caps, and bands with one side.
    Tube,
    /// Pages that share an edge.
    Book,
    /// Flat pieces that meet or overlap in one plane, and walls that stand on them.
    Floor,
}

impl Family {
    pub(super) const ALL: [Self; 9] = [
        Self::Junk,
        Self::Faces,
        Self::Sheet,
        Self::Solids,
        Self::Stairs,
        Self::Louvre,
        Self::Tube,
        Self::Book,
        Self::Floor,
    ];
}

/// Triangles, and pairs to ask about.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) triangles: Soup,
    pub(super) pairs: Vec<(Cuboid, Goal)>,
}

fn chance(random: &mut Random, of_eight: usize) -> bool {
    random.below(8) < of_eight
}

/// A whole number from `low` to `high`.
fn whole(random: &mut Random, low: i64, high: i64) -> i64 {
    low + random.below((high - low + 1) as usize) as i64
}

fn lattice(x: i64, y: i64, z: i64) -> At {
    [x * STEP, y * STEP, z * STEP]
}

fn quad([a, b, c, d]: [At; 4], random: &mut Random) -> [[At; 3]; 2] {
    if chance(random, 4) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// The rectangle across `axis` at `at`, between two corners.
fn across(axis: usize, at: i64, [u, v]: [[i64; 2]; 2]) -> [At; 4] {
    [[u[0], v[0]], [u[1], v[0]], [u[1], v[1]], [u[0], v[1]]].map(|[x, y]| {
        let mut p = [at * STEP; 3];
        (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (x * STEP, y * STEP);
        p
    })
}

fn junk(random: &mut Random) -> Soup {
    let n = 2 + random.below(14);
    (0..n).map(|_| [0; 3].map(|_: i64| [0; 3].map(|_: i64| whole(random, 0, 4) * STEP))).collect()
}

fn faces(random: &mut Random) -> Soup {
    let (n, most) = (whole(random, 2, 3), [6, 7, 8][random.below(3)]);
    let mut all = Soup::new();
    for axis in 0..3 {
        for at in 0..=n {
            if chance(random, 2) {
                all.extend(quad(across(axis, at, [[0, n], [0, n]]), random));
                continue;
            }
            for u in 0..n {
                for v in 0..n {
                    if chance(random, most) {
                        all.extend(quad(across(axis, at, [[u, u + 1], [v, v + 1]]), random));
                    }
                }
            }
        }
    }
    all
}

fn sheet(random: &mut Random) -> Soup {
    let n = 4i64;
    let (kind, base) = (random.below(3), whole(random, 0, 3));
    let heights: Vec<i64> = (0..(n + 1) * (n + 1))
        .map(|i| {
            let far = (i / (n + 1) - 2).abs().max((i % (n + 1) - 2).abs());
            let noise = whole(random, 0, 2);
            match kind {
                0 => base + noise,
                1 => 3 - far + noise / 2,
                _ => far + noise / 2,
            }
        })
        .collect();
    let at = |y: i64, z: i64| lattice(heights[(y * (n + 1) + z) as usize], 2 * y - 2, 2 * z - 2);
    let squares = (0..n * n).map(|i| (i / n, i % n));
    squares.flat_map(|(y, z)| quad([at(y, z), at(y + 1, z), at(y + 1, z + 1), at(y, z + 1)], random)).collect()
}

fn solids(random: &mut Random) -> Soup {
    let mut all = Soup::new();
    for _ in 0..1 + random.below(3) {
        let min = [0; 3].map(|_: i64| whole(random, -2, 3));
        let max = min.map(|x| x + whole(random, 1, 6));
        for k in 0..3 {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            for at in [min[k], max[k]] {
                all.extend(quad(across(k, at, [[min[u], max[u]], [min[v], max[v]]]), random));
            }
        }
    }
    all
}

/// Quads along z, from each point of a path in the plane to the next.
fn prism(path: &[[i64; 2]], z: [i64; 2], random: &mut Random) -> Soup {
    let quads = path.windows(2).map(|p| {
        let corner = |p: [i64; 2], z: i64| lattice(p[0], p[1], z);
        [corner(p[0], z[0]), corner(p[1], z[0]), corner(p[1], z[1]), corner(p[0], z[1])]
    });
    quads.flat_map(|q| quad(q, random)).collect()
}

fn stairs(random: &mut Random) -> Soup {
    let mut at = [whole(random, 1, 3), -3];
    let mut path = vec![at];
    for i in 0..4 + random.below(8) {
        if i % 2 == 0 {
            at[1] += whole(random, 1, 3);
        } else {
            at[0] = (at[0] + whole(random, -2, 2)).clamp(-1, 5);
        }
        if chance(random, 1) {
            at[1] -= 1;
        }
        path.push(at);
    }
    prism(&path, [-3, 7], random)
}

fn louvre(random: &mut Random) -> Soup {
    let (deep, high, pitch) = (whole(random, -2, 2), whole(random, 1, 3), whole(random, 1, 2));
    let x = whole(random, 1, 3);
    let slats = (-2..4).map(|i| [[x, i * pitch], [x + deep, i * pitch + high]]);
    slats.flat_map(|slat| prism(&slat, [-3, 7], random)).collect()
}

fn tube(random: &mut Random) -> Soup {
    const AROUND: [[i64; 2]; 8] = [[2, 0], [2, 2], [0, 2], [-2, 2], [-2, 0], [-2, -2], [0, -2], [2, -2]];
    let (turn, is_mobius) = (random.below(8), chance(random, 1));
    let mut rings: Vec<Vec<At>> = Vec::new();
    for (x, by) in [(-1, 0), (2, turn), (5, 2 * turn)] {
        let mut ring = Vec::new();
        for i in 0..8 {
            let [y, z] = AROUND[(i + by) % 8];
            ring.push(lattice(x + whole(random, 0, 1), 2 + y, 2 + z));
        }
        rings.push(ring);
    }
    let mut all = Soup::new();
    for pair in rings.windows(2) {
        for i in 0..8 {
            let j = (i + 1) % 8;
            // Of a band with one side, the last quad is twisted.
            let twisted = is_mobius && j == 0;
            let [a, b] = if twisted { [pair[1][j], pair[0][j]] } else { [pair[0][j], pair[1][j]] };
            all.extend(quad([pair[0][i], a, b, pair[1][i]], random));
        }
    }
    for ring in [&rings[0], &rings[2]] {
        if chance(random, 5) {
            let middle = lattice(ring[0][0] / STEP + whole(random, -1, 1), 2, 2);
            all.extend((0..8).map(|i| [ring[i], ring[(i + 1) % 8], middle]));
        }
    }
    all
}

fn book(random: &mut Random) -> Soup {
    let [x, y] = [whole(random, 1, 3), whole(random, 0, 4)];
    let mut all = Soup::new();
    for _ in 0..2 + random.below(5) {
        let [u, v] = [whole(random, -2, 6), if chance(random, 4) { -6 } else { 10 }];
        all.extend(prism(&[[x, y], [u, v]], [-3, 7], random));
    }
    all
}

fn floor(random: &mut Random) -> Soup {
    let (x, n) = (whole(random, 1, 3), whole(random, 1, 3));
    let tilt = [whole(random, -1, 1), whole(random, -1, 1)].map(|t| if chance(random, 4) { 0 } else { t });
    let at = |y: i64, z: i64| lattice(x + tilt[0] * y + tilt[1] * z, y, z);
    let mut all = Soup::new();
    for i in 0..n * n {
        let [y, z] = [i / n, i % n].map(|i| 12 / n * i - 4);
        let far = 12 / n;
        if chance(random, 7) {
            all.extend(quad([at(y, z), at(y + far, z), at(y + far, z + far), at(y, z + far)], random));
        }
    }
    let any = |random: &mut Random| [0; 2].map(|_: i64| whole(random, -4, 8));
    for _ in 0..random.below(3) {
        all.push([0; 3].map(|_: i64| any(random)).map(|[y, z]| at(y, z)));
    }
    for _ in 0..1 + random.below(6) {
        let ([a, b], [c, d]) = (any(random), any(random));
        let up = [0; 2].map(|_: i64| whole(random, -3, 3) * STEP);
        let above = |p: At, up: i64| [p[0] + up, p[1], p[2]];
        all.extend(quad([at(a, b), at(c, d), above(at(c, d), up[0]), above(at(a, b), up[1])], random));
    }
    all
}

/// Some triangles are cut in two, there twice, turned over or missing; others lie on them.
fn damaged(mut all: Soup, random: &mut Random) -> Soup {
    let halved = if chance(random, 3) { random.below(4) } else { 0 };
    for _ in 0..halved {
        let i = random.below(all.len());
        let [a, b, c] = all.swap_remove(i);
        let middle: At = std::array::from_fn(|k| a[k] + (b[k] - a[k]) / 2);
        all.extend([[a, middle, c], [middle, b, c]]);
    }
    for t in &mut all {
        if chance(random, 2) {
            t.swap(0, 1);
        }
    }
    if chance(random, 2) {
        let [a, b, c] = all[random.below(all.len())];
        all.push(if chance(random, 4) { [b, c, a] } else { [b, std::array::from_fn(|k| b[k] + c[k] - a[k]), c] });
    }
    if chance(random, 3) {
        for _ in 0..random.below(3) {
            let i = random.below(all.len());
            all.swap_remove(i);
        }
    }
    all
}

/// A box on the lattice or halfway between its points, flat along some axes.
fn cuboid(random: &mut Random) -> Cuboid {
    let min = [0; 3].map(|_: i64| whole(random, -1, 9) * STEP / 2);
    let flat = chance(random, 2);
    let max = min.map(|x| x + whole(random, i64::from(!flat), 3) * STEP / 2);
    [min, max]
}

/// Corners are moved by a few grains: together where they are one, or each by itself, which leaves slits.
pub(super) fn shaken(all: Soup, together: bool, random: &mut Random) -> Soup {
    let seed = random.bits() | 1;
    let mut corner = |p: At| {
        let mut own = Random::new(p.iter().fold(seed, |h, &x| (h ^ x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let source = if together { &mut own } else { &mut *random };
        p.map(|x| x + whole(source, -2, 2) * GRAIN)
    };
    all.into_iter().map(|t| t.map(&mut corner)).collect()
}

fn goal(triangles: &[[At; 3]], random: &mut Random) -> Goal {
    match random.below(8) {
        0..=3 => Goal::Cuboid(cuboid(random)),
        4..=5 => Goal::Triangle(triangles[random.below(triangles.len())]),
        6 => Goal::Triangle([0; 3].map(|_: i64| [0; 3].map(|_: i64| whole(random, -8, 12) * STEP))),
        _ => Goal::Triangle([0; 3].map(|_: i64| [0; 3].map(|_: i64| whole(random, 0, 4) * STEP))),
    }
}

/// Turned by an angle about an axis through (2, 2, 2), and rounded to the grain; a quarter turn is exact.
fn turned(all: Soup, axis: usize, angle: f64) -> Soup {
    let (c, s) = if angle == 90.0 { (0.0, 1.0) } else { (angle.to_radians().cos(), angle.to_radians().sin()) };
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let turn = |p: At| {
        let [x, y] = [p[u] - 2 * STEP, p[v] - 2 * STEP].map(|x| x as f64);
        let mut p = p;
        let rounded = |x: f64| (x / GRAIN as f64).round() as i64 * GRAIN + 2 * STEP;
        (p[u], p[v]) = (rounded(c * x - s * y), rounded(s * x + c * y));
        p
    };
    all.into_iter().map(|t| t.map(turn)).collect()
}

const ANGLES: [f64; 8] = [90.0, 1e-6, 1e-3, 1.0, 20.0, 45.0, 60.0, 89.9999];

fn made(family: Family, random: &mut Random) -> Soup {
    match family {
        Family::Junk => junk(random),
        Family::Faces => faces(random),
        Family::Sheet => sheet(random),
        Family::Solids => solids(random),
        Family::Stairs => stairs(random),
        Family::Louvre => louvre(random),
        Family::Tube => tube(random),
        Family::Book => book(random),
        Family::Floor => floor(random),
    }
}

/// A scene of a family, some with one of another, and pairs of which the second is asked about from the first.
pub(super) fn case(family: Family, random: &mut Random) -> Case {
    let mut all = made(family, random);
    if chance(random, 2) {
        all.extend(made(Family::ALL[random.below(Family::ALL.len())], random));
    }
    let mut triangles = damaged(all, random);
    if triangles.is_empty() {
        triangles = junk(random);
    }
    // Any axis may be the one that the family prefers, either way round.
    let (by, mirror) = (random.below(3), random.below(8));
    let moved = |p: At| {
        std::array::from_fn(|k| if mirror >> k & 1 == 1 { 4 * STEP - p[(k + by) % 3] } else { p[(k + by) % 3] })
    };
    triangles = triangles.into_iter().map(|t| t.map(moved)).collect();
    if chance(random, 2) {
        triangles = turned(triangles, random.below(3), ANGLES[random.below(ANGLES.len())]);
    }
    if chance(random, 2) {
        let together = chance(random, 3);
        triangles = shaken(triangles, together, random);
    }
    let n = 6;
    let pairs = (0..n).map(|_| (cuboid(random), goal(&triangles, random))).collect();
    Case { triangles, pairs }
}
