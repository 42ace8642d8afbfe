//! Triangles of which some hide from their fronts only, and segments among them, decided exactly.

use crate::meshes::{Soup, quad, soup};
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3, Random, orient3d};

/// A soup of which each triangle may hide from its front only, and may be turned round.
#[derive(Debug, Clone)]
pub struct Mixed {
    /// Those that hide from both sides.
    pub both_sides: Soup,
    /// Those that hide from their fronts only.
    pub fronts: Soup,
}

/// Soups in which none, some or all of the triangles have one side.
pub fn mixed() -> impl Strategy<Value = Mixed> {
    // One, some or all of them have one side; whole surfaces are turned alike, or each triangle as it comes.
    let sides = prop_oneof![Just(0u8), Just(3), any::<u8>()];
    let turns = prop_oneof![2 => Just(0u8), 2 => Just(255), 1 => any::<u8>()];
    (soup(), sides, turns).prop_map(|(soup, sides, turns)| {
        let (mut both_sides, mut fronts) = (Soup::new(), Soup::new());
        for (k, [a, b, c]) in soup.into_iter().enumerate() {
            let t = if turns >> (k % 8) & 1 == 0 { [a, b, c] } else { [a, c, b] };
            if sides >> (k / 4 % 8) & 1 == 1 { both_sides.push(t) } else { fronts.push(t) }
        }
        Mixed { both_sides, fronts }
    })
}

/// Squares of a lattice, of which up to four meet at an edge, each with both sides or one of two: chains close there whose triangles do not
/// agree.
pub fn lattice() -> impl Strategy<Value = Mixed> {
    let sides = || prop::collection::vec(0u8..8, 108);
    sides().prop_map(|sides| {
        let (mut both_sides, mut fronts) = (Soup::new(), Soup::new());
        let mut sides = sides.into_iter();
        for (axis, place) in (0..3).flat_map(|axis| (0..36).map(move |place| (axis, place))) {
            let corner = |u: i32, v: i32| {
                let mut p = [f64::from(place / 9); 3];
                p[(axis + 1) % 3] = f64::from(place % 3 + u);
                p[(axis + 2) % 3] = f64::from(place / 3 % 3 + v);
                p
            };
            let square = quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)], false);
            match sides.next() {
                Some(0 | 1) => both_sides.extend(square),
                Some(2..5) => fronts.extend(square),
                Some(5..7) => fronts.extend(square.map(turn)),
                _ => {}
            }
        }
        Mixed { both_sides, fronts }
    })
}

/// The lower corner of a box in or around the lattice.
pub fn corner() -> impl Strategy<Value = Point3> {
    [-2i32..4, -2i32..4, -2i32..4].prop_map(|p| p.map(|x| f64::from(x) + 0.1))
}

/// The same triangle with the opposite front.
pub fn turn([a, b, c]: [Point3; 3]) -> [Point3; 3] {
    [a, c, b]
}

/// Whether a segment certainly touches a triangle nowhere. Exact.
fn is_apart(p: Point3, q: Point3, &[a, b, c]: &[Point3; 3]) -> bool {
    let [from, to] = [p, q].map(|e| orient3d(a, b, c, e));
    if from * to > 0.0 {
        return true;
    }
    let turns = [[a, b], [b, c], [c, a]].map(|[x, y]| orient3d(p, q, x, y));
    turns.iter().any(|&s| s > 0.0) && turns.iter().any(|&s| s < 0.0)
}

impl Mixed {
    /// A segment from one box to another that meets nothing, but for what it passes from behind, out of `n`.
    pub fn free_segment(&self, v: &Aabb<3>, e: &Aabb<3>, seed: u64, n: u32) -> Option<[Point3; 2]> {
        let mut random = Random::new(seed);
        (0..n).map(|_| [random.point(v), random.point(e)]).find(|&segment| self.is_free(segment))
    }

    /// Whether a segment certainly meets nothing, but for what it passes from behind. Exact.
    pub fn is_free(&self, [p, q]: [Point3; 2]) -> bool {
        let passes = |t: &[Point3; 3]| orient3d(t[0], t[1], t[2], p) < 0.0 || is_apart(p, q, t);
        self.both_sides.iter().all(|t| is_apart(p, q, t)) && self.fronts.iter().all(passes)
    }
}
