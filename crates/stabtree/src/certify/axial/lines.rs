//! Lines for pairs of cells that see each other.

use super::super::Steps;
use super::Search;
use sightlines_cells::{Axial, CellGraph};
use sightlines_certificates::axial::{AxialLine, AxialMaker, AxialNetwork, AxialProofs};
use sightlines_geometry::{Aabb, Random, check_coordinate};
use sightlines_sightline::{BoxTarget, Shaft, ShaftLine, Verdict};

/// Linear programs spent on a line between two cells. A pair that takes more is left open, which hides nothing; most
/// such pairs are only assumed visible.
pub(super) const BUDGET: u64 = 100;

/// Number of nearby lines that are tried where a line touches an edge of a portal.
const MOST_TRIED: u32 = 24;

/// What places beside a line are drawn from.
const SEED: u64 = 0x7072_6F6F_6673_0003;

/// Numbers that are drawn for a line that is tried.
const DRAWN: u64 = 6;

/// A coordinate, rounded to four bytes if it fits.
fn short(x: f64) -> f64 {
    check_coordinate(f64::from(x as f32)).unwrap_or(x)
}

/// A coordinate in the range that proofs accept; tiny ones become zero.
fn valid(x: f64) -> f64 {
    check_coordinate(x).unwrap_or(0.0)
}

/// A line that is shot: a cell beside the portal that it goes through, and two points of it.
pub(super) struct Shot {
    cell: u32,
    points: [[f64; 3]; 2],
}

/// Lines through random points of portals.
pub(super) fn shots(graph: &CellGraph<Axial>, per_portal: u32) -> Vec<Shot> {
    let mut random = Random::new(0x7072_6F6F_6673_0002);
    let all = Aabb::<3>::around(graph.cells().iter().flat_map(|c| [c.bounds.min, c.bounds.max]));
    let mut shots = Vec::new();
    for portal in graph.portals() {
        let extent = &portal.shape.extent;
        for k in 0..per_portal {
            let p = [0, 1, 2].map(|k| extent.min[k] + (extent.max[k] - extent.min[k]) * random.open_unit());
            // Rooms are wide and low: half of the lines are nearly level.
            let step = [0, 1, 2].map(|axis| {
                let size = all.max[axis] - all.min[axis];
                (random.open_unit() - 0.5) * size * if k.is_multiple_of(2) { 1.0 } else { 1.5 - 0.7 * axis as f64 }
            });
            let q = [0, 1, 2].map(|k| p[k] + step[k]);
            shots.push(Shot { cell: portal.cells[0].0, points: [p, q] });
        }
    }
    shots
}

/// A line in four bytes per coordinate, and in eight.
fn forms(cell: u32, [p, q]: [[f64; 3]; 2]) -> [AxialLine; 2] {
    [AxialLine::through(cell, p.map(short), q.map(short)), AxialLine::through(cell, p.map(valid), q.map(valid))]
}

/// Lines that are shot, then those that are sought from each cell.
pub(super) struct LineSteps<'a, 's> {
    search: &'s Search<'a>,
    shots: &'s [Shot],
    maker: AxialMaker<'s>,
    shaft: Shaft<'a>,
    random: Random,
    /// Numbers that were drawn from it.
    n_drawn: u64,
}

impl<'a, 's> LineSteps<'a, 's> {
    pub(super) fn new(search: &'s Search<'a>, shots: &'s [Shot], network: &'s AxialNetwork) -> Self {
        let (maker, shaft) = (AxialMaker::new(network, &[]), Shaft::new(search.blockers));
        Self { search, shots, maker, shaft, random: Random::new(SEED), n_drawn: 0 }
    }

    pub(super) fn finish(self) -> AxialProofs {
        self.maker.finish()
    }

    /// Finds a line between two cells, given by their positions, if they have none yet.
    fn seek_pair(&mut self, places: [usize; 2]) {
        let cells = places.map(|place| self.search.cell_at[place]);
        if self.maker.visible().has(cells[0], cells[1]) {
            return;
        }
        let [a, b] = cells.map(|cell| self.search.graph.cells()[cell as usize].bounds);
        let apart = (0..3).any(|k| a.max[k] <= b.min[k] || b.max[k] <= a.min[k]);
        if !apart {
            return;
        }
        let found = self.shaft.decide(&a, &b, BoxTarget::Inside, self.search.budgets[1]);
        let Verdict::Visible(ShaftLine::Free(line)) = found else { return };
        let [p, q] = line.points();
        // A free line may pass the common edge of two portals; lines next to it do not.
        let mut width = 0.25;
        for k in 0..=MOST_TRIED {
            let mut beside = |p: [f64; 3], b: &Aabb<3>| {
                [0, 1, 2].map(|i| {
                    let to = b.min[i] + (b.max[i] - b.min[i]) * self.random.open_unit();
                    if k == 0 { p[i] } else { p[i] + (to - p[i]) * width }
                })
            };
            let points = [beside(p, &a), beside(q, &b)];
            self.n_drawn += DRAWN;
            let _ = forms(cells[0], points).into_iter().any(|line| self.maker.take_line(line, 1));
            if self.maker.visible().has(cells[0], cells[1]) {
                return;
            }
            width *= 0.5;
        }
    }
}

impl Steps for LineSteps<'_, '_> {
    const ROUNDS: [usize; 3] = [64, 8, 1];
    const COSTS: [f64; 3] = [0.02, 1.0, 1.0];
    type Line = AxialLine;

    fn shot(&self, shot: usize) -> [AxialLine; 2] {
        let Shot { cell, points } = self.shots[shot];
        forms(cell, points)
    }

    fn take_line(&mut self, line: AxialLine, at_least: usize) -> bool {
        self.maker.take_line(line, at_least)
    }

    fn seek(&mut self, step: usize) {
        let search = self.search;
        search.sees.ones(step).filter(|&b| b > step).for_each(|b| self.seek_pair([step, b]));
    }

    fn begin_walks(&mut self) {}

    fn walk(&mut self, _: usize) {}

    fn spent(&self) -> u64 {
        self.n_drawn
    }

    /// Draws as many numbers again.
    fn spend(&mut self, spent: u64, n_steps: usize) -> bool {
        let most = DRAWN * u64::from(MOST_TRIED + 1) * self.search.cell_at.len() as u64 * n_steps as u64;
        if spent > most {
            return false;
        }
        for _ in 0..spent {
            self.random.bits();
        }
        self.n_drawn += spent;
        true
    }

    fn n_taken(&self) -> [usize; 2] {
        [self.maker.n_lines(), 0]
    }

    fn taken_since(&self, [n_lines, _]: [usize; 2]) -> Vec<u8> {
        self.maker.lines_since(n_lines)
    }

    fn take_again(&mut self, bytes: &[u8]) -> bool {
        self.maker.take_lines_again(bytes)
    }
}
