//! Why no line passes some gates: left and right ends that no line separates.

use super::line::Point;
use super::network::PlanarNetwork;
use crate::exact::turn;
use crate::walk::gate_back;
use std::cmp::Ordering;

/// Ends of gates of a chain, one to three left ones and one to three right ones, four at most together, that no line
/// separates strictly: then no open set of lines passes the gates, each with its left end on the left.
///
/// Gates are counted from the end of the chain: 0 is the gate that the chain comes to, which must be among them.
///
/// Four are enough: Kirchberger, Math. Ann. 57, 1903.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanarBlock {
    /// The gates of the left ends.
    pub lefts: Vec<u32>,
    /// The gates of the right ends.
    pub rights: Vec<u32>,
}

impl PlanarBlock {
    /// The gates of the chain that it names, ascending, without the new one; `None` if it proves nothing. Exact.
    pub(super) fn gates(&self, network: &PlanarNetwork, chain: &[u32], gate: u32) -> Option<Vec<u32>> {
        let of = |back: &u32| gate_back(chain, gate, *back);
        let lefts: Vec<u32> = self.lefts.iter().map(of).collect::<Option<_>>()?;
        let rights: Vec<u32> = self.rights.iter().map(of).collect::<Option<_>>()?;
        let left = |k: usize| network.ends[lefts[k] as usize][0];
        let right = |k: usize| network.ends[rights[k] as usize][1];
        let holds = match (lefts.len(), rights.len()) {
            (1, 1) => left(0) == right(0),
            (1, 2) => is_between(left(0), right(0), right(1)),
            (2, 1) => is_between(right(0), left(0), left(1)),
            (2, 2) => meet([left(0), left(1)], [right(0), right(1)]),
            (1, 3) => is_in_triangle(left(0), [right(0), right(1), right(2)]),
            (3, 1) => is_in_triangle(right(0), [left(0), left(1), left(2)]),
            _ => false,
        };
        let mut gates: Vec<u32> = lefts.into_iter().chain(rights).collect();
        gates.sort_unstable();
        gates.dedup();
        let at = gates.binary_search(&gate).ok()?;
        gates.remove(at);
        holds.then_some(gates)
    }
}

/// Whether a point is on a closed segment.
fn is_between(p: Point, a: Point, b: Point) -> bool {
    let within = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
    turn(a, b, p) == Ordering::Equal && within(0) && within(1)
}

/// Whether two closed segments have a point in common.
fn meet([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let same = |x: Ordering, y: Ordering| x == y && x != Ordering::Equal;
    let of_first = [turn(c, d, a), turn(c, d, b)];
    let of_second = [turn(a, b, c), turn(a, b, d)];
    if same(of_first[0], of_first[1]) || same(of_second[0], of_second[1]) {
        return false;
    }
    let on_one_line = of_first.into_iter().chain(of_second).all(|side| side == Ordering::Equal);
    let overlap = |k: usize| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]);
    !on_one_line || (overlap(0) && overlap(1))
}

/// Whether a point is in a closed triangle that has an inside.
fn is_in_triangle(p: Point, [a, b, c]: [Point; 3]) -> bool {
    let way = turn(a, b, c);
    let sides = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
    way != Ordering::Equal && sides.into_iter().all(|side| side == way || side == Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point> {
        prop::array::uniform2((-3i32..4).prop_map(f64::from))
    }

    /// The oracle: whether a line through two of the points, turned or shifted a little, separates the sets; by trying
    /// all lines of a fine grid of integer coefficients, which separate whatever can be separated on so small a grid.
    fn separable(lefts: &[Point], rights: &[Point]) -> bool {
        let range = -8i32..9;
        range.clone().any(|a| {
            range.clone().any(|b| {
                let value = |p: &Point| f64::from(a) * p[0] + f64::from(b) * p[1];
                let low = lefts.iter().map(value).fold(f64::INFINITY, f64::min);
                low > rights.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
            })
        })
    }

    proptest! {
        /// Sound and tight for every form.
        #[test]
        fn blocked_is_what_no_line_separates(p in prop::collection::vec(point(), 4)) {
            prop_assert_eq!(p[0] == p[1], !separable(&p[..1], &p[1..2]));
            prop_assert_eq!(is_between(p[0], p[1], p[2]), !separable(&p[..1], &p[1..3]));
            prop_assert_eq!(meet([p[0], p[1]], [p[2], p[3]]), !separable(&p[..2], &p[2..]));
            let inside = is_in_triangle(p[0], [p[1], p[2], p[3]]);
            if turn(p[1], p[2], p[3]) != Ordering::Equal {
                prop_assert_eq!(inside, !separable(&p[..1], &p[1..]));
            } else {
                prop_assert!(!inside);
            }
        }
    }
}
