//! A line found by turns: with its first point given, the best second point is a linear program, and the other way
//! round.

use super::rows::Edge;
use super::simplex::Program;

/// Gain of the margin, relative to its size, below which there is no progress.
const PROGRESS: f64 = 0.02;

/// The line so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    /// Coordinates of both points.
    pub(super) at: [f64; 4],
    /// The least of all rows; positive for a line that seems to pass.
    pub(super) margin: f64,
}

/// Moves the points in turn, at most `rounds` times, until `accept` accepts a line with a positive margin or there is
/// no progress. Returns whether one was accepted, and counts programs and pivots.
pub(super) fn alternate(
    edges: &[Edge],
    start: [f64; 2],
    rounds: u32,
    program: &mut Program<3>,
    counts: &mut [u64; 2],
    mut accept: impl FnMut(&Turn) -> bool,
) -> bool {
    let mut turn = Turn { at: [start[0], start[1], 0.5, 0.5], margin: f64::NEG_INFINITY };
    for round in 0..rounds {
        let second = round % 2 == 0;
        let before = turn.margin;
        program.truncate(0);
        for i in 0..3 {
            let bound = if i < 2 { 0.0 } else { 1.0 };
            let sign = if i < 2 { -1.0 } else { 1.0 };
            program.push(std::array::from_fn(|k| if i == k { sign } else { 0.0 }), bound);
        }
        program.push([1.0, 0.0, 0.0], 1.0);
        program.push([0.0, 1.0, 0.0], 1.0);
        let [u, v, s, t] = turn.at;
        for Edge { row: c, .. } in edges {
            let (fixed, x, y) = if second {
                (c[0] + c[1] * u + c[2] * v, c[3] + c[5] * u + c[7] * v, c[4] + c[6] * u + c[8] * v)
            } else {
                (c[0] + c[3] * s + c[4] * t, c[1] + c[5] * s + c[6] * t, c[2] + c[7] * s + c[8] * t)
            };
            program.push([-x, -y, 1.0], fixed);
        }
        let (best, pivots) = program.solve(f64::NEG_INFINITY);
        counts[0] += 1;
        counts[1] += pivots;
        let [x, y, margin] = best;
        turn.margin = margin;
        turn.at = if second { [u, v, x, y] } else { [x, y, s, t] };
        if margin > 0.0 && accept(&turn) {
            return true;
        }
        if round > 0 && margin - before <= PROGRESS * margin.abs() {
            return false;
        }
    }
    false
}
