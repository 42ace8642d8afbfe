//! Sheets of a mesh: a wall of two halves with a gap between, in front of the middle or aside.

use super::{EPSILON, levels_of_two, naive};
use crate::stability::{Answer, Decide, Kind, Sweep, method};
use sightlines::geometry::{Aabb, Point3, Random};
use sightlines::multifocal::mesh::{SheetMethod, Sheets};

/// The triangles of a wall; the eyes before it and the box behind.
#[derive(Debug, Clone)]
pub(super) struct Wall {
    pub(super) triangles: Vec<[Point3; 3]>,
    pub(super) eyes: Aabb<3>,
    pub(super) target: Aabb<3>,
}

fn hides(triangles: &[[Point3; 3]], wall: &Wall) -> Answer {
    let sheets = Sheets::new(triangles);
    let hidden = sheets.tester().hides(&wall.eyes, &wall.target, SheetMethod::DEFAULT_LIMIT);
    if hidden { Answer::Hidden } else { Answer::Seen }
}

pub(super) fn methods() -> Vec<Decide<Wall>> {
    vec![
        method("sheets", Kind::Shipped, |wall: &Wall| hides(&wall.triangles, wall)),
        method("sheets snapped", Kind::Naive, |wall: &Wall| hides(&naive::snapped(&wall.triangles, EPSILON), wall)),
    ]
}

/// A wall across the first axis at about 3, its halves parted along the second.
///
/// Eyes and target reach from 2.2 to 3.8 along the second axis, so lines between them cross the wall anywhere within, and nowhere
/// else: a gap there is open, however narrow, and one farther aside is not.
pub(super) fn wall(ulps: i64, random: &mut Random) -> (Wall, bool) {
    let x = 3.0 + 0.1 * random.unit();
    let is_aside = random.below(2) == 0;
    let left: f64 = if is_aside { 4.0 + random.unit() } else { 2.3 + 1.4 * random.unit() };
    let right = f64::from_bits(left.to_bits().wrapping_add_signed(ulps));
    let quad = |from: f64, to: f64| [[x, from, -9.1], [x, to, -9.1], [x, to, 9.3], [x, from, 9.3]];
    let triangles =
        [quad(-8.7, left), quad(right, 9.9)].iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]).collect();
    let across = |from: f64, to: f64| Aabb { min: [from, 2.2, -0.8], max: [to, 3.8, 0.7] };
    (Wall { triangles, eyes: across(-2.0, -1.0), target: across(7.0, 8.0) }, ulps > 0 && !is_aside)
}

/// The sweep of gaps in walls.
pub(super) fn gaps(quick: bool) -> Sweep {
    Sweep::of_cases(
        [
            "sheet-gaps",
            "A wall of two halves with a gap of some units in the last place between, before a box of eyes; it hides a box behind if there is \
             no gap, or if it lies where no line between the boxes passes. What is open is so by construction.",
            "gap (units in the last place)",
        ],
        std::iter::once(0.0).chain(levels_of_two(0, 44, if quick { 11 } else { 4 })).collect(),
        if quick { 500 } else { 5000 },
        methods(),
        |level, random| Some(wall(level as i64, random)),
    )
}
