//! Chords of axial space: lines in doubles, followed with a bound on their rounding error.

use super::mark;
use crate::zones::Zones;
use sightlines_cells::{Axial, AxialDoor, CellGraph, CellId, Exit};
use sightlines_geometry::Random;
use sightlines_pvs::BitMatrix;

/// A line through `p` in direction `d`; both count as exact.
#[derive(Debug, Clone, Copy)]
struct Chord {
    p: [f64; 3],
    d: [f64; 3],
}

impl Chord {
    fn reversed(self) -> Self {
        Self { d: self.d.map(|x| -x), ..self }
    }

    /// Whether the line certainly passes the door strictly and in its direction.
    ///
    /// On the door's plane the line is at p_b + (X - p_a) d_b / d_a. The difference, the quotient and the product round
    /// by 2^-53 of themselves each, the sum by 2^-53 of the result, together by less than 2^-50 (|p_b| + |product|);
    /// the margin is that much.
    fn passes(&self, door: &AxialDoor) -> bool {
        let a = usize::from(door.axis);
        if self.d[a] == 0.0 || (self.d[a] > 0.0) != door.forward {
            return false;
        }
        (0..3).filter(|&b| b != a).all(|b| {
            let reach = (door.at() - self.p[a]) * (self.d[b] / self.d[a]);
            let margin = 4.0 * f64::EPSILON * (self.p[b].abs() + reach.abs());
            let at = self.p[b] + reach;
            door.extent.min[b] + margin < at && at < door.extent.max[b] - margin
        })
    }
}

/// Shoots `per_exit` chords through each portal between two zones, and returns which zones were seen
/// from which: symmetric, with the diagonal set, a subset of what is visible. Deterministic.
pub fn shoot_axial_chords(graph: &CellGraph<Axial>, zones: &Zones, per_exit: u32) -> BitMatrix {
    let mut seen = BitMatrix::identity(zones.n_zones());
    let mut random = Random::new(0x5167_6874_6C69_6E65);
    let mut path = Vec::new();
    for from in graph.cell_ids() {
        for exit in graph.exits(from) {
            if exit.to < from || zones.of(exit.to) == zones.of(from) {
                continue;
            }
            let door = graph.door(exit);
            for _ in 0..per_exit {
                let chord = random_chord(&door, &mut random);
                if chord.passes(&door) {
                    path.clear();
                    follow(graph, from, exit, chord, |cell| path.extend(zones.of(cell)));
                    mark(&mut seen, &mut path);
                }
            }
        }
    }
    seen
}

/// A line through a random point of the door in a random direction that crosses it.
fn random_chord(door: &AxialDoor, random: &mut Random) -> Chord {
    let mut p = door.extent.min;
    let mut d = [0.0; 3];
    for k in 0..3 {
        p[k] += (door.extent.max[k] - door.extent.min[k]) * random.open_unit();
        d[k] = random.open_unit() - 0.5;
    }
    let a = usize::from(door.axis);
    p[a] = door.at();
    d[a] = if door.forward { d[a].abs() } else { -d[a].abs() };
    Chord { p, d }
}

/// Visits the cells on both sides of `exit` along the line, each side from near to far.
fn follow(graph: &CellGraph<Axial>, from: CellId, exit: &Exit, chord: Chord, mut visit: impl FnMut(CellId)) {
    let mut go = |mut cell: CellId, mut entry_side: u32, chord: Chord| {
        visit(cell);
        // A line crosses each convex cell once.
        for _ in 0..graph.n_cells() {
            let onward = |e: &&Exit| e.side != entry_side && chord.passes(&graph.door(e));
            let Some(next) = graph.exits(cell).iter().find(onward) else { return };
            (cell, entry_side) = (next.to, next.entry_side);
            visit(cell);
        }
    };
    go(exit.to, exit.entry_side, chord);
    go(from, exit.side, chord.reversed());
}
