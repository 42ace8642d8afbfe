//! The linear program of one octant in exact fractions: slow, but it always decides.
//!
//! Seeks non-negative weights that add up to 1 and with which the rows (and the signs of the slownesses) add up to
//! zero. The first phase of the simplex method minimises the residual. If the residual vanishes, the weights are a
//! proof; otherwise the multipliers at the optimum are a line that obeys every row. Bland's rule guarantees
//! termination; columns that the program in doubles found heavy are tried first, which keeps it short.
//!
//! Source: Bland, Math. Oper. Res. 2, 1977; the alternative is Gordan's, Math. Ann. 6, 1873.

use super::proof::{Grid, Proof};
use super::rows::{Octant, Row, is_forward};
use super::witness::AxialWitness;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use sightlines_exact::rational;

/// Coefficients of five unknowns, and the sum of weights.
const N: usize = 6;

/// The exact answer.
#[derive(Debug)]
pub(super) enum Exact {
    /// A line obeys every row strictly.
    Open(Box<AxialWitness>),
    /// None does.
    Blocked(Proof),
}

struct Tableau {
    /// Columns in the basis; `None` stands for the residual of an equation.
    basis: [Option<usize>; N],
    inverse: [[BigRational; N]; N],
    weights: [BigRational; N],
}

impl Tableau {
    fn new() -> Self {
        let unit = |i: usize| std::array::from_fn(|j| if i == j { BigRational::one() } else { BigRational::zero() });
        Self { basis: [None; N], inverse: std::array::from_fn(unit), weights: unit(N - 1) }
    }

    fn multipliers(&self) -> [BigRational; N] {
        let missing = || self.basis.iter().zip(&self.inverse).filter(|(c, _)| c.is_none()).map(|(_, row)| row);
        std::array::from_fn(|j| missing().map(|row| &row[j]).sum())
    }

    fn is_complete(&self) -> bool {
        self.basis.iter().zip(&self.weights).all(|(c, w)| c.is_some() || w.is_zero())
    }

    /// Brings a column into the basis; the leaving one is the first of those that bound it.
    fn pivot(&mut self, entering: usize, column: &[BigInt; N]) {
        let image: [BigRational; N] = std::array::from_fn(|i| dot(&self.inverse[i], column));
        let bounds = (0..N).filter(|&i| image[i].is_positive());
        let key = |i: usize| (&self.weights[i] / &image[i], self.basis[i].unwrap_or(usize::MAX), i);
        let (ratio, _, out) = bounds.map(key).min().expect("weights add up to 1, so they are bounded");
        let scaled: [BigRational; N] = std::array::from_fn(|j| &self.inverse[out][j] / &image[out]);
        for i in (0..N).filter(|&i| i != out && !image[i].is_zero()) {
            self.weights[i] -= &ratio * &image[i];
            for (x, s) in self.inverse[i].iter_mut().zip(&scaled) {
                *x -= &image[i] * s;
            }
        }
        (self.inverse[out], self.weights[out], self.basis[out]) = (scaled, ratio, Some(entering));
    }
}

fn dot(y: &[BigRational; N], column: &[BigInt; N]) -> BigRational {
    y.iter().zip(column).filter(|(_, c)| !c.is_zero()).map(|(y, c)| y * c).sum()
}

/// Decides whether a line of the octant obeys all rows strictly. `heavy` are rows to try first.
pub(super) fn decide(rows: &[Row], octant: Octant, heavy: &[(usize, f64)]) -> Exact {
    let grid = Grid::of(rows.iter());
    let mut order: Vec<usize> = heavy.iter().map(|h| h.0).collect();
    order.extend((0..rows.len()).filter(|k| heavy.iter().all(|h| h.0 != *k)));
    let mut columns: Vec<[BigInt; N]> = order.iter().map(|&k| with_sum(grid.coefficients(&rows[k], octant))).collect();
    for axis in 0..3 {
        let mut sign: [BigInt; 5] = Default::default();
        sign[axis] = -BigInt::one();
        columns.push(with_sum(sign));
    }
    let mut tableau = Tableau::new();
    loop {
        let y = tableau.multipliers();
        if tableau.is_complete() {
            let weights = tableau.basis.iter().zip(&tableau.weights);
            let terms = weights.filter_map(|(&column, w)| Some((*order.get(column?)?, w.clone())));
            return Exact::Blocked(Proof::Big(integers(terms.filter(|(_, w)| w.is_positive()).collect())));
        }
        match columns.iter().position(|c| dot(&y, c).is_positive()) {
            Some(entering) => tableau.pivot(entering, &columns[entering]),
            None => return Exact::Open(Box::new(witness(&grid, octant, &y))),
        }
    }
}

fn with_sum(a: [BigInt; 5]) -> [BigInt; N] {
    let [a, b, c, d, e] = a;
    [a, b, c, d, e, BigInt::one()]
}

/// Fractions times their common denominator, without a common factor.
fn integers(terms: Vec<(usize, BigRational)>) -> Vec<(usize, BigInt)> {
    // The denominator of m / d in lowest terms is what d has and m lacks.
    let with = |m: BigInt, d: &BigInt| {
        let lacks = BigRational::new(m.clone(), d.clone()).denom().clone();
        m * lacks
    };
    let scale = terms.iter().fold(BigInt::one(), |m, (_, w)| with(m, w.denom()));
    terms.into_iter().map(|(k, w)| (k, (w * &scale).to_integer())).collect()
}

/// The line with slownesses and offsets `y` in steps of the grid, counted from its lower corner.
fn witness(grid: &Grid, octant: Octant, y: &[BigRational; N]) -> AxialWitness {
    let (low, exponent) = grid.frame();
    let step = BigRational::from_integer(2.into()).pow(exponent);
    let offsets = [BigRational::zero(), y[3].clone(), y[4].clone()];
    let signed = |i: usize, x: BigRational| if is_forward(octant, i) { x } else { -x };
    let direction = [0, 1, 2].map(|i| signed(i, y[i].recip()));
    let point = [0, 1, 2].map(|i| rational(low[i]) + &offsets[i] * &direction[i] * &step);
    AxialWitness::new(point, direction)
}
