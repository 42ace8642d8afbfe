//! The linear program of one octant, in doubles: it finds candidates and decides nothing.
//!
//! The unknowns are the slownesses `s > 0` and offsets `q` of a line: it reaches coordinate `c` of axis `i` at time
//! `s_i c - q_i`, after every axis was moved and scaled to the interval from 0 to 1 in the octant's direction. The program
//! maximises `margin` such that every row holds with `margin` to spare, `s_i >= margin`, and the slownesses add up to 1.
//! Its dual seeks weights of rows. It is solved by the simplex method, in which the most violated row enters, with an
//! explicit inverse of six by six.
//!
//! Fixing the sum of the slownesses makes proofs easy: if the margin is negative, the weighted rows add up to slownesses
//! with coefficients of at least its magnitude, not just to zero, so weights rounded to integers still prove that no line
//! passes.

use super::rows::{Line, Octant, Row, is_forward};
use crate::simplex::Basis;

/// Unknowns: three slownesses, two offsets (the first is 0), the margin.
pub(super) const N: usize = 6;
/// Bound on offsets, never tight at an optimum: a door keeps them within 2 plus the margin's size.
pub(super) const FAR: f64 = 8.0;
/// Violations below this are rounding.
const VIOLATED: f64 = 1e-12;
/// Weights below this are rounding.
const WEIGHT: f64 = 1e-11;
/// Number of pivots after which the current answer is returned.
const MAX_PIVOTS: usize = 80;
/// Least slowness of the bounded program.
const FLOOR: f64 = 1.0 / 64.0;

/// A column of the dual program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
    /// The sum of the slownesses, an equation; it never leaves the basis.
    Total,
    /// A slowness is at least the margin.
    Sign(usize),
    /// A slowness is at least [`FLOOR`].
    Floor(usize),
    /// The margin is at most 1.
    Cap,
    /// The offset of axis 1 or 2, times a sign, is at most [`FAR`].
    Offset(usize, f64),
    /// A row, by its index.
    Row(usize),
}

/// Coordinates of each axis: where lines of the octant meet the first of them, and what they span in
/// that direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    origin: [f64; 3],
    span: [f64; 3],
}

impl Frame {
    pub(super) fn around(rows: &[Row], octant: Octant) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for row in rows {
            for (axis, x) in [(row.early, row.from), (row.late, row.to)] {
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        let (mut origin, mut span) = ([0.0; 3], [1.0; 3]);
        for axis in (0..3).filter(|&axis| low[axis] <= high[axis]) {
            let size = if high[axis] > low[axis] { high[axis] - low[axis] } else { 1.0 };
            (origin[axis], span[axis]) = if is_forward(octant, axis) { (low[axis], size) } else { (high[axis], -size) };
        }
        Self { origin, span }
    }

    fn unit(&self, axis: usize, x: f64) -> f64 {
        (x - self.origin[axis]) / self.span[axis]
    }

    fn place(&self, axis: usize, u: f64) -> f64 {
        self.origin[axis] + self.span[axis] * u
    }

    /// A row in coordinates of the unit box.
    pub(super) fn scaled(&self, row: &Row) -> Row {
        Row { from: self.unit(row.early, row.from), to: self.unit(row.late, row.to), ..*row }
    }

    /// For the line of the unknowns: its place on each axis at time 0, and the time that a scene unit takes there.
    /// Slownesses that vanish are made small.
    pub(super) fn starts_and_paces(&self, y: &[f64; N]) -> [[f64; 3]; 2] {
        let (q, slow) = ([0.0, y[3], y[4]], [y[0], y[1], y[2]].map(|s| s.max(VIOLATED)));
        [[0, 1, 2].map(|i| self.place(i, q[i] / slow[i])), [0, 1, 2].map(|i| slow[i] / self.span[i])]
    }
}

/// What the program found.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// A line with a positive margin, if there seems to be one.
    pub(super) line: Option<Line>,
    /// The rows with positive weights: index and weight. At most five.
    pub(super) support: Vec<(usize, f64)>,
    /// The axes whose slowness has a positive weight.
    pub(super) signs: [bool; 3],
}

/// The state of the simplex method. A copy can be continued with more rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tableau {
    basis: Basis<Column, N>,
    /// Whether slownesses are bounded by [`FLOOR`], not by the margin.
    bounded: bool,
}

impl Tableau {
    /// The basis without rows: slownesses of the axes in `total` equal, offsets at their bounds.
    pub(super) fn new(total: [bool; 3]) -> Self {
        use Column::{Offset, Sign, Total};
        let share = 1.0 / total.iter().map(|&t| f64::from(u8::from(t))).sum::<f64>();
        let mean = [share, share, share, 0.0, 0.0, share];
        let mut inverse = [[0.0; N]; N];
        let mut weights = [0.0; N];
        for i in 0..3 {
            if total[i] {
                (inverse[i], weights[i]) = (mean, share);
            }
            inverse[i][i] -= 1.0;
        }
        (inverse[3], weights[3]) = (mean, share);
        inverse[4][3] = 1.0;
        inverse[5][4] = 1.0;
        let columns = [Sign(0), Sign(1), Sign(2), Total, Offset(1, 1.0), Offset(2, 1.0)];
        Self { basis: Basis { columns, inverse, weights }, bounded: false }
    }

    /// The same for the bounded program, in which no slowness is less than [`FLOOR`].
    ///
    /// In the other program the slownesses of two axes can vanish, so its margin is zero and its weights have no slack where
    /// rows about these two axes block all lines. This one finds proofs with slack there, and lines that are not steep. If it
    /// finds none, that proves nothing.
    pub(super) fn bounded() -> Self {
        use Column::{Cap, Floor, Offset, Total};
        let mut inverse = [[0.0; N]; N];
        for (i, row) in inverse.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        for (k, row) in [(1, 1), (2, 2)] {
            (inverse[row][0], inverse[row][k]) = (1.0, -1.0);
        }
        let weights = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let columns = [Total, Floor(1), Floor(2), Offset(1, 1.0), Offset(2, 1.0), Cap];
        Self { basis: Basis { columns, inverse, weights }, bounded: true }
    }

    /// The columns of the basis.
    pub(super) fn columns(&self) -> [Column; N] {
        self.basis.columns
    }

    /// The unknowns of the primal program.
    fn unknowns(&self) -> [f64; N] {
        let mut y = [0.0; N];
        for (column, row) in self.basis.columns.iter().zip(&self.basis.inverse) {
            let cost = match column {
                Column::Total | Column::Cap => 1.0,
                Column::Offset(..) => FAR,
                Column::Floor(_) => -FLOOR,
                Column::Sign(_) | Column::Row(_) => continue,
            };
            for (y, r) in y.iter_mut().zip(row) {
                *y += cost * r;
            }
        }
        y
    }

    /// Continues to an optimum for `rows`, which begin with the rows of earlier calls. Returns the unknowns: slownesses, two
    /// offsets, the margin.
    pub(super) fn improve(&mut self, rows: &[Row]) -> [f64; N] {
        let mut y = self.unknowns();
        for _ in 0..MAX_PIVOTS {
            let Some(entering) = most_violated(&y, rows, self.bounded) else { break };
            if !self.basis.exchange(entering, &coefficients(entering, rows), |column| column == Column::Total) {
                break;
            }
            y = self.unknowns();
        }
        y
    }

    /// The rows with positive weights.
    pub(super) fn support(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.basis.columns.iter().zip(&self.basis.weights).filter_map(|(column, &weight)| match column {
            Column::Row(k) if weight > WEIGHT => Some((*k, weight)),
            _ => None,
        })
    }
}

/// Solves the program for `rows`, of which there is at least one door's. The slownesses of the axes in
/// `total` add up to 1; rows must be about those axes, or about one coordinate of the others.
///
/// Cost: a few pivots, each a pass over the rows.
pub(super) fn solve(rows: &[Row], octant: Octant, total: [bool; 3], scratch: &mut Vec<Row>) -> Solution {
    let frame = Frame::around(rows, octant);
    scratch.clear();
    scratch.extend(rows.iter().map(|r| frame.scaled(r)));
    let mut tableau = Tableau::new(total);
    let y = tableau.improve(scratch);
    let Basis { columns, weights, .. } = &tableau.basis;
    let positive = |column: Column| columns.iter().zip(weights).any(|(c, w)| *c == column && *w > WEIGHT);
    Solution {
        line: line(&frame, &y, scratch),
        support: tableau.support().collect(),
        signs: [0, 1, 2].map(|i| positive(Column::Sign(i))),
    }
}

fn value(y: &[f64; N], row: &Row) -> f64 {
    let q = [0.0, y[3], y[4]];
    (y[row.early] * row.from - q[row.early]) - (y[row.late] * row.to - q[row.late]) + y[5]
}

fn most_violated(y: &[f64; N], rows: &[Row], bounded: bool) -> Option<Column> {
    let mut worst = (VIOLATED, None);
    let mut offer = |violation: f64, column: Column| {
        if violation > worst.0 {
            worst = (violation, Some(column));
        }
    };
    for i in 0..3 {
        if bounded {
            offer(FLOOR - y[i], Column::Floor(i));
        } else {
            offer(y[5] - y[i], Column::Sign(i));
        }
    }
    for axis in [1, 2] {
        offer(y[axis + 2] - FAR, Column::Offset(axis, 1.0));
        offer(-y[axis + 2] - FAR, Column::Offset(axis, -1.0));
    }
    for (k, row) in rows.iter().enumerate() {
        offer(value(y, row), Column::Row(k));
    }
    worst.1
}

fn coefficients(column: Column, rows: &[Row]) -> [f64; N] {
    let mut a = [0.0; N];
    match column {
        // It is in the basis from the beginning and never leaves.
        Column::Total => {}
        Column::Sign(i) => (a[i], a[5]) = (-1.0, 1.0),
        Column::Floor(i) => a[i] = -1.0,
        Column::Cap => a[5] = 1.0,
        Column::Offset(axis, sign) => a[axis + 2] = sign,
        Column::Row(k) => {
            let row = &rows[k];
            a[row.early] += row.from;
            a[row.late] -= row.to;
            if row.early > 0 {
                a[row.early + 2] -= 1.0;
            }
            if row.late > 0 {
                a[row.late + 2] += 1.0;
            }
            a[5] = 1.0;
        }
    }
    a
}

/// The line of the unknowns, by its places at the first and the last time that occurs in rows.
fn line(frame: &Frame, y: &[f64; N], rows: &[Row]) -> Option<Line> {
    if y[5] <= 0.0 {
        return None;
    }
    let q = [0.0, y[3], y[4]];
    let time = |axis: usize, u: f64| y[axis] * u - q[axis];
    let first = rows.iter().map(|r| time(r.late, r.to)).fold(f64::INFINITY, f64::min);
    let last = rows.iter().map(|r| time(r.early, r.from)).fold(f64::NEG_INFINITY, f64::max);
    let last = if last - first > 1e-3 { last } else { first + 1.0 };
    let at = |t: f64| [0, 1, 2].map(|i| frame.place(i, (t + q[i]) / y[i]));
    Line::new(at(first), at(last))
}
