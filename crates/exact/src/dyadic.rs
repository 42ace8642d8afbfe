//! Sums and products of doubles.

use crate::decode;
use num_bigint::{BigInt, Sign};
use std::ops::{Add, Mul, Neg, Sub};

/// An integer times a power of two: what sums and products of doubles are.
///
/// Operators work on references and do not round. Exponents must stay within `i32`, which products of a million doubles do.
#[derive(Debug, Clone)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i32,
}

impl Dyadic {
    /// A finite double.
    ///
    /// # Panics
    /// If `x` is infinite or NaN.
    pub fn new(x: f64) -> Self {
        let (mantissa, exponent) = decode(x).expect("coordinates are finite");
        Self { mantissa: BigInt::from(mantissa), exponent }
    }

    /// Three finite doubles.
    ///
    /// # Panics
    /// As [`Dyadic::new`].
    pub fn vector(v: [f64; 3]) -> [Self; 3] {
        v.map(Self::new)
    }

    /// -1, 0 or 1.
    pub fn sign(&self) -> i32 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// A double off by at most 2^-52 of the number; infinite or 0 outside the range of doubles.
    ///
    /// The number is cut to 62 bits, off by at most 2^-61 of it, and then rounded to nearest.
    pub fn to_f64(&self) -> f64 {
        let drop = self.mantissa.bits().saturating_sub(62);
        let top = i64::try_from(&self.mantissa >> drop).expect("62 bits fit");
        let exponent = i64::from(self.exponent) + drop as i64;
        // In two steps, so that neither power of two is out of range before the number is.
        let half = (exponent / 2).clamp(-1100, 1100) as i32;
        let rest = (exponent - exponent / 2).clamp(-1100, 1100) as i32;
        top as f64 * 2f64.powi(half) * 2f64.powi(rest)
    }

    /// Both mantissas for the smaller exponent, and that exponent.
    fn aligned(a: &Self, b: &Self) -> (BigInt, BigInt, i32) {
        // The exponent of a zero means nothing, and would only make the other number long.
        let exponent = match (a.sign(), b.sign()) {
            (0, _) => b.exponent,
            (_, 0) => a.exponent,
            _ => a.exponent.min(b.exponent),
        };
        let shifted =
            |x: &Self| if x.sign() == 0 { BigInt::ZERO } else { &x.mantissa << (x.exponent - exponent) as u32 };
        (shifted(a), shifted(b), exponent)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: &Dyadic) -> Dyadic {
        let (a, b, exponent) = Dyadic::aligned(self, other);
        Dyadic { mantissa: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: &Dyadic) -> Dyadic {
        let (a, b, exponent) = Dyadic::aligned(self, other);
        Dyadic { mantissa: a - b, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: &Dyadic) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Neg for Dyadic {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, ..self }
    }
}
