//! Narrow ways between two cells of a plan: sequences of portals, each with the line that keeps in the middle.
//!
//! Random rays miss slits. If two cells see each other, every cell on the way sees both; so it is looked along sequences of portals
//! through cells that the table lets both see, as long as some line passes all of them. Where one arrives, lines
//! are tried, and what is tried still has to be proven free. This is a search of its own, in plain doubles, which shares nothing with
//! the one that tables are made by.

use super::PlanWorld;
use crate::sight::{SightSegment, Target};
use sightlines_geometry::{Point2, orient2d};
use sightlines_pvs::{CellId, Table};

/// What a line has to have on its left and on its right to pass the portals of a sequence.
#[derive(Debug, Clone, Default)]
struct Sides {
    left: Vec<Point2>,
    right: Vec<Point2>,
}

struct Search<'a> {
    world: &'a PlanWorld,
    table: &'a Table,
    from: u32,
    to: u32,
    /// Steps that are left.
    budget: u32,
    cells: Vec<u32>,
}

/// Longer sequences are not looked along.
const LONGEST: usize = 64;

impl PlanWorld {
    /// Looks for a sight through sequences of portals, with up to 8 steps for each try.
    pub(super) fn through_slits(&self, table: &Table, from: u32, to: u32, tries: u32) -> Option<SightSegment> {
        let budget = tries.saturating_mul(8);
        let mut search = Search { world: self, table, from, to, budget, cells: vec![from] };
        search.go_on_from(from, None, &Sides::default())
    }
}

impl Search<'_> {
    /// Goes on from a cell, with a line that passes all portals so far.
    fn go_on_from(&mut self, cell: u32, line: Option<[Point2; 2]>, before: &Sides) -> Option<SightSegment> {
        let world = self.world;
        for &(next, left, right) in &world.gates[cell as usize] {
            let sees = |a: u32, b: u32| self.table.sees(CellId(a), CellId(b));
            if self.budget == 0 || self.cells.len() >= LONGEST {
                return None;
            }
            if self.cells.contains(&next) || !(next == self.to || (sees(self.from, next) && sees(self.to, next))) {
                continue;
            }
            self.budget -= 1;
            let mut sides = before.clone();
            sides.left.push(left);
            sides.right.push(right);
            let kept = line.filter(|l| side(l, left) > 0.0 && side(l, right) < 0.0);
            let Some(line) = kept.or_else(|| middle_line(&mut sides)) else { continue };
            self.cells.push(next);
            let found =
                if next == self.to { self.try_lines(line, sides) } else { self.go_on_from(next, Some(line), &sides) };
            if found.is_some() {
                return found;
            }
            self.cells.pop();
        }
        None
    }

    fn try_lines(&self, line: [Point2; 2], mut sides: Sides) -> Option<SightSegment> {
        let best = middle_line(&mut sides).unwrap_or(line);
        [best, line].into_iter().find_map(|l| self.try_line(l))
    }

    /// Tries segments of a line from the one cell to the other.
    fn try_line(&self, [a, b]: [Point2; 2]) -> Option<SightSegment> {
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let [p0, p1] = self.world.within(self.from, a, b - a, everywhere)?;
        let [q0, q1] = self.world.within(self.to, a, b - a, everywhere)?;
        let point = |[s, t]: [f64; 2], share: f64| a + (b - a) * (s + (t - s) * share);
        const SHARES: [f64; 5] = [0.5, 0.1, 0.9, 0.01, 0.99];
        SHARES.into_iter().flat_map(|s| SHARES.map(|t| (s, t))).find_map(|(s, t)| {
            let target = Target::Cell(CellId(self.to));
            let sight = PlanWorld::sight(self.from, target, point([p0, p1], s), point([q0, q1], t));
            super::RayOracle::proves(self.world, &sight).then_some(sight)
        })
    }
}

fn side([a, b]: &[Point2; 2], p: Point2) -> f64 {
    orient2d(*a, *b, p)
}

/// A line with all points of `left` on its left and those of `right` on its right, about in the middle of all such lines; `None` if
/// there is none, or but one.
///
/// Lines that have the points so are a convex set, as heights over the ends of a stretch; its corners are lines through two of the points, and
/// the mean of the corners is inside. Points on none of these lines are taken out: what more portals leave of the set is inside of it, and
/// they do not bound that either. O(n^3) for those that are left.
fn middle_line(sides: &mut Sides) -> Option<[Point2; 2]> {
    let (left, right) = (&sides.left, &sides.right);
    let inside = |l: &[Point2; 2]| {
        l.iter().all(|p| p.is_finite())
            && left.iter().all(|&p| side(l, p) > 0.0)
            && right.iter().all(|&p| side(l, p) < 0.0)
    };
    let (&l, &r) = (left.last()?, right.last()?);
    let across = r - l;
    // The last portal's points have to be there, whatever was taken out before.
    let straight = [(l + r) * 0.5, (l + r) * 0.5 + Point2::new(-across.y, across.x)];
    if inside(&straight) {
        return Some(straight);
    }
    let points: Vec<Point2> = left.iter().chain(right).copied().collect();
    let fits = |l: &[Point2; 2]| left.iter().all(|&p| side(l, p) >= 0.0) && right.iter().all(|&p| side(l, p) <= 0.0);
    let mut corners = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        for &q in &points[..i] {
            corners.extend([[p, q], [q, p]].into_iter().filter(|l| l[0] != l[1] && fits(l)));
        }
    }
    let bounding: Vec<Point2> = corners.iter().flatten().copied().collect();
    // Their directions are less than a half turn apart: the middle one is between the outermost.
    let turned = |sign: f64| {
        let directions = corners.iter().map(|[p, q]| *q - *p);
        directions.reduce(|best, d| if sign * best.perp_dot(d) > 0.0 { d } else { best })
    };
    let forward = (turned(1.0)?.normalize_or_zero() + turned(-1.0)?.normalize_or_zero()).try_normalize()?;
    // Heights of the corners over two places that are as far apart as the points.
    let along = |p: Point2| p.dot(forward);
    let low = points.iter().map(|&p| along(p)).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|&p| along(p)).fold(f64::NEG_INFINITY, f64::max);
    let up = forward.perp();
    let (low, high) = if high > low { (low, high) } else { (low - 1.0, high + 1.0) };
    let (mut sum, mut n) = ([0.0; 2], 0.0);
    for [p, q] in corners {
        let d = q - p;
        let run = along(d);
        if run > 0.0 {
            let height = |x: f64| p.dot(up) + d.dot(up) * ((x - along(p)) / run);
            sum = [sum[0] + height(low), sum[1] + height(high)];
            n += 1.0;
        }
    }
    let place = |x: f64, y: f64| forward * x + up * y;
    let line = [place(low, sum[0] / n), place(high, sum[1] / n)];
    let line = inside(&line).then_some(line)?;
    sides.left.retain(|p| bounding.contains(p));
    sides.right.retain(|p| bounding.contains(p));
    Some(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn p(x: f64, y: f64) -> Point2 {
        Point2::new(x, y)
    }

    #[test]
    fn the_middle_of_a_corridor_is_found() {
        let middle_line = |left: &[Point2], right: &[Point2]| {
            super::middle_line(&mut Sides { left: left.to_vec(), right: right.to_vec() })
        };
        let line = middle_line(&[p(0., 1.), p(5., 1.)], &[p(0., -1.), p(5., -1.)]).unwrap();
        assert!(line.iter().all(|q| q.y.abs() < 1e-9), "{line:?}");
        assert_eq!(middle_line(&[p(0., 1.), p(5., -1.), p(9., 1.)], &[p(0., 0.), p(5., -2.), p(9., 0.)]), None);
        // A slit of some units in the last place.
        let slit = 1.0 + 1e-13;
        assert!(middle_line(&[p(0., slit), p(5., 2.)], &[p(0., 1.), p(5., 0.)]).is_some());
    }

    proptest! {
        /// Invariant: if some line of a fine fan passes the portals, one is found; what is found passes.
        #[test]
        fn lines_are_found_where_there_are_some(
            gates in prop::collection::vec((-6i32..7, 1i32..5), 1..6), y in -40i32..41, slope in -40i32..41,
        ) {
            let at = |k: usize, y: i32| p(k as f64 * 3.0, f64::from(y));
            let left: Vec<Point2> = gates.iter().enumerate().map(|(k, g)| at(k, g.0 + g.1)).collect();
            let right: Vec<Point2> = gates.iter().enumerate().map(|(k, g)| at(k, g.0)).collect();
            let passes = |y: f64, s: f64| {
                left.iter().zip(&right).all(|(l, r)| { let h = y + s * l.x; r.y < h && h < l.y })
            };
            // Portal by portal, as the search does it, and all at once.
            let mut sides = Sides::default();
            let mut step_by_step = None;
            for (&l, &r) in left.iter().zip(&right) {
                sides.left.push(l);
                sides.right.push(r);
                step_by_step = middle_line(&mut sides);
                if step_by_step.is_none() {
                    break;
                }
            }
            let found = middle_line(&mut Sides { left: left.clone(), right: right.clone() });
            prop_assert_eq!(found.is_some(), step_by_step.is_some());
            for line in found.into_iter().chain(step_by_step) {
                prop_assert!(left.iter().all(|&p| side(&line, p) > 0.0) && right.iter().all(|&p| side(&line, p) < 0.0));
            }
            if passes(f64::from(y) / 7.0, f64::from(slope) / 31.0) {
                prop_assert!(found.is_some());
            }
        }
    }
}
