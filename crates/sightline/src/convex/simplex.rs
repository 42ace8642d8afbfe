//! Small dense linear programs in doubles: they propose and decide nothing.
//!
//! Wanted are `N` unknowns, the last of which, the margin, is as large as rows `a · y <= c` allow. The
//! dual asks for weights of rows that add up to the margin alone; it is solved by the simplex method with
//! the most violated row entering, on an explicit inverse. On the way the weights always bound the margin
//! from above, so that the method may stop as soon as that bound is low enough.
//!
//! The first `N` rows are the basis to start from: the k-th speaks of unknown k alone, with 1 or -1, and
//! the last one bounds the margin.

/// Violations below this are rounding.
const VIOLATED: f64 = 1e-12;
/// Columns of smaller size are no pivots.
const PIVOT: f64 = 1e-11;
/// Weights below this are rounding.
const WEIGHT: f64 = 1e-12;
/// Pivots after which the answer is taken as it is.
const MAX_PIVOTS: usize = 150;

/// Rows, a basis of them, and scratch memory.
#[derive(Debug, Clone)]
pub(super) struct Program<const N: usize> {
    /// Coefficients, unknown by unknown.
    columns: [Vec<f64>; N],
    bounds: Vec<f64>,
    violations: Vec<f64>,
    basis: [usize; N],
    inverse: [[f64; N]; N],
    weights: [f64; N],
}

impl<const N: usize> Program<N> {
    pub(super) fn new() -> Self {
        Self {
            columns: std::array::from_fn(|_| Vec::new()),
            bounds: Vec::new(),
            violations: Vec::new(),
            basis: [0; N],
            inverse: [[0.0; N]; N],
            weights: [0.0; N],
        }
    }

    pub(super) fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.bounds.clear();
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
        self.inverse = [[0.0; N]; N];
        for i in 0..N {
            self.basis[i] = i;
            self.inverse[i][i] = self.columns[i][i];
        }
        self.weights = [0.0; N];
        self.weights[N - 1] = 1.0;
        let mut pivots = 0;
        let mut y = self.unknowns();
        while pivots < MAX_PIVOTS && y[N - 1] >= enough {
            let Some(entering) = self.most_violated(&y) else { break };
            if !self.pivot(entering) {
                break;
            }
            pivots += 1;
            y = self.unknowns();
        }
        (y, pivots as u64)
    }

    /// The rows with positive weights.
    pub(super) fn support(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.basis.iter().zip(&self.weights).filter(|(_, w)| **w > WEIGHT).map(|(k, w)| (*k, *w))
    }

    fn unknowns(&self) -> [f64; N] {
        let mut y = [0.0; N];
        for (&k, row) in self.basis.iter().zip(&self.inverse) {
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
        worst.1.filter(|k| !self.basis.contains(k))
    }

    /// Exchanges a row of the basis for `entering`; false if none can leave.
    fn pivot(&mut self, entering: usize) -> bool {
        let row: [f64; N] = std::array::from_fn(|i| self.columns[i][entering]);
        let image: [f64; N] = std::array::from_fn(|i| self.inverse[i].iter().zip(&row).map(|(r, a)| r * a).sum());
        let mut leaving: Option<(usize, f64)> = None;
        for i in 0..N {
            if image[i] <= PIVOT {
                continue;
            }
            let ratio = self.weights[i] / image[i];
            let better = leaving.is_none_or(|(k, best)| ratio < best || (ratio == best && image[i] > image[k]));
            if better {
                leaving = Some((i, ratio));
            }
        }
        let Some((out, ratio)) = leaving else { return false };
        let scaled = self.inverse[out].map(|r| r / image[out]);
        for (i, factor) in image.into_iter().enumerate().filter(|&(i, _)| i != out) {
            self.weights[i] = (self.weights[i] - ratio * factor).max(0.0);
            for (r, s) in self.inverse[i].iter_mut().zip(&scaled) {
                *r -= factor * s;
            }
        }
        (self.inverse[out], self.weights[out], self.basis[out]) = (scaled, ratio, entering);
        true
    }
}
