//! Strategies for sequences of oriented portals on small integer grids.
//!
//! Everything is drawn as small numbers and then built from them, so that shrinking works and shared
//! ends, collinear ends and parallel portals are common.

use crate::exact::{Form, Hp};
use proptest::prelude::*;
use sightlines_geometry::{Point2, Portal2};

/// A portal as (left end, right end), seen by who passes it.
pub type PortalPair = (Point2, Point2);

/// The same portals in the type that cell graphs use.
pub fn as_portals(pairs: &[PortalPair]) -> Vec<Portal2> {
    pairs.iter().map(|&(left, right)| Portal2 { left, right }).collect()
}

type Grid = [i32; 2];

/// Integer matrices that keep convex cells convex: turns, mirrors, shears.
const MATRICES: [[i32; 4]; 8] = [
    [1, 0, 0, 1],
    [0, -1, 1, 0],
    [-1, 0, 0, -1],
    [0, 1, 1, 0],
    [1, 1, 0, 1],
    [2, 1, 1, 1],
    [1, -2, 1, 3],
    [-1, 2, 2, 1],
];

/// Applies a matrix; one that mirrors exchanges left and right.
fn transformed(portals: &[[Grid; 2]], matrix: [i32; 4]) -> Vec<PortalPair> {
    let [a, b, c, d] = matrix;
    let point = |[x, y]: Grid| Point2::new(f64::from(a * x + b * y), f64::from(c * x + d * y));
    let mirror = a * d - b * c < 0;
    let pair = |&[l, r]: &[Grid; 2]| if mirror { (point(r), point(l)) } else { (point(l), point(r)) };
    portals.iter().map(pair).collect()
}

fn matrix() -> impl Strategy<Value = [i32; 4]> {
    prop::sample::select(MATRICES.to_vec())
}

/// 2 to 10 portals of a true corridor: consecutive ones lie on different sides of one convex cell,
/// which is a box, a box under an integer matrix, or a triangle. About as many are stabbable as not.
pub fn corridor() -> impl Strategy<Value = Vec<PortalPair>> {
    prop_oneof![kd_corridor(), strip_corridor()]
}

/// Portals between boxes, as a k-d tree makes them, for a walk that goes in +x and +y only; then
/// moved by an integer matrix.
pub fn kd_corridor() -> impl Strategy<Value = Vec<PortalPair>> {
    let step = (any::<bool>(), [0i32..12, 0..12, 0..3, 0..3, 0..3]);
    (prop::collection::vec(step, 2..=10), matrix()).prop_map(|(steps, m)| transformed(&kd_walk(&steps), m))
}

fn kd_walk(steps: &[(bool, [i32; 5])]) -> Vec<[Grid; 2]> {
    // The cell, as [low, high] along both axes.
    let mut cell = [[0, 3], [0, 3]];
    let mut portals = Vec::new();
    for &(up, [a, b, deep, below, above]) in steps {
        let (axis, across) = if up { (1, 0) } else { (0, 1) };
        let [low, high] = cell[across];
        let from = low + a % (high - low);
        let to = from + 1 + b % (high - from);
        let at = cell[axis][1];
        // Going up, ascending x is from left to right; going in +x, ascending y from right to left.
        portals.push(if up { [[from, at], [to, at]] } else { [[at, to], [at, from]] });
        cell[axis] = [at, at + 1 + deep];
        cell[across] = [from - below, to + above];
    }
    portals
}

/// The free edges of a strip of triangles, one more corner at each step; then moved by a matrix.
pub fn strip_corridor() -> impl Strategy<Value = Vec<PortalPair>> {
    let step = (any::<bool>(), 0usize..60);
    (prop::collection::vec(step, 2..=9), matrix()).prop_map(|(steps, m)| transformed(&strip_walk(&steps), m))
}

fn strip_walk(steps: &[(bool, usize)]) -> Vec<[Grid; 2]> {
    let mut edge = [[0, 2], [0, 0]];
    let mut portals = vec![edge];
    for &(left, choice) in steps {
        let ahead = edge[0][0].max(edge[1][0]);
        let middle = (edge[0][1] + edge[1][1]) / 2;
        let near = (0..=2).flat_map(|dx| (-3..=3).map(move |dy| [ahead + dx, middle + dy]));
        // Beyond the edge means on the left, going along it from its left to its right end.
        let beyond: Vec<Grid> = near.filter(|&q| turn(edge[0], edge[1], q) > 0).collect();
        if beyond.is_empty() {
            break;
        }
        edge[usize::from(!left)] = beyond[choice % beyond.len()];
        portals.push(edge);
    }
    portals
}

fn turn(p: Grid, q: Grid, r: Grid) -> i128 {
    let [p, q, r] = [p, q, r].map(|g| Hp::new(g.map(i128::from)));
    Form::through(&p, &q).at(&r)
}

/// 1 to 7 oriented segments without any relation, each of some length.
pub fn any_portals() -> impl Strategy<Value = Vec<PortalPair>> {
    let end = || (-4i32..=4, -4i32..=4).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)));
    let portal = (end(), end()).prop_filter("of some length", |(l, r)| l != r);
    prop::collection::vec(portal, 1..=7)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stab::stabbable_brute_force;

    /// Whether the four ends of two consecutive portals lie round a convex cell that the first leads
    /// into and the second out of: neither has an end of the other strictly on its wrong side.
    fn leads_on(first: PortalPair, second: PortalPair) -> bool {
        let beyond = |p: PortalPair, q: Point2| sightlines_geometry::orient2d(p.0, p.1, q);
        let after = [second.0, second.1].map(|q| beyond(first, q));
        let before = [first.0, first.1].map(|q| beyond(second, q));
        after.iter().all(|&x| x >= 0.0) && before.iter().all(|&x| x <= 0.0) && after.iter().any(|&x| x > 0.0)
    }

    proptest! {
        #[test]
        fn corridor_portals_lead_from_cell_to_cell(portals in corridor()) {
            prop_assert!((1..=10).contains(&portals.len()));
            for w in portals.windows(2) {
                prop_assert!(leads_on(w[0], w[1]), "{:?}", w);
            }
        }
    }

    /// All three answers and both kinds of degeneracy are common, for each kind of corridor.
    #[test]
    fn corridor_cases_are_mixed() {
        let strategies = [kd_corridor().boxed(), strip_corridor().boxed(), any_portals().boxed()];
        for (kind, strategy) in strategies.iter().enumerate() {
            let (mut stabs, mut shared) = ([0; 3], 0);
            for portals in crate::draw(strategy, 400) {
                stabs[stabbable_brute_force(&portals) as usize] += 1;
                shared += i32::from(portals.windows(2).any(|w| w[0].0 == w[1].0 || w[0].1 == w[1].1));
            }
            assert!(stabs.iter().all(|&n| n >= 5) && stabs[0] > 60, "{kind}: {stabs:?}");
            assert!(kind == 2 || shared > 100, "{kind}: {shared}");
        }
    }

    /// The impostor: a portal turned round does not lead on.
    #[test]
    fn corridor_check_can_fail() {
        for portals in crate::draw(&corridor(), 50) {
            let Some(&[first, (l, r)]) = portals.first_chunk() else { continue };
            assert!(!leads_on(first, (r, l)));
        }
    }
}
