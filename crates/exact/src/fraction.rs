//! Quotients that are only compared.

use num_bigint::BigInt;
use num_traits::One;
use std::cmp::Ordering;

/// A fraction that is not reduced: cheaper than [`BigRational`](crate::BigRational) where quotients are only compared.
///
/// Equality and order are those of the values, so 2/4 equals 1/2.
#[derive(Debug, Clone)]
pub struct Fraction {
    numerator: BigInt,
    denominator: BigInt,
}

impl Fraction {
    /// `numerator / denominator`.
    ///
    /// The denominator must be positive; that is the caller's proof, and checked in debug builds only.
    pub fn new(numerator: BigInt, denominator: BigInt) -> Self {
        debug_assert!(denominator.sign() == num_bigint::Sign::Plus, "denominators are positive");
        Self { numerator, denominator }
    }

    /// What stands above the line.
    pub const fn numerator(&self) -> &BigInt {
        &self.numerator
    }

    /// What stands below the line; positive.
    pub const fn denominator(&self) -> &BigInt {
        &self.denominator
    }
}

impl From<BigInt> for Fraction {
    fn from(x: BigInt) -> Self {
        Self { numerator: x, denominator: BigInt::one() }
    }
}

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Fraction {}
