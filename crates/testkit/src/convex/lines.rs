//! Lines that touch four edges, in integers.
//!
//! A line is `(d, m)`: its direction, and its moment about the origin. It passes an edge `(e, n)` on the inner side
//! where `d · n + m · e` is positive, and touches the edge's line where that is zero. Four edges leave a pencil of
//! `(d, m)`, of which those with `d · m = 0` are lines.

use super::surd::Surd;
use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

/// Six coordinates: a direction and a moment, or the row of an edge: its moment and its direction.
pub(super) type Six = [BigInt; 6];

/// A line with coordinates `a + b √discriminant`.
#[derive(Debug, Clone)]
pub(super) struct SurdLine {
    pub(super) coordinates: [Surd; 6],
    pub(super) discriminant: BigInt,
}

/// The row of an edge: times the coordinates of a line it gives how the line passes.
pub(super) fn edge_row(a: &[BigInt; 3], b: &[BigInt; 3]) -> Six {
    let m = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [m(1, 2), m(2, 0), m(0, 1), &b[0] - &a[0], &b[1] - &a[1], &b[2] - &a[2]]
}

/// All lines that touch the lines of four edges. Where these are infinitely many, those of them that touch another
/// edge too. None if the four rows do not determine a pencil: then other four do, of those that such a line touches.
pub(super) fn lines_touching(rows: [&Six; 4], others: &[Six]) -> Vec<SurdLine> {
    let Some([f, g]) = pencil(rows) else { return Vec::new() };
    let dm = |x: &Six, y: &Six| (0..3).map(|k| &x[k] * &y[k + 3]).sum::<BigInt>();
    let (a, b, c) = (dm(&f, &f), dm(&f, &g) + dm(&g, &f), dm(&g, &g));
    let rational = |s: &BigInt, t: &BigInt| SurdLine {
        coordinates: std::array::from_fn(|k| Surd { a: s * &f[k] + t * &g[k], b: BigInt::zero() }),
        discriminant: BigInt::zero(),
    };
    if a.is_zero() && b.is_zero() && c.is_zero() {
        let ends = others.iter().map(|row| {
            let [on_f, on_g] = [&f, &g].map(|x| x.iter().zip(row).map(|(x, r)| x * r).sum::<BigInt>());
            rational(&on_g, &-on_f)
        });
        return ends
            .chain([rational(&BigInt::one(), &BigInt::zero()), rational(&BigInt::zero(), &BigInt::one())])
            .collect();
    }
    let discriminant = &b * &b - BigInt::from(4) * &a * &c;
    if discriminant.is_negative() {
        return Vec::new();
    }
    // s f + t g with s : t = (-b ± √discriminant) : 2 a, or the other way round if a is zero.
    let (x, y, twice) = if !a.is_zero() {
        (&f, &g, BigInt::from(2) * &a)
    } else if !c.is_zero() {
        (&g, &f, BigInt::from(2) * &c)
    } else {
        return vec![rational(&BigInt::one(), &BigInt::zero()), rational(&BigInt::zero(), &BigInt::one())];
    };
    let line = |sign: i32| SurdLine {
        coordinates: std::array::from_fn(|k| Surd { a: -&b * &x[k] + &twice * &y[k], b: BigInt::from(sign) * &x[k] }),
        discriminant: discriminant.clone(),
    };
    vec![line(1), line(-1)]
}

/// Two vectors that span what four rows vanish on; `None` if the rows depend on each other.
///
/// Source: Bareiss, "Sylvester's identity and multistep integer-preserving Gaussian elimination", Math. Comp. 22,
/// 1968: every division leaves no rest.
fn pencil(rows: [&Six; 4]) -> Option<[Six; 2]> {
    let mut m: [Six; 4] = rows.map(Clone::clone);
    let mut pivots = [0; 4];
    let mut previous = BigInt::one();
    for k in 0..4 {
        let (row, column) = (k..4).flat_map(|r| (0..6).map(move |c| (r, c))).find(|&(r, c)| !m[r][c].is_zero())?;
        m.swap(k, row);
        pivots[k] = column;
        let pivot_row = m[k].clone();
        let pivot = pivot_row[column].clone();
        for (i, row) in m.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[column].clone();
            for (x, p) in row.iter_mut().zip(&pivot_row) {
                *x = (&pivot * &*x - &factor * p) / &previous;
            }
            debug_assert!(row[column].is_zero(), "row {i} is cleared");
        }
        previous = pivot;
    }
    // By now each pivot column holds the last pivot and zeros.
    let free: Vec<usize> = (0..6).filter(|c| !pivots.contains(c)).collect();
    let vector = |column: usize| {
        let mut v: Six = std::array::from_fn(|_| BigInt::zero());
        v[column] = previous.clone();
        pivots.iter().zip(&m).for_each(|(&pivot, row)| v[pivot] = -row[column].clone());
        v
    };
    Some([vector(free[0]), vector(free[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(a: [i64; 3], b: [i64; 3]) -> Six {
        edge_row(&a.map(BigInt::from), &b.map(BigInt::from))
    }

    #[test]
    fn lines_touch_what_they_are_made_for() {
        let mut state = 1u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 60) as i64 - 8
        };
        let (mut n_lines, mut n_irrational) = (0, 0);
        for _ in 0..300 {
            let rows: [Six; 5] =
                std::array::from_fn(|_| row(std::array::from_fn(|_| number()), std::array::from_fn(|_| number())));
            for line in lines_touching([&rows[0], &rows[1], &rows[2], &rows[3]], &rows) {
                assert!(rows[..4].iter().all(|r| Surd::dot(&line.coordinates, r).sign(&line.discriminant) == 0));
                n_lines += 1;
                n_irrational += usize::from(Surd::dot(&line.coordinates, &rows[4]).b.is_positive());
            }
        }
        assert!(n_lines > 200 && n_irrational > 50, "{n_lines} {n_irrational}");
    }

    #[test]
    fn rows_that_depend_make_no_pencil() {
        let x = row([0, 0, 0], [1, 0, 0]);
        let y = row([0, 0, 0], [0, 1, 0]);
        let z = row([0, 0, 0], [1, 1, 0]);
        assert!(lines_touching([&x, &y, &z, &x], &[]).is_empty());
    }
}
