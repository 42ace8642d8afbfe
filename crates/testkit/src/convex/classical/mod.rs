//! How the vis programs of Quake maps do it: planes between portals, along every sequence of portals.
//!
//! A reference to measure against, written from descriptions of the method. What it has of the programs of today:
//! the first bound by planes of portals; gates (portals with a direction) in the order of how much the bound leaves
//! them; the depth-first walk with source and target both cut by the planes between them, both ways; the sets of
//! finished gates in place of bounds; no step where nothing new can be seen; and bounds of gates not begun yet that
//! shrink with what finished ones do not see. Bits in words, planes of a step kept for all gates of a cell, and no
//! memory asked for once the walk has been as deep as it goes.
//!
//! What it has not: threads, a distance limit, and tests of far targets against the walk's state, which save a fifth
//! on open maps and cost as much or more on others. Sums are in doubles, and nothing is exact: with the tolerance of
//! the programs what is thinner is not seen; with a small one, still above rounding, that is gone, and time and
//! tightness stay. Without any, rounding decides on which side the corners of flat things are, and much is not seen
//! that is in full view. So this is no oracle.
//!
//! Source: Abrash, Graphics Programming Black Book, 1997, chapter 70, and descriptions of programs that followed.
//! The words are ours, and so are the heap of gates that wait, and planes tested only for gates that are reached.

mod clip;
mod flow;
mod gates;
#[cfg(test)]
mod tests;

use gates::Gates;
use sightlines_cells::{CellGraph, Convex};

/// How far the method goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClassicalLevel {
    /// Only the first bound.
    Base,
    /// The walk. A may see B and B not A: sequences are cut differently from their two ends.
    Separators,
    /// The walk, and of its pairs only those that see each other both ways.
    Symmetric,
}

/// How to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClassicalOptions {
    /// How far to go.
    pub level: ClassicalLevel,
    /// What is nearer to a plane than this counts as on it, in scene units. The programs have 0.1; it should be
    /// above the rounding errors of coordinates.
    pub tolerance: f64,
}

impl Default for ClassicalOptions {
    fn default() -> Self {
        Self { level: ClassicalLevel::Separators, tolerance: 0.1 }
    }
}

/// What the method says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClassicalSeen {
    /// For each cell the cells that it sees, itself among them: bit `j % 64` of word `j / 64`.
    pub rows: Vec<Vec<u64>>,
    /// Gates: portals, each with its two directions.
    pub n_gates: usize,
    /// Gates that are done: all of them unless the walk was stopped. For others their bound stands.
    pub n_finished: usize,
    /// Steps of the walk, from a gate to the next.
    pub steps: u64,
    /// Polygons tested against planes.
    pub clips: u64,
}

impl ClassicalSeen {
    /// Whether `a` sees `b`.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn sees(&self, a: usize, b: usize) -> bool {
        self.rows[a][b / 64] >> (b % 64) & 1 == 1
    }

    /// Takes out pairs that do not see each other both ways: a line can be followed from either end, so what one end
    /// does not see is not there. O(cells²).
    #[must_use]
    pub fn symmetric(&self) -> Self {
        let mut rows = self.rows.clone();
        for (a, row) in rows.iter_mut().enumerate() {
            for (k, word) in row.iter_mut().enumerate() {
                let mut left = *word;
                while left != 0 {
                    let b = 64 * k + left.trailing_zeros() as usize;
                    if !self.sees(b, a) {
                        *word &= !(1 << (b % 64));
                    }
                    left &= left - 1;
                }
            }
        }
        Self { rows, ..self.clone() }
    }
}

/// Visibility by the classical method, on one thread. `stop` is called now and then and returns whether to give up;
/// unfinished portals keep their first bound. Exponential in bad cases.
pub fn classical(
    graph: &CellGraph<Convex>,
    options: ClassicalOptions,
    mut stop: impl FnMut() -> bool,
) -> ClassicalSeen {
    let gates = Gates::new(graph);
    let mut walk = flow::Walk::new(&gates, options.tolerance);
    if options.level != ClassicalLevel::Base {
        walk.run(&mut stop);
    }
    let n_cells = graph.n_cells();
    let mut rows = vec![vec![0u64; n_cells.div_ceil(64)]; n_cells];
    for (cell, row) in rows.iter_mut().enumerate() {
        row[cell / 64] |= 1 << (cell % 64);
        for &gate in gates.exits(cell as u32) {
            row.iter_mut().zip(walk.seen_through(gate)).for_each(|(row, seen)| *row |= seen);
        }
    }
    let n_finished = if options.level == ClassicalLevel::Base { gates.len() } else { walk.n_finished };
    let seen = ClassicalSeen { rows, n_gates: gates.len(), n_finished, steps: walk.steps, clips: walk.clipper.clips };
    if options.level == ClassicalLevel::Symmetric { seen.symmetric() } else { seen }
}
