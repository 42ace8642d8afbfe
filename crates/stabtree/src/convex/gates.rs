//! The graph in the form that the search uses: portals with a direction of crossing.

use super::cut::{Ball, Part, Plane, Vertex};
use super::vector::{Point3, cross, dot, scale, sub, unit};
use sightlines_cells::{CellGraph, Convex, Portal3};
use sightlines_sightline::KnownPortal;

/// A portal with the direction in which it is crossed. Gate `2 p` leads from the first cell of portal `p` into the
/// second, gate `2 p + 1` back.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    pub(super) from: u32,
    pub(super) to: u32,
    first: u32,
    n_corners: u32,
    pub(super) center: Point3,
    /// Radius of the ball around the center that contains the corners, rounded up.
    pub(super) radius: f64,
    /// How far a plane has to be from any corner to be certainly on one side.
    pub(super) clearance: f64,
    /// The direction of crossing, of length 1.
    pub(super) normal: Point3,
    /// Distance of the corners from the plane through the center with this normal.
    uneven: f64,
    /// How far rounding may tilt the normal: sixteen units in the last place of 1, times the ratio of the gate's length
    /// to its width.
    lean: f64,
    /// Tolerance for corners that are meant to lie on the gate's plane: `2^-44` of its largest coordinate.
    ///
    /// Portals of a subdivision lie on its planes, and a line crosses a plane only once. The corners in files are
    /// rounded, each by some units in the last place (2^-53), which planes through nearby corners magnify by the ratio
    /// of portal sizes. So what is nearer than this counts as on the plane.
    flat: f64,
}

/// All gates, and the cells that they lead out of.
#[derive(Debug, Clone)]
pub(crate) struct Gates {
    gates: Vec<Gate>,
    shapes: Vec<KnownPortal>,
    corners: Part,
    first_exit: Vec<u32>,
    exits: Vec<u32>,
    first_next: Vec<u32>,
    next: Vec<u32>,
    /// Bounding boxes of the portals of each cell.
    pub(super) boxes: Vec<[Point3; 2]>,
    /// Largest coordinate, at least the smallest positive one.
    pub(super) largest: f64,
}

impl Gates {
    pub(crate) fn new(graph: &CellGraph<Convex>) -> Self {
        let coordinates = graph.portals().iter().flat_map(|p| p.shape.corners()).flatten();
        let largest = coordinates.fold(f64::MIN_POSITIVE, |m: f64, x| m.max(x.abs()));
        let clearance = super::cut::Cutter::new(largest).eps;
        let (mut gates, mut shapes, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for portal in graph.portals() {
            for (shape, [from, to]) in
                [(portal.shape.clone(), portal.cells), (portal.shape.reversed(), [portal.cells[1], portal.cells[0]])]
            {
                let first = corners.len() as u32;
                corners.extend(shape.corners().iter().map(|&at| Vertex { at, clearance, exact: true, cut: false }));
                let center = super::cut::middle(&corners[first as usize..]);
                let far = |p: &Point3| dot(sub(*p, center), sub(*p, center)).sqrt();
                let radius = shape.corners().iter().map(far).fold(0.0, f64::max) * (1.0 + 1e-9);
                let n_corners = shape.corners().len() as u32;
                let normal = unit(shape.normal());
                let off = |p: &Point3| dot(normal, sub(*p, center)).abs();
                let uneven = shape.corners().iter().map(off).fold(0.0, f64::max);
                let flat = shape.corners().iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs())) * 2f64.powi(-44);
                let twice_area = dot(shape.normal(), shape.normal()).sqrt();
                let lean = 8.0 * f64::EPSILON * (radius * radius / twice_area).max(1.0);
                if uneven > flat {
                    // Such portals overlap where they meet, by as much as they are uneven.
                    for v in &mut corners[first as usize..] {
                        (v.clearance, v.exact) = (clearance + 2.0 * uneven, false);
                    }
                }
                gates.push(Gate {
                    from: from.0,
                    to: to.0,
                    first,
                    n_corners,
                    center,
                    radius,
                    clearance: corners[first as usize].clearance,
                    normal,
                    uneven,
                    lean,
                    flat,
                });
                shapes.push(KnownPortal::new(shape));
            }
        }
        let (mut first_exit, mut exits, mut boxes) = (vec![0u32], Vec::with_capacity(gates.len()), Vec::new());
        for cell in graph.cell_ids() {
            exits.extend(graph.exits(cell).iter().map(|exit| 2 * exit.portal.0 + u32::from(!exit.forward)));
            first_exit.push(exits.len() as u32);
            let bounds = graph.cell(cell).bounds;
            boxes.push([bounds.min, bounds.max]);
        }
        let (first_next, next) = (vec![0], Vec::new());
        let mut made = Self { gates, shapes, corners, first_exit, exits, first_next, next, boxes, largest };
        for gate in 0..made.gates.len() as u32 {
            let exits = made.exits(made.get(gate).to).iter().copied();
            let next: Vec<u32> = exits.filter(|&exit| exit != gate ^ 1 && made.may_follow(gate, exit)).collect();
            made.next.extend(next);
            made.first_next.push(made.next.len() as u32);
        }
        made
    }

    pub(super) fn len(&self) -> usize {
        self.gates.len()
    }

    pub(super) fn n_cells(&self) -> usize {
        self.boxes.len()
    }

    #[inline(always)]
    pub(super) fn get(&self, gate: u32) -> &Gate {
        &self.gates[gate as usize]
    }

    pub(crate) fn shape(&self, gate: u32) -> &Portal3 {
        self.shapes[gate as usize].shape()
    }

    /// The same, as the solver likes it.
    pub(super) fn known(&self, gate: u32) -> &KnownPortal {
        &self.shapes[gate as usize]
    }

    #[inline(always)]
    pub(super) fn corners(&self, gate: u32) -> &[Vertex] {
        let g = self.get(gate);
        &self.corners[g.first as usize..(g.first + g.n_corners) as usize]
    }

    /// The gates out of a cell.
    #[inline(always)]
    pub(super) fn exits(&self, cell: u32) -> &[u32] {
        &self.exits[self.first_exit[cell as usize] as usize..self.first_exit[cell as usize + 1] as usize]
    }

    /// The gates out of the cell behind a gate that [may follow](Self::may_follow) it.
    #[inline(always)]
    pub(super) fn next(&self, gate: u32) -> &[u32] {
        &self.next[self.first_next[gate as usize] as usize..self.first_next[gate as usize + 1] as usize]
    }

    /// Whether a line may pass gate `s` and then gate `t`, judging by their planes: `t` has a corner in front of the
    /// plane of `s`, and `s` one behind the plane of `t`.
    #[inline]
    pub(crate) fn may_follow(&self, s: u32, t: u32) -> bool {
        let (gs, gt) = (self.get(s), self.get(t));
        let between = sub(gt.center, gs.center);
        // A line meets a gate no farther behind its plane than the gate's own corners lie, and rounding tilts the
        // plane.
        let flat = gs.flat.max(gt.flat);
        let reach = || dot(between, between).sqrt() + gs.radius + gt.radius;
        // Balls decide nearly all cases; their margin is far above the error of evaluation.
        let far = between[0].abs() + between[1].abs() + between[2].abs() + gs.radius + gt.radius;
        let margin = self.largest * 1e-9 + gs.uneven.max(gt.uneven) + gs.lean.max(gt.lean) * far;
        let ahead = dot(gs.normal, between);
        if ahead < gt.radius + margin {
            let flat_s = flat - gs.uneven - gs.lean * reach();
            let in_front = |v: &Vertex| dot(gs.normal, sub(v.at, gs.center)) > flat_s;
            if ahead < -gt.radius - margin || !self.corners(t).iter().any(in_front) {
                return false;
            }
        }
        let ahead = dot(gt.normal, between);
        if ahead < gs.radius + margin {
            let flat_t = flat - gt.uneven - gt.lean * reach();
            let behind = |v: &Vertex| dot(gt.normal, sub(v.at, gt.center)) < -flat_t;
            if ahead < -gs.radius - margin || !self.corners(s).iter().any(behind) {
                return false;
            }
        }
        true
    }

    /// Whether the line through `origin` in the direction `d` certainly passes a gate: every edge on its inner
    /// side, by more than rounding.
    ///
    /// The side of an edge is a determinant of three vectors: `d`, of length 1, and the differences of two corners
    /// and the origin, at most `r` long. Two subtractions, two levels of products and a sum of three are off by
    /// less than `16 u r²`; the margin is twice that.
    #[inline]
    pub(super) fn passes(&self, gate: u32, origin: Point3, d: Point3) -> bool {
        let corners = self.corners(gate);
        let mut last = sub(corners[corners.len() - 1].at, origin);
        let (mut farthest, mut least) = (dot(last, last), f64::INFINITY);
        for v in corners {
            let r = sub(v.at, origin);
            farthest = farthest.max(dot(r, r));
            let side = dot(d, cross(last, r));
            // Most gates are passed by, which one edge shows.
            if side <= 0.0 {
                return false;
            }
            least = least.min(side);
            last = r;
        }
        least > farthest * (32.0 * 0.5 * f64::EPSILON)
    }

    /// The points that a line may meet after it has passed a gate, judging by the gate's plane.
    pub(super) fn in_front(&self, gate: u32) -> Plane {
        let gate = self.get(gate);
        Plane { normal: gate.normal, origin: gate.center, offset: self.in_front_by(gate) }
    }

    /// How far behind its plane a line may still meet a gate.
    fn in_front_by(&self, gate: &Gate) -> f64 {
        gate.flat + gate.uneven + gate.lean * 4.0 * self.largest
    }

    /// The points that a line may meet before it passes a gate.
    pub(super) fn behind(&self, gate: u32) -> Plane {
        self.in_front(gate ^ 1)
    }

    /// Appends the gates that the line passes after `gate`, until it meets a wall or comes so close to an edge that
    /// rounding could matter.
    pub(super) fn follow(&self, gate: u32, origin: Point3, d: Point3, passed: &mut Vec<u32>) {
        let (mut last, mut at, most) = (gate, self.crossing(gate, origin, d), passed.len() + self.n_cells());
        'cells: while passed.len() < most {
            for &exit in self.exits(self.get(last).to) {
                // The gate in the opposite direction has the line on the wrong side.
                if exit != last ^ 1 && dot(self.get(exit).normal, d) > 0.0 && self.passes(exit, origin, d) {
                    let next = self.crossing(exit, origin, d);
                    // In a cell that is not convex, the line may have passed it before.
                    if next[1] < at[0] {
                        continue;
                    }
                    passed.push(exit);
                    (last, at) = (exit, next);
                    continue 'cells;
                }
            }
            return;
        }
    }

    /// How far along `d`, of length 1, from `origin` the line meets a gate that it passes: at least and at most, as far as
    /// its corners are off its plane and rounding matters.
    fn crossing(&self, gate: u32, origin: Point3, d: Point3) -> [f64; 2] {
        let gate = self.get(gate);
        let along = dot(gate.normal, d);
        let at = dot(gate.normal, sub(gate.center, origin));
        let off = self.in_front_by(gate) + self.largest * 2f64.powi(-44);
        // A line nearly in the plane may be rounded into it.
        if along > 0.0 { [(at - off) / along, (at + off) / along] } else { [f64::NEG_INFINITY, f64::INFINITY] }
    }

    /// Whether a line that passes all of some gates may meet them one after the other: none certainly before the one ahead
    /// of it. It does in any case if cells are convex.
    pub(super) fn are_in_order(&self, sequence: &[u32], [a, b]: [Point3; 2]) -> bool {
        let d = unit(sub(b, a));
        let crossings: Vec<[f64; 2]> = sequence.iter().map(|&gate| self.crossing(gate, a, d)).collect();
        // What is not a number shows no order.
        !crossings.windows(2).any(|pair| pair[1][1] < pair[0][0])
    }

    /// The gates that the line through `origin` along `d` passes, in order, `gate` among them; empty if it does not
    /// certainly pass that one. Replaces the content of `passed`.
    pub(super) fn chain(&self, gate: u32, origin: Point3, d: Point3, passed: &mut Vec<u32>) {
        passed.clear();
        if !self.passes(gate, origin, d) {
            return;
        }
        self.follow(gate ^ 1, origin, scale(d, -1.0), passed);
        passed.reverse();
        passed.iter_mut().for_each(|g| *g ^= 1);
        passed.push(gate);
        self.follow(gate, origin, d, passed);
    }
}

impl Gate {
    #[inline(always)]
    pub(super) fn ball(&self) -> Ball {
        Ball { center: self.center, radius: self.radius, clearance: self.clearance }
    }
}

/// Answers about gates that are asked for again and again.
#[derive(Debug)]
pub(super) struct Memory {
    /// Twice the round in which a gate's answer was found, and 1 more for yes.
    answers: Vec<u32>,
    round: u32,
}

impl Memory {
    pub(super) fn new(n_gates: usize) -> Self {
        Self { answers: vec![0; n_gates], round: 1 }
    }

    /// Begins with no answers.
    pub(super) fn forget(&mut self) {
        self.round += 1;
        if self.round > u32::MAX / 2 {
            self.answers.fill(0);
            self.round = 1;
        }
    }

    /// The answer for a gate: `find` is called if it is not known.
    #[inline(always)]
    pub(super) fn ask(&mut self, gate: u32, find: impl FnOnce() -> bool) -> bool {
        let answer = &mut self.answers[gate as usize];
        if *answer / 2 != self.round {
            *answer = 2 * self.round + u32::from(find());
        }
        *answer % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_question_is_asked_once_in_a_round() {
        let mut memory = Memory::new(3);
        let asked = Cell::new(0);
        let find = |answer: bool| {
            asked.set(asked.get() + 1);
            answer
        };
        for round in 1..4 {
            for gate in [0, 1, 2, 1, 0] {
                assert_eq!(memory.ask(gate, || find((gate + round) % 2 == 0)), (gate + round) % 2 == 0);
            }
            assert_eq!(asked.get(), 3 * round);
            memory.forget();
        }
        // Rounds begin again without answers of old ones.
        memory.round = u32::MAX / 2;
        assert!(memory.ask(0, || true));
        memory.forget();
        assert!(!memory.ask(0, || false) && memory.round == 1);
    }
}
