//! Small dense linear programs in doubles: they propose and decide nothing.
//!
//! A program has `N` unknowns; the last, the margin, is maximised subject to rows `a · y <= c`. Its dual seeks weights with
//! which the rows add up to the margin alone. It is solved by the simplex method, in which the most violated row enters,
//! with an explicit inverse. The weights bound the margin from above at every step, so the method may stop as soon as that
//! bound is low enough.
//!
//! The first `N` rows are the initial basis: row k has only unknown k, with coefficient 1 or -1, and the last one bounds the
//! margin.

use crate::simplex::Basis;

/// Violations below this are rounding.
const VIOLATED: f64 = 1e-12;
/// Weights below this are rounding.
const WEIGHT: f64 = 1e-12;
/// Number of pivots after which the current answer is returned.
const MAX_PIVOTS: usize = 150;

/// Rows, a basis of them, and scratch memory.
#[derive(Debug, Clone)]
pub(super) struct Program<const N: usize> {
    /// Coefficients, unknown by unknown.
    columns: [Vec<f64>; N],
    bounds: Vec<f64>,
    violations: Vec<f64>,
    basis: Basis<usize, N>,
}

impl<const N: usize> Program<N> {
    pub(super) fn new() -> Self {
        Self {
            columns: std::array::from_fn(|_| Vec::new()),
            bounds: Vec::new(),
            violations: Vec::new(),
            basis: Basis { columns: [0; N], inverse: [[0.0; N]; N], weights: [0.0; N] },
        }
    }

    /// Drops all rows but the first `n`.
    pub(super) fn truncate(&mut self, n: usize) {
        self.columns.iter_mut().for_each(|column| column.truncate(n));
        self.bounds.truncate(n);
    }

    pub(super) fn n_rows(&self) -> usize {
        self.bounds.len()
    }

    pub(super) fn push(&mut self, coefficients: [f64; N], bound: f64) {
        for (column, a) in self.columns.iter_mut().zip(coefficients) {
            column.push(a);
        }
        self.bounds.push(bound);
    }

    /// Solves it, or stops when the margin cannot reach `enough`. Returns the unknowns and the number of
    /// pivots; the last unknown bounds the margin from above, up to rounding.
    pub(super) fn solve(&mut self, enough: f64) -> ([f64; N], u64) {
        let mut inverse = [[0.0; N]; N];
        for (i, row) in inverse.iter_mut().enumerate() {
            row[i] = self.columns[i][i];
        }
        let mut weights = [0.0; N];
        weights[N - 1] = 1.0;
        self.basis = Basis { columns: std::array::from_fn(|i| i), inverse, weights };
        let mut pivots = 0;
        let mut y = self.unknowns();
        while pivots < MAX_PIVOTS && y[N - 1] >= enough {
            let Some(entering) = self.most_violated(&y) else { break };
            let row = std::array::from_fn(|i| self.columns[i][entering]);
            if !self.basis.exchange(entering, &row, |_| false) {
                break;
            }
            pivots += 1;
            y = self.unknowns();
        }
        (y, pivots as u64)
    }

    /// The rows with positive weights.
    pub(super) fn support(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.basis.columns.iter().zip(&self.basis.weights).filter(|(_, w)| **w > WEIGHT).map(|(k, w)| (*k, *w))
    }

    fn unknowns(&self) -> [f64; N] {
        let mut y = [0.0; N];
        for (&k, row) in self.basis.columns.iter().zip(&self.basis.inverse) {
            let bound = self.bounds[k];
            for (y, r) in y.iter_mut().zip(row) {
                *y += bound * r;
            }
        }
        y
    }

    fn most_violated(&mut self, y: &[f64; N]) -> Option<usize> {
        self.violations.clear();
        self.violations.extend(self.bounds.iter().map(|c| -c));
        for (column, y) in self.columns.iter().zip(y) {
            for (v, a) in self.violations.iter_mut().zip(column) {
                *v += a * y;
            }
        }
        let mut worst = (VIOLATED, None);
        for (k, &v) in self.violations.iter().enumerate() {
            if v > worst.0 {
                worst = (v, Some(k));
            }
        }
        worst.1.filter(|k| !self.basis.columns.contains(k))
    }
}
