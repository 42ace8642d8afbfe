//! Many doubles as integers.

use crate::decode;
use num_bigint::BigInt;

/// A power of two of which all numbers of a job are multiples, so that each is an integer.
///
/// Sums, differences and comparisons of these integers mean the same as those of the numbers; a product of `n` numbers has the
/// unit to the power of `n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    exponent: i32,
}

impl Grid {
    /// The coarsest grid that has all these numbers; that of integers if all are 0.
    ///
    /// * Returns `None` if a number is infinite or NaN.
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut exponent = None;
        for x in numbers {
            let (mantissa, e) = decode(x)?;
            if mantissa != 0 {
                exponent = Some(exponent.map_or(e, |least: i32| least.min(e)));
            }
        }
        Some(Self { exponent: exponent.unwrap_or(0) })
    }

    /// The unit is two to this power.
    pub const fn exponent(self) -> i32 {
        self.exponent
    }

    /// The integer of a number on the grid: one that the grid was made of, or a sum of such numbers.
    ///
    /// # Panics
    /// If the number is not on the grid.
    pub fn integer(self, x: f64) -> BigInt {
        let (mantissa, exponent) = decode(x).expect("numbers of a grid are finite");
        if mantissa == 0 {
            return BigInt::ZERO;
        }
        BigInt::from(mantissa) << u32::try_from(exponent - self.exponent).expect("the grid divides its numbers")
    }

    /// The integers of three numbers.
    ///
    /// # Panics
    /// As [`Grid::integer`].
    pub fn vector(self, v: [f64; 3]) -> [BigInt; 3] {
        v.map(|x| self.integer(x))
    }
}
