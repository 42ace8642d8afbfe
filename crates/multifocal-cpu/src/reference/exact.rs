//! Coordinates as whole numbers, and fractions of them.

use num_bigint::BigInt;
use num_traits::{Float, One, Zero};
use sightlines_geometry::Point3;
use sightlines_multifocal::Job;
use std::cmp::Ordering;

/// A point or a vector in whole numbers.
pub(super) type Whole3 = [BigInt; 3];

/// A power of two of which all coordinates of a job, and its unit, are multiples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    exponent: i32,
}

impl Scale {
    pub(super) fn of(job: &Job<'_>) -> Self {
        let planes = job.planes().iter().flat_map(|p| {
            let ([a, b], [c, d]) = (p.origin(), p.step());
            [p.at(), a, b, c, d]
        });
        let points = job.occluders().iter().flat_map(|o| o.outline().iter().chain(o.facets().iter().flatten()));
        let bounds = job.occluders().iter().map(|o| o.bounds()).chain([job.volume().bounds()]);
        let corners = bounds.flat_map(|b| b.min.into_iter().chain(b.max));
        let all = planes.chain(points.flatten().copied()).chain(corners).chain([job.unit()]);
        Self { exponent: all.filter_map(last_bit).min().unwrap_or(0) }
    }

    /// A coordinate of the job, or a sum of some.
    pub(super) fn whole(self, x: f64) -> BigInt {
        let Some(last) = last_bit(x) else { return BigInt::zero() };
        let (mantissa, exponent, sign) = x.integer_decode();
        let odd = BigInt::from(mantissa >> (last - i32::from(exponent))) * sign;
        odd << usize::try_from(last - self.exponent).expect("the scale divides all coordinates of its job")
    }

    pub(super) fn point(self, p: Point3) -> Whole3 {
        p.map(|x| self.whole(x))
    }
}

/// Exponent of the last bit that is set. None for 0.
fn last_bit(x: f64) -> Option<i32> {
    let (mantissa, exponent, _) = x.integer_decode();
    (mantissa != 0).then(|| i32::from(exponent) + mantissa.trailing_zeros() as i32)
}

pub(super) fn difference(a: &Whole3, b: &Whole3) -> Whole3 {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

pub(super) fn dot(a: &Whole3, b: &Whole3) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(super) fn cross(a: &Whole3, b: &Whole3) -> Whole3 {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

/// A fraction that is not reduced; its denominator is positive.
#[derive(Debug, Clone)]
pub(super) struct Fraction {
    pub(super) num: BigInt,
    pub(super) den: BigInt,
}

impl Fraction {
    pub(super) fn whole(num: BigInt) -> Self {
        Self { num, den: BigInt::one() }
    }

    pub(super) fn cmp(&self, other: &Self) -> Ordering {
        (&self.num * &other.den).cmp(&(&other.num * &self.den))
    }

    pub(super) fn min(self, other: Self) -> Self {
        if other.cmp(&self).is_lt() { other } else { self }
    }

    pub(super) fn max(self, other: Self) -> Self {
        if other.cmp(&self).is_gt() { other } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_become_whole_numbers() {
        let scale = Scale { exponent: -3 };
        for (x, whole) in [(0.0, 0), (-0.0, 0), (1.0, 8), (-2.5, -20), (0.125, 1), (1e6, 8_000_000)] {
            assert_eq!(scale.whole(x), BigInt::from(whole), "{x}");
        }
        assert_eq!(Scale { exponent: -140 }.whole(2f64.powi(100)), BigInt::one() << 240usize);
    }

    #[test]
    fn fractions_are_compared_by_value() {
        let f = |num: i32, den: i32| Fraction { num: num.into(), den: den.into() };
        assert!(f(2, 4).cmp(&f(1, 2)).is_eq());
        assert!(f(-1, 3).cmp(&f(-1, 2)).is_gt());
        assert!(f(1, 3).min(f(2, 7)).cmp(&f(2, 7)).is_eq());
        assert!(f(1, 3).max(f(2, 7)).cmp(&f(1, 3)).is_eq());
    }
}
