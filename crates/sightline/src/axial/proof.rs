//! From weights in doubles to integers that prove that no line passes.
//!
//! Weights are a proof if they are non-negative and not all zero, and in the weighted sum of rows the offsets cancel
//! and the slownesses have coefficients of at least zero: for a line that passes, each row is negative, but this sum is
//! not. Offsets cancel if and only if the rows, as arrows from the early axis to the late one, form cycles through two
//! or three axes. So weights are written as a sum of cycles and each cycle's weight is rounded to an integer; offsets
//! then cancel exactly, and only three inequalities are left to check. They have slack if the program's margin is
//! clearly negative; otherwise the weights are recomputed as the integers with which the sum vanishes exactly.

use super::rows::{Octant, Row, sign};
use crate::wide::Wide;
use num_bigint::BigInt;
use num_traits::{CheckedDiv, CheckedMul, CheckedSub, FromPrimitive, One, Signed, ToPrimitive, Zero};

/// Rows by index, with weights that prove that no line passes.
#[derive(Debug, Clone)]
pub(super) enum Proof {
    /// Weights that are integers below 2^53.
    Small(Vec<(usize, f64)>),
    /// Any integers.
    Big(Vec<(usize, BigInt)>),
}

impl Proof {
    /// Whether one of its rows is about an axis.
    pub(super) fn speaks_of(&self, rows: &[Row], axis: usize) -> bool {
        let about = |k: usize| rows[k].early == axis || rows[k].late == axis;
        match self {
            Self::Small(terms) => terms.iter().any(|term| about(term.0)),
            Self::Big(terms) => terms.iter().any(|term| about(term.0)),
        }
    }

    /// The rows and their weights, which are positive; ordered by row.
    pub(super) fn terms(&self) -> Vec<(usize, BigInt)> {
        let mut terms = match self {
            Self::Small(terms) => {
                terms.iter().map(|&(k, w)| (k, BigInt::from_f64(w).expect("weights are finite"))).collect()
            }
            Self::Big(terms) => terms.clone(),
        };
        terms.sort_by_key(|term| term.0);
        terms
    }
}

/// Largest number of rows with weights that is handled.
const MAX_SUPPORT: usize = 8;

/// A cycle of up to three rows, by their places in the support, and its weight.
#[derive(Debug, Clone, Copy, Default)]
struct Cycle<W> {
    rows: [u8; 3],
    n_rows: u8,
    weight: W,
}

impl<W> Cycle<W> {
    fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows[..usize::from(self.n_rows)].iter().map(|&n| usize::from(n))
    }
}

/// Writes weights as a sum of cycles; what does not fit, by rounding, is dropped. Returns how many.
fn cycles<W>(rows: &[Row], support: &[(usize, W)], found: &mut [Cycle<W>; MAX_SUPPORT]) -> usize
where
    W: Copy + Default + PartialOrd + std::ops::SubAssign,
{
    const KINDS: [&[usize]; 5] = [&[0, 1], &[1, 2], &[2, 0], &[0, 1, 2], &[2, 1, 0]];
    let mut left = [W::default(); MAX_SUPPORT];
    left.iter_mut().zip(support).for_each(|(left, s)| *left = s.1);
    let mut n_found = 0;
    for axes in KINDS {
        // Each cycle uses up a row, so there is room for all.
        while n_found < MAX_SUPPORT {
            let mut cycle = Cycle::default();
            for (i, &from) in axes.iter().enumerate() {
                let to = axes[(i + 1) % axes.len()];
                let fits = |&n: &usize| {
                    let row = &rows[support[n].0];
                    left[n] > W::default() && row.early == from && row.late == to
                };
                let Some(n) = (0..support.len()).find(fits) else { break };
                if i == 0 || left[n] < cycle.weight {
                    cycle.weight = left[n];
                }
                (cycle.rows[i], cycle.n_rows) = (n as u8, cycle.n_rows + 1);
            }
            if usize::from(cycle.n_rows) < axes.len() {
                break;
            }
            cycle.rows().for_each(|n| left[n] -= cycle.weight);
            found[n_found] = cycle;
            n_found += 1;
        }
    }
    n_found
}

/// Rounds the cycles of `support` to integers, the largest to `scale` (at most 2^40), and checks the proof exactly;
/// `None` if the result proves nothing.
pub(super) fn by_cycles(rows: &[Row], octant: Octant, support: &[(usize, f64)], scale: f64) -> Option<Proof> {
    let mut terms = [(0, 0.0); MAX_SUPPORT];
    let n_terms = weigh(rows, octant, support, scale, &mut terms)?;
    Some(Proof::Small(terms[..n_terms].to_vec()))
}

/// Rounds weights to integers of some hundred bits, so that their cycles need less slack, and checks the proof exactly; `None` if the
/// result proves nothing.
pub(super) fn by_fine_cycles(rows: &[Row], octant: Octant, support: &[(usize, Wide)]) -> Option<Proof> {
    let support = support.get(..MAX_SUPPORT).unwrap_or(support);
    let largest = support.iter().map(|s| s.1.high).fold(0.0, f64::max);
    // A power of two of at most 2^100 divided by the largest.
    let scale = f64::from_bits(largest.recip().to_bits() & 0x7ff << 52) * (1u128 << 99) as f64;
    let whole = |w: Wide| (w.high * scale).round() as i128 + (w.low * scale).round() as i128;
    let whole: Vec<(usize, i128)> = support.iter().map(|&(k, w)| (k, whole(w))).collect();
    let mut found = [Cycle::default(); MAX_SUPPORT];
    let n_found = cycles(rows, &whole, &mut found);
    let mut weights = [0i128; MAX_SUPPORT];
    for cycle in &found[..n_found] {
        cycle.rows().for_each(|n| weights[n] += cycle.weight);
    }
    // Each is at most what it was before, so it has two parts that doubles hold.
    let parts = |w: i128| [(w >> 50) as f64 * (1u64 << 50) as f64, (w & ((1 << 50) - 1)) as f64];
    let terms: Vec<(usize, i128)> = support.iter().zip(weights).map(|(s, w)| (s.0, w)).filter(|t| t.1 > 0).collect();
    let is_slow = |axis: usize| {
        let products = terms.iter().filter_map(|&(k, w)| rows[k].term(axis).map(|(factor, x)| (factor, w, x)));
        let products = products.flat_map(|(factor, w, x)| parts(w).map(|w| (factor * w, x)));
        sign(octant, axis) * sign_of_sum(products) >= 0.0
    };
    let proves = !terms.is_empty() && (0..3).all(is_slow);
    proves.then(|| Proof::Big(terms.into_iter().map(|(k, w)| (k, BigInt::from(w))).collect()))
}

/// Whether [`by_cycles`] finds a proof.
pub(super) fn is_proven_by_cycles(rows: &[Row], octant: Octant, support: &[(usize, f64)], scale: f64) -> bool {
    weigh(rows, octant, support, scale, &mut [(0, 0.0); MAX_SUPPORT]).is_some()
}

/// The rows and integer weights of a proof, and how many there are.
fn weigh(
    rows: &[Row],
    octant: Octant,
    support: &[(usize, f64)],
    scale: f64,
    terms: &mut [(usize, f64); MAX_SUPPORT],
) -> Option<usize> {
    let support = support.get(..MAX_SUPPORT).unwrap_or(support);
    let mut found = [Cycle::default(); MAX_SUPPORT];
    let n_found = cycles(rows, support, &mut found);
    let found = &found[..n_found];
    let largest = found.iter().map(|c| c.weight).fold(0.0, f64::max);
    let mut weights = [0.0; MAX_SUPPORT];
    for cycle in found {
        // Integers below 2^43, so their sums are exact.
        let whole = (cycle.weight / largest * scale).round();
        cycle.rows().for_each(|n| weights[n] += whole);
    }
    let mut n_terms = 0;
    for (s, &weight) in support.iter().zip(&weights).filter(|(_, w)| **w > 0.0) {
        terms[n_terms] = (s.0, weight);
        n_terms += 1;
    }
    let terms = &terms[..n_terms];
    (!terms.is_empty() && (0..3).all(|axis| is_slow(rows, octant, terms, axis))).then_some(n_terms)
}

/// Whether the coefficient of a slowness in the weighted sum is at least zero.
///
/// As offsets cancel, coordinates may be measured from any origin; measured from one of themselves, they are small. A
/// difference and its product with a weight err by 2^-53 of themselves each, and five sums by 2^-53 of the total of
/// magnitudes each, in all below 8 * 2^-53 to first order; 16 * 2^-53 covers the rest and the rounding of the total
/// itself. Sums within that bound are added up exactly.
fn is_slow(rows: &[Row], octant: Octant, terms: &[(usize, f64)], axis: usize) -> bool {
    let mut origin = None;
    let (mut sum, mut sizes) = (0.0, 0.0);
    for &(k, weight) in terms {
        let Some((factor, x)) = rows[k].term(axis) else { continue };
        let term = factor * weight * (x - *origin.get_or_insert(x));
        sum += term;
        sizes += term.abs();
    }
    let sum = sign(octant, axis) * sum;
    if sum.abs() > 8.0 * f64::EPSILON * sizes {
        return sum > 0.0;
    }
    let products = terms.iter().filter_map(|&(k, w)| rows[k].term(axis).map(|(factor, x)| (factor * w, x)));
    sizes == 0.0 || sign(octant, axis) * sign_of_sum(products) >= 0.0
}

/// The sign of a sum of products of doubles, exactly: -1, 0 or 1. Products must not leave the range of
/// doubles.
///
/// Source: Shewchuk, Discrete Comput. Geom. 18, 1997: a sum of doubles that do not overlap has the sign of
/// its largest.
pub(super) fn sign_of_sum(products: impl Iterator<Item = (f64, f64)>) -> f64 {
    // From small to large, without overlap, some zero; two for each of up to five products.
    let mut parts: Vec<f64> = Vec::with_capacity(16);
    for (a, b) in products {
        let high = a * b;
        for x in [a.mul_add(b, -high), high] {
            let mut carry = x;
            for part in &mut parts {
                let sum = carry + *part;
                let virtual_part = sum - carry;
                *part = (carry - (sum - virtual_part)) + (*part - virtual_part);
                carry = sum;
            }
            parts.push(carry);
        }
    }
    parts.iter().rev().find(|x| **x != 0.0).map_or(0.0, |x| x.signum())
}

/// A finite double as `mantissa * 2^exponent`, with an odd mantissa or zero.
fn parts(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (fraction, exponent) = ((bits & ((1 << 52) - 1)) as i64, (bits >> 52 & 0x7ff) as i32);
    let (mantissa, exponent) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    (if x < 0.0 { -(mantissa >> zeros) } else { mantissa >> zeros }, exponent + zeros as i32)
}

/// Coordinates as integers: `low[axis] + x / 2^shift` for an integer `x`, for some `shift`.
#[derive(Debug)]
pub(super) struct Grid {
    low: [f64; 3],
    /// The exponent of the finest coordinate.
    exponent: i32,
}

impl Grid {
    /// The grid of all coordinates of `rows`.
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let (mut low, mut exponent) = ([f64::INFINITY; 3], i32::MAX);
        for row in rows {
            for (axis, x) in [(row.early, row.from), (row.late, row.to)] {
                low[axis] = low[axis].min(x);
                if x != 0.0 {
                    exponent = exponent.min(parts(x).1);
                }
            }
        }
        let low = low.map(|x| if x.is_finite() { x } else { 0.0 });
        Self { low, exponent: if exponent == i32::MAX { 0 } else { exponent } }
    }

    /// The integer of a coordinate of the rows that the grid was made for.
    pub(super) fn integer(&self, axis: usize, x: f64) -> BigInt {
        let whole = |x: f64| {
            let (mantissa, exponent) = parts(x);
            BigInt::from(mantissa) << (exponent.max(self.exponent) - self.exponent).unsigned_abs()
        };
        whole(x) - whole(self.low[axis])
    }

    /// Lower corner, and the exponent of a step.
    pub(super) fn frame(&self) -> ([f64; 3], i32) {
        (self.low, self.exponent)
    }

    /// The coefficients of a row: slownesses in the octant, then the offsets of axes 1 and 2.
    pub(super) fn coefficients(&self, row: &Row, octant: Octant) -> [BigInt; 5] {
        let mut a: [BigInt; 5] = Default::default();
        let signed = |axis: usize, x: BigInt| if sign(octant, axis) > 0.0 { x } else { -x };
        a[row.early] = signed(row.early, self.integer(row.early, row.from));
        a[row.late] = -signed(row.late, self.integer(row.late, row.to));
        for (axis, step) in [(row.early, -1), (row.late, 1)] {
            if axis > 0 {
                a[axis + 2] = BigInt::from(step);
            }
        }
        a
    }
}

/// Recomputes the non-zero weights of rows and slownesses as integers with which the sum is exactly zero; `None` if
/// that does not determine them, or if they are not all of one sign.
pub(super) fn by_elimination(
    rows: &[Row],
    octant: Octant,
    support: &[(usize, f64)],
    signs: [bool; 3],
) -> Option<Proof> {
    let grid = Grid::of(support.iter().map(|&(k, _)| &rows[k]));
    let mut columns: Vec<[BigInt; 5]> = support.iter().map(|&(k, _)| grid.coefficients(&rows[k], octant)).collect();
    for axis in (0..3).filter(|&axis| signs[axis]) {
        let mut column: [BigInt; 5] = Default::default();
        column[axis] = -BigInt::one();
        columns.push(column);
    }
    // Elimination multiplies three or more coordinates, so it is tried for short ones only.
    let small = |column: &[BigInt; 5]| {
        let [a, b, c, d, e] = column.each_ref().map(BigInt::to_i128);
        Some([a?, b?, c?, d?, e?])
    };
    let small: Option<Vec<[i128; 5]>> = columns.iter().map(small).collect();
    let null = match small.and_then(null_vector) {
        Some(null) => null.into_iter().map(BigInt::from).collect(),
        None => null_vector(columns)?,
    };
    let weights = if null.iter().any(Signed::is_negative) { null.into_iter().map(|x| -x).collect() } else { null };
    if weights.iter().any(Signed::is_negative) || weights[..support.len()].iter().all(Zero::is_zero) {
        return None;
    }
    let terms = support.iter().zip(weights).map(|(s, w)| (s.0, w)).filter(|(_, w)| !w.is_zero());
    Some(Proof::Big(terms.collect()))
}

/// The integers, unique up to a factor, with which columns add up to zero; `None` if there are none or
/// they are not unique, or on overflow. Fraction-free elimination (Bareiss, Math. Comp. 22, 1968).
fn null_vector<T>(mut columns: Vec<[T; 5]>) -> Option<Vec<T>>
where
    T: Clone + Zero + One + std::ops::Neg<Output = T> + CheckedMul + CheckedSub + CheckedDiv,
{
    let mut last = T::one();
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    let mut free = None;
    for c in 0..columns.len() {
        let Some(r) = (0..5).find(|&r| !columns[c][r].is_zero() && pivots.iter().all(|p| p.1 != r)) else {
            if free.replace(c).is_some() {
                return None;
            }
            continue;
        };
        let pivot = columns[c].clone();
        for (k, column) in columns.iter_mut().enumerate() {
            if k == c {
                continue;
            }
            let head = column[r].clone();
            for i in (0..5).filter(|&i| i != r) {
                let product = pivot[r].checked_mul(&column[i])?.checked_sub(&pivot[i].checked_mul(&head)?)?;
                column[i] = product.checked_div(&last)?;
            }
        }
        for i in (0..5).filter(|&i| i != r) {
            columns[c][i] = T::zero();
        }
        last = pivot[r].clone();
        pivots.push((c, r));
    }
    let free = free?;
    let mut null = vec![T::zero(); columns.len()];
    for &(c, r) in &pivots {
        null[c] = -columns[free][r].clone();
    }
    null[free] = last;
    Some(null)
}
