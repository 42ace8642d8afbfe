//! Oracle: which groups (Doom sectors) of a plan see which, in the flat model.
//!
//! Definition: the lines cut the plane into faces. A face belongs to all groups that are named by a
//! side facing it, and group g sees group h if an open set of segments leads from a face of g to a
//! face of h and crosses open lines only.
//!
//! Method: the lines are first cut where they meet, so that they share end points only. Then
//! the module `candidates` gives a line of every kind; all lines of a kind cross the same pieces of
//! lines in the same order. The stretch between two consecutive crossings lies in one face, so the two
//! sides that it leads between face the same face. Joining them (union and find) over all candidates
//! finds the faces completely: around any point, the sides that are seen from it in neighbouring
//! directions have a common partner in the opposite direction (the two switches coincide only for
//! exceptional points), so all sides seen from a point are joined, and a path through the face joins
//! what is seen from its points. The endless outside counts as one side. At last every candidate is
//! walked once more: the groups of all faces between two opaque crossings see each other.
//!
//! Nothing is assumed of the plan. Where sides that face one face name different groups (an unclosed
//! sector), the face belongs to all of them; a group that no line names sees nothing, not even itself.

use crate::candidates::{SMALL, for_each_kind};
use crate::exact::{Form, Hp, Int, Place, crossing, scaled, small};
use crate::sampled::mark;
use crate::sees::proper_crossing;
use sightlines_cells::{Plan, PlanLine};
use sightlines_geometry::Point2;
use std::collections::{BTreeMap, BTreeSet};

/// The table: `[g][h]` tells whether group g sees group h; a row for each group of the plan.
///
/// Exact. Cost O(n^2 (n + lines)) for n distinct line ends and crossings: milliseconds for 30
/// lines that do not cross, on an integer grid of up to 256 steps; some ten times that elsewhere.
pub fn sector_visibility_brute_force(plan: &Plan) -> Vec<Vec<bool>> {
    let points: Vec<Point2> = plan.points().collect();
    let points = scaled(&points);
    // Crossings are fractions, too large for the bounds of `candidates`.
    let quick = small(&points, SMALL).map(|p| Arrangement::new(plan, p)).filter(Arrangement::is_on_the_grid);
    quick.map_or_else(|| Arrangement::new(plan, points).table(plan), |a| a.table(plan))
}

/// A piece of one or more lines between two points where lines meet.
struct Edge<T> {
    ends: [Hp<T>; 2],
    opaque: bool,
    /// Groups named on the left and on the right of first to second end.
    sides: [Vec<u32>; 2],
}

/// Lines cut into edges that share end points only.
struct Arrangement<T> {
    edges: Vec<Edge<T>>,
    given: Vec<Hp<T>>,
}

impl<T: Int> Arrangement<T> {
    /// `points` are the ends of the lines of `plan`.
    fn new(plan: &Plan, points: Vec<[T; 2]>) -> Self {
        let points: Vec<Hp<T>> = points.into_iter().map(Hp::new).collect();
        let lines: Vec<&[Hp<T>]> = points.chunks(2).collect();
        let mut edges: BTreeMap<[Hp<T>; 2], Edge<T>> = BTreeMap::new();
        for (line, ends) in plan.lines().iter().zip(&lines) {
            for pair in cut(ends, &lines).windows(2) {
                add(&mut edges, line, [&pair[0], &pair[1]]);
            }
        }
        let given: BTreeSet<Hp<T>> = edges.keys().flatten().cloned().collect();
        Self { edges: edges.into_values().collect(), given: given.into_iter().collect() }
    }

    fn is_on_the_grid(&self) -> bool {
        self.given.iter().all(|p| p.w.is_one())
    }

    fn table(&self, plan: &Plan) -> Vec<Vec<bool>> {
        let n_groups = plan.n_groups() as usize;
        let mut table = vec![vec![false; n_groups]; n_groups];
        let walks = self.walks();
        let groups = self.groups_of_sides(&walks);
        let outside = 2 * self.edges.len();
        for walk in &walks {
            let mut run = groups[outside].clone();
            for step in walk {
                if self.edges[step.edge].opaque {
                    mark(&run, &mut table);
                    run.clear();
                }
                run.extend(&groups[step.beyond]);
            }
            mark(&run, &mut table);
        }
        table
    }

    /// What every kind of line crosses, in order.
    fn walks(&self) -> Vec<Vec<Step>> {
        let mut walks = Vec::new();
        if self.given.len() > 2 && !self.is_flat() {
            for_each_kind(&self.given, |line| walks.push(self.walk(line)));
        } else if let Some((first, last)) = self.given.first().zip(self.given.last()) {
            walks.extend(self.walks_across(first, last));
        }
        walks
    }

    fn is_flat(&self) -> bool {
        let base = Form::through(&self.given[0], &self.given[1]);
        self.given.iter().all(|p| base.at(p).is_zero())
    }

    /// All lines are collinear: then a line crosses one edge, or none.
    fn walks_across(&self, first: &Hp<T>, last: &Hp<T>) -> Vec<Vec<Step>> {
        let along = Form::through(first, last).along();
        let middle = |e: &Edge<T>| Hp::mean(&e.ends[0], &e.ends[1].w, &e.ends[1], &e.ends[0].w);
        let across = |m: Hp<T>| Form {
            a: along.a.clone() * m.w.clone(),
            b: along.b.clone() * m.w.clone(),
            c: -(along.a.clone() * m.x + along.b.clone() * m.y),
        };
        self.edges.iter().map(|e| self.walk(&across(middle(e)))).collect()
    }

    fn walk(&self, line: &Form<T>) -> Vec<Step> {
        let along = line.along();
        let mut steps: Vec<(Place<T>, Step)> = Vec::new();
        for (edge, e) in self.edges.iter().enumerate() {
            if let Some((place, from_left)) = crossing(line, &along, &e.ends[0], &e.ends[1]) {
                // An edge that starts on the walker's left has its right side towards the walker.
                let (before, beyond) = (2 * edge + usize::from(from_left), 2 * edge + usize::from(!from_left));
                steps.push((place, Step { edge, before, beyond }));
            }
        }
        steps.sort_unstable();
        steps.into_iter().map(|(_, step)| step).collect()
    }

    /// For every side (left of edge e is 2 e, right is 2 e + 1, the outside is last) the groups of the
    /// face that it faces.
    fn groups_of_sides(&self, walks: &[Vec<Step>]) -> Vec<Vec<u32>> {
        let n = 2 * self.edges.len() + 1;
        let mut faces = Faces { parent: (0..n).collect() };
        for walk in walks {
            let last = walk.iter().fold(n - 1, |reached, step| {
                faces.join(reached, step.before);
                step.beyond
            });
            faces.join(last, n - 1);
        }
        let mut groups: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); n];
        for side in 0..n - 1 {
            let face = faces.find(side);
            groups[face].extend(&self.edges[side / 2].sides[side % 2]);
        }
        (0..n).map(|side| groups[faces.find(side)].iter().copied().collect()).collect()
    }
}

/// The places where a line is cut, ends included, in order along it.
fn cut<T: Int>(ends: &[Hp<T>], lines: &[&[Hp<T>]]) -> Vec<Hp<T>> {
    let form = Form::through(&ends[0], &ends[1]);
    let along = form.along();
    let [from, to] = [0, 1].map(|i| Place::of(&along, &ends[i]));
    let mut cuts: Vec<(Place<T>, Hp<T>)> = Vec::new();
    for other in lines {
        let touching = other.iter().filter(|p| form.at(p).is_zero()).cloned();
        let crossing = proper_crossing(&ends[0], &ends[1], &other[0], &other[1]);
        cuts.extend(touching.chain(crossing).map(|p| (Place::of(&along, &p), p)));
    }
    cuts.retain(|(place, _)| from <= *place && *place <= to);
    cuts.sort_unstable();
    cuts.dedup();
    cuts.into_iter().map(|(_, p)| p).collect()
}

/// Adds a piece of a line; pieces of several lines in one place become one edge.
fn add<T: Int>(edges: &mut BTreeMap<[Hp<T>; 2], Edge<T>>, line: &PlanLine, [u, v]: [&Hp<T>; 2]) {
    let forward = u < v;
    let ends = if forward { [u.clone(), v.clone()] } else { [v.clone(), u.clone()] };
    let new = || Edge { ends: ends.clone(), opaque: false, sides: [Vec::new(), Vec::new()] };
    let edge = edges.entry(ends.clone()).or_insert_with(new);
    edge.opaque |= line.opaque;
    let [left, right] = if forward { [0, 1] } else { [1, 0] };
    edge.sides[left].extend(line.left);
    edge.sides[right].extend(line.right);
}

/// One crossing of a walk: the side that is reached and the side that is left behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Step {
    edge: usize,
    before: usize,
    beyond: usize,
}

/// Union and find.
struct Faces {
    parent: Vec<usize>,
}

impl Faces {
    fn find(&mut self, mut side: usize) -> usize {
        while self.parent[side] != side {
            self.parent[side] = self.parent[self.parent[side]];
            side = self.parent[side];
        }
        side
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampled::sampled_sector_visibility;
    use crate::sector_plans::{Sectors, small_sectors};
    use proptest::prelude::*;

    fn line(at: [f64; 4], opaque: bool, left: Option<u32>, right: Option<u32>) -> PlanLine {
        PlanLine { a: Point2::new(at[0], at[1]), b: Point2::new(at[2], at[3]), opaque, left, right }
    }

    /// The boundary of a box, its inside on the left.
    fn ring([x0, y0, x1, y1]: [f64; 4], opaque: bool, inside: u32, outside: Option<u32>) -> Vec<PlanLine> {
        let sides = [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]];
        sides.map(|s| line(s, opaque, Some(inside), outside)).to_vec()
    }

    fn table(lines: Vec<PlanLine>) -> Vec<Vec<bool>> {
        sector_visibility_brute_force(&Plan::new(lines, Vec::new()).unwrap())
    }

    fn pairs(table: &[Vec<bool>]) -> Vec<(usize, usize)> {
        let n = table.len();
        (0..n).flat_map(|g| (g..n).map(move |h| (g, h))).filter(|&(g, h)| table[g][h]).collect()
    }

    #[test]
    fn sectors_hand_made_cases() {
        assert!(table(vec![]).is_empty());
        // A platform (1) in a room (0): the ring of open lines is seen through.
        let mut room = ring([0., 0., 8., 8.], true, 0, None);
        room.extend(ring([3., 3., 5., 5.], false, 1, Some(0)));
        assert_eq!(pairs(&table(room.clone())), [(0, 0), (0, 1), (1, 1)]);
        // Walls around it, and it is hidden; a third room is not seen anywhere.
        room[4..].iter_mut().for_each(|l| l.opaque = true);
        room.extend(ring([20., 0., 21., 1.], true, 2, None));
        assert_eq!(pairs(&table(room)), [(0, 0), (1, 1), (2, 2)]);
    }

    /// Three rooms in a row; the middle one's doors are in line or not.
    #[test]
    fn sectors_doors_in_line_and_not() {
        let row = |low: f64| {
            let mut lines =
                vec![line([0., 0., 9., 0.], true, Some(1), None), line([9., 8., 0., 8.], true, Some(1), None)];
            lines[0] = line([0., 0., 4., 0.], true, Some(0), None);
            lines.push(line([4., 0., 5., 0.], true, Some(1), None));
            lines.push(line([5., 0., 9., 0.], true, Some(2), None));
            lines[1] = line([9., 8., 5., 8.], true, Some(2), None);
            lines.push(line([5., 8., 4., 8.], true, Some(1), None));
            lines.push(line([4., 8., 0., 8.], true, Some(0), None));
            lines.push(line([0., 8., 0., 0.], true, Some(0), None));
            lines.push(line([9., 0., 9., 8.], true, Some(2), None));
            for (x, door, g) in [(4., 1., 0), (5., low, 1)] {
                lines.push(line([x, 0., x, door], true, Some(g), Some(g + 1)));
                lines.push(line([x, door, x, door + 1.], false, Some(g), Some(g + 1)));
                lines.push(line([x, door + 1., x, 8.], true, Some(g), Some(g + 1)));
            }
            table(lines)
        };
        assert!(row(1.)[0][2] && row(2.)[0][2] && row(2.)[2][0]);
        // From a door of height 1 to 2 at x = 4, up to 6 to 7 at x = 5: steep, but open.
        assert!(row(6.)[0][2]);
        assert!(row(1.)[0][1] && row(1.)[1][2]);
    }

    /// Sides that disagree make a face of both groups; lines that touch and cross are cut.
    #[test]
    fn sectors_of_plans_that_are_not_well_formed() {
        let mut lines = ring([0., 0., 8., 8.], true, 0, None);
        lines[2].left = Some(1);
        assert_eq!(pairs(&table(lines.clone())), [(0, 0), (0, 1), (1, 1)]);
        // A wall across that sticks out on both sides cuts the room in two, one group each.
        lines.push(line([-1., 4., 9., 4.], true, None, None));
        lines[1].left = None;
        lines[3].left = None;
        assert_eq!(pairs(&table(lines.clone())), [(0, 0), (1, 1)]);
        // Twice the same wall, one of them open: opaque. With only the open one, they see each other.
        lines.push(line([9., 4., -1., 4.], false, None, None));
        assert_eq!(pairs(&table(lines.clone())), [(0, 0), (1, 1)]);
        lines.remove(4);
        assert_eq!(pairs(&table(lines)), [(0, 0), (0, 1), (1, 1)]);
        // Nothing but one line, and nothing but two collinear ones.
        assert_eq!(pairs(&table(vec![line([0., 0., 3., 1.], true, Some(0), Some(1))])), [(0, 0), (0, 1), (1, 1)]);
        let two = vec![line([0., 0., 3., 0.], true, Some(0), None), line([2., 0., 5., 0.], true, Some(1), None)];
        assert_eq!(pairs(&table(two)), [(0, 0), (0, 1), (1, 1)]);
    }

    proptest! {
        /// Lower bound.
        #[test]
        fn sectors_hold_what_chords_see(sectors in small_sectors(), seed in any::<u64>()) {
            let exact = sector_visibility_brute_force(&sectors.plan());
            for (g, row) in sampled_sector_visibility(&sectors.plan(), seed, 100).iter().enumerate() {
                for h in (0..row.len()).filter(|&h| row[h]) {
                    prop_assert!(exact[g][h], "{} sees {}", g, h);
                }
            }
        }

        /// The other oracle, which knows no faces: sectors see each other exactly if some of their
        /// convex cells do.
        #[test]
        fn sectors_agree_with_their_cells(sectors in small_sectors()) {
            let plan = sectors.plan();
            let exact = sector_visibility_brute_force(&plan);
            for (g, row) in exact.iter().enumerate() {
                for (h, &sees) in row.iter().enumerate().skip(g) {
                    let cells = |s: usize| sectors.cells().filter(move |(sector, _)| *sector as usize == s);
                    let found = cells(g).any(|(_, a)| cells(h).any(|(_, b)| crate::sees_brute_force(&plan, &a, &b)));
                    prop_assert_eq!(sees, found, "{} and {}", g, h);
                }
            }
        }

        #[test]
        fn sectors_table_is_symmetric(sectors in small_sectors()) {
            let table = sector_visibility_brute_force(&sectors.plan());
            for (g, row) in table.iter().enumerate() {
                prop_assert!(row[g]);
                prop_assert!(row.iter().zip(&table).all(|(&sees, other)| sees == other[g]));
            }
        }

        /// Lower bound for plans of any kind: lines that cross, overlap and name groups at random.
        #[test]
        fn sectors_of_any_plan_hold_what_chords_see(
            plan in crate::small_grid_plan(1..6),
            names in prop::collection::vec((any::<bool>(), 0u32..5, 0u32..5), 9),
            seed in any::<u64>(),
        ) {
            let named = |(l, &(opaque, left, right)): (&PlanLine, &(bool, u32, u32))| PlanLine {
                opaque, left: Some(left).filter(|&g| g < 4), right: Some(right).filter(|&g| g < 4), ..*l
            };
            let lines = plan.lines().iter().zip(&names).map(named).collect();
            let plan = Plan::new(lines, Vec::new()).unwrap();
            let exact = sector_visibility_brute_force(&plan);
            for (row, sampled) in exact.iter().zip(sampled_sector_visibility(&plan, seed, 50)) {
                prop_assert!(row.iter().zip(sampled).all(|(&sees, sampled)| sees || !sampled));
            }
        }
    }

    /// The impostors: sight to neighbours only, and sight through every chain of open lines, both
    /// differ from the truth in many cases.
    #[test]
    fn sectors_comparison_can_fail() {
        let mut wrong = [0; 2];
        for sectors in crate::draw(&small_sectors(), 60) {
            let sectors: Sectors = sectors;
            let plan = sectors.plan();
            let truth = sector_visibility_brute_force(&plan);
            let n = truth.len();
            let mut near = vec![vec![false; n]; n];
            (0..n).for_each(|g| near[g][g] = true);
            for l in plan.lines().iter().filter(|l| !l.opaque) {
                mark(&[l.left.unwrap(), l.right.unwrap()], &mut near);
            }
            let mut far = near.clone();
            for k in 0..n {
                let through = far[k].clone();
                for row in far.iter_mut().filter(|row| row[k]) {
                    row.iter_mut().zip(&through).for_each(|(x, &y)| *x |= y);
                }
            }
            wrong[0] += i32::from(near != truth);
            wrong[1] += i32::from(far != truth);
        }
        assert!(wrong.iter().all(|&n| n > 10), "{wrong:?}");
    }
}
