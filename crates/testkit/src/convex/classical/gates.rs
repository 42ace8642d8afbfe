//! The graph as the walk uses it.

use super::clip::{Plane, dot, sub};
use sightlines_cells::{CellGraph, Convex};
use sightlines_geometry::Point3;

/// A portal with the direction in which it is crossed: gate `2 p` leads from the first cell of portal `p` into the
/// second, gate `2 p + 1` back.
#[derive(Debug, Clone)]
pub(super) struct Gate {
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) corners: Vec<Point3>,
    /// In front is where the gate leads.
    pub(super) plane: Plane,
    pub(super) center: Point3,
    /// Of the ball around the center that holds the corners.
    pub(super) radius: f64,
}

/// All gates, and those out of each cell.
#[derive(Debug, Clone)]
pub(super) struct Gates {
    gates: Vec<Gate>,
    exits: Vec<Vec<u32>>,
}

impl Gates {
    pub(super) fn new(graph: &CellGraph<Convex>) -> Self {
        let mut exits = vec![Vec::new(); graph.n_cells()];
        let mut gates = Vec::with_capacity(2 * graph.portals().len());
        for portal in graph.portals() {
            let [a, b] = portal.cells.map(|cell| cell.0);
            for (shape, from, to) in [(portal.shape.clone(), a, b), (portal.shape.reversed(), b, a)] {
                let corners = shape.corners().to_vec();
                let share = 1.0 / corners.len() as f64;
                let center = [0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() * share);
                let plane = Plane::facing(shape.normal(), center).expect("a portal has an area");
                let square = |p: &Point3| dot(sub(*p, center), sub(*p, center));
                let radius = corners.iter().map(square).fold(0.0, f64::max).sqrt();
                exits[from as usize].push(gates.len() as u32);
                gates.push(Gate { from, to, corners, plane, center, radius });
            }
        }
        Self { gates, exits }
    }

    pub(super) fn len(&self) -> usize {
        self.gates.len()
    }

    pub(super) fn n_cells(&self) -> usize {
        self.exits.len()
    }

    #[inline(always)]
    pub(super) fn get(&self, gate: u32) -> &Gate {
        &self.gates[gate as usize]
    }

    /// The gates out of a cell.
    #[inline(always)]
    pub(super) fn exits(&self, cell: u32) -> &[u32] {
        &self.exits[cell as usize]
    }

    /// Whether a line may pass gate `s` and then gate `t`, by their planes.
    fn may_follow(&self, s: u32, t: u32, tolerance: f64) -> bool {
        let (s, t) = (self.get(s), self.get(t));
        let ahead = s.plane.distance(t.center);
        if ahead < tolerance + t.radius {
            let in_front = |p: &Point3| s.plane.distance(*p) > tolerance;
            if ahead < -t.radius || !t.corners.iter().any(in_front) {
                return false;
            }
        }
        let ahead = t.plane.distance(s.center);
        if ahead > -tolerance - s.radius {
            let behind = |p: &Point3| t.plane.distance(*p) < -tolerance;
            if ahead > s.radius || !s.corners.iter().any(behind) {
                return false;
            }
        }
        true
    }

    /// The first bound: cells that are reached from behind a gate through gates that may follow it. Writes a row of
    /// bits, which was empty.
    pub(super) fn bound(&self, gate: u32, tolerance: f64, waiting: &mut Vec<u32>, row: &mut [u64]) {
        waiting.clear();
        waiting.push(self.get(gate).to);
        while let Some(cell) = waiting.pop() {
            row[cell as usize / 64] |= 1 << (cell % 64);
            for &exit in self.exits(cell) {
                let to = self.get(exit).to as usize;
                if row[to / 64] >> (to % 64) & 1 == 0 && self.may_follow(gate, exit, tolerance) {
                    row[to / 64] |= 1 << (to % 64);
                    waiting.push(to as u32);
                }
            }
        }
    }
}
