//! Numbers of two doubles, some 106 bits: enough for rows that are obeyed by a few units in the last place.
//!
//! Source: Dekker, Numer. Math. 18, 1971; Hida, Li and Bailey, "Library for double-double and quad-double arithmetic",
//! 2007; error bounds by Joldes, Muller and Popescu, ACM Trans. Math. Softw. 44, 2017.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The sum of two doubles, of which the second is at most half a unit in the last place of the first.
///
/// Sums, differences and products err by less than 2^-103 of the result, unless they leave the range of doubles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wide {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let part = high - a;
    Wide { high, low: (a - (high - part)) + (b - part) }
}

/// The same where the first has the larger magnitude.
fn quick_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

impl Wide {
    pub(crate) const ZERO: Self = Self::of(0.0);
    pub(crate) const ONE: Self = Self::of(1.0);

    pub(crate) const fn of(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// A difference of two doubles, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }

    /// Its product with a power of two.
    pub(crate) fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }
}

impl Neg for Wide {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Wide {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_sum(high.high, high.low + low.high);
        quick_sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Wide {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        quick_sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Wide {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::of(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::of(second);
        quick_sum(first, second) + Self::of(rest.high / other.high)
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.high.partial_cmp(&other.high)?.then(self.low.partial_cmp(&other.low)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;
    use sightlines_exact::rational;

    fn exact(x: Wide) -> BigRational {
        rational(x.high) + rational(x.low)
    }

    /// Two doubles of very different or nearly equal size.
    fn any_wide() -> impl Strategy<Value = Wide> {
        let part = || (-1.0f64..1.0, -60..60i32).prop_map(|(x, e)| x * 2f64.powi(e));
        (part(), part(), any::<bool>())
            .prop_map(|(a, b, close)| two_sum(a, if close { a * f64::EPSILON * b } else { b }))
    }

    /// Whether a result is within a share of the true one.
    fn within(found: Wide, truth: &BigRational, share: f64) -> bool {
        (exact(found) - truth).abs() <= truth.abs() * rational(share)
    }

    proptest! {
        /// Invariant: results err by less than is said.
        #[test]
        fn results_err_by_no_more_than_is_said(a in any_wide(), b in any_wide(), cancel in any::<bool>()) {
            let b = if cancel { -Wide { high: a.high, low: b.low.min(a.high.abs() * f64::EPSILON / 4.0).max(-a.high.abs() * f64::EPSILON / 4.0) } } else { b };
            let share = 2f64.powi(-103);
            prop_assert!(within(a + b, &(exact(a) + exact(b)), share), "{:?} + {:?}", a, b);
            prop_assert!(within(a - b, &(exact(a) - exact(b)), share), "{:?} - {:?}", a, b);
            prop_assert!(within(a * b, &(exact(a) * exact(b)), share), "{:?} * {:?}", a, b);
            prop_assert!((a > b) == (exact(a) > exact(b)), "{:?} > {:?}", a, b);
            if b.high != 0.0 {
                prop_assert!(within(a / b, &(exact(a) / exact(b)), 8.0 * share), "{:?} / {:?}", a, b);
            }
        }
    }

    /// A bound that is not kept: a product is not exact to 2^-110.
    #[test]
    fn products_are_not_exact() {
        let third = Wide::ONE / Wide::of(3.0);
        assert!(!within(third * third, &(exact(third) * exact(third)), 2f64.powi(-110)));
    }
}
