//! Lines through narrow sequences of portals.
//!
//! Random lines through the first and the last portal seldom pass what is between. So it is looked along sequences of portals
//! through cells that the table lets both ends see, with a line that is kept clear of the edges of all of them: it is moved at random, by steps that
//! grow while they help and shrink when they do not, towards more room on its narrowest side.

use super::{Gate, PortalWorld};
use crate::exact::snapped;
use crate::oracle::{RayOracle, at, dot, length, sub};
use crate::sight::{SightSegment, Target};
use sightlines_geometry::{Point3, Random};
use sightlines_pvs::{CellId, Table};

/// Longer sequences are not looked along.
const LONGEST: usize = 64;
/// Moves of a line for each portal that is added.
const MOVES: u32 = 120;

struct Search<'a> {
    world: &'a PortalWorld,
    table: &'a Table,
    from: u32,
    to: u32,
    budget: u32,
    random: Random,
    cells: Vec<u32>,
    gates: Vec<&'a Gate>,
    /// The middle of the gates into the last cell, to begin with what is nearer to it.
    goal: Point3,
}

impl PortalWorld {
    /// Looks for a sight through sequences of portals, with up to two steps for each try.
    pub(super) fn through_sequences(
        &self,
        table: &Table,
        from: u32,
        to: u32,
        tries: u32,
        random: &mut Random,
    ) -> Option<SightSegment> {
        let goals: Vec<Point3> = self.gates[to as usize].iter().map(|g| g.middle).collect();
        let goal = if goals.is_empty() { return None } else { crate::shapes::middle(&goals) };
        let mut search = Search {
            world: self,
            table,
            from,
            to,
            budget: tries.saturating_mul(2),
            random: Random::new(random.bits()),
            cells: vec![from],
            gates: Vec::new(),
            goal,
        };
        search.go_on_from(from, None)
    }
}

impl Search<'_> {
    fn go_on_from(&mut self, cell: u32, line: Option<[Point3; 2]>) -> Option<SightSegment> {
        let world = self.world;
        let both =
            |c: u32| self.table.sees(CellId(self.from), CellId(c)) && self.table.sees(CellId(self.to), CellId(c));
        let mut ways: Vec<&Gate> =
            world.gates[cell as usize].iter().filter(|g| g.to == self.to || both(g.to)).collect();
        let far = |g: &Gate| if g.to == self.to { -1.0 } else { length(sub(g.middle, self.goal)) };
        ways.sort_by(|g, h| far(g).total_cmp(&far(h)));
        for gate in ways {
            if self.budget == 0 || self.gates.len() >= LONGEST {
                return None;
            }
            if self.cells.contains(&gate.to) {
                continue;
            }
            self.budget -= 1;
            self.gates.push(gate);
            self.cells.push(gate.to);
            if let Some(line) = self.clear_line(line) {
                let found = if gate.to == self.to { self.sight(line) } else { self.go_on_from(gate.to, Some(line)) };
                if found.is_some() {
                    return found;
                }
            }
            self.gates.pop();
            self.cells.pop();
        }
        None
    }

    fn sight(&self, [a, b]: [Point3; 2]) -> Option<SightSegment> {
        // From before the first gate to behind the last.
        let d = sub(b, a);
        let at_gate = |g: &Gate| dot(g.normal, sub(g.middle, a)) / dot(g.normal, d);
        let (first, last) = (at_gate(self.gates.first()?), at_gate(self.gates.last()?));
        let beside = 1.0 / length(d);
        let segment = [at(a, d, first - beside), at(a, d, last + beside)].map(snapped);
        let sight = SightSegment { from: CellId(self.from), target: Target::Cell(CellId(self.to)), segment };
        self.world.proves(&sight).then_some(sight)
    }

    /// A line that passes all gates, clear of their edges.
    fn clear_line(&mut self, before: Option<[Point3; 2]>) -> Option<[Point3; 2]> {
        let (first, last) = (*self.gates.first()?, *self.gates.last()?);
        let starts = [
            before,
            (self.gates.len() > 1).then_some([first.middle, last.middle]),
            Some([last.middle, at(last.middle, last.normal, last.size)]),
        ];
        let room = |l: &[Point3; 2]| self.world.room(&self.gates, l);
        let starts = starts.into_iter().flatten().filter(|l| l[0] != l[1]);
        let mut best = starts.map(|l| (room(&l), l)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut step = last.size.max(first.size);
        for _ in 0..MOVES {
            if best.0 > 0.0 && best.0 > 0.05 * last.size {
                break;
            }
            let mut next = best.1;
            let which = self.random.below(3);
            for end in [0, 1].into_iter().filter(|&end| which != end) {
                next[end] = at(next[end], self.random.direction(), step * self.random.unit());
            }
            let found = room(&next);
            if found > best.0 {
                best = (found, next);
                step *= 1.6;
            } else {
                step *= 0.88;
            }
        }
        (best.0 > 0.0).then_some(best.1)
    }
}

impl PortalWorld {
    /// How far a line is from the nearest edge of some gates, less what they are uneven by; negative outside of one.
    fn room(&self, gates: &[&Gate], [a, b]: &[Point3; 2]) -> f64 {
        let d = sub(*b, *a);
        let n = length(d);
        let mut least = f64::INFINITY;
        for gate in gates {
            let along = dot(gate.normal, d);
            if along <= 0.0 {
                // How much it would have to turn.
                least = least.min(-self.size * (1.0 - along / n));
                continue;
            }
            let q = at(*a, d, dot(gate.normal, sub(gate.middle, *a)) / along);
            let margin = self.margin * n / along;
            let inside = gate.edges.iter().map(|(p, inwards)| dot(*inwards, sub(q, *p))).fold(f64::INFINITY, f64::min);
            least = least.min((inside - margin).max(-self.size));
        }
        if least.is_nan() { f64::NEG_INFINITY } else { least }
    }
}
