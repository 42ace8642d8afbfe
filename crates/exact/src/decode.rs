//! What a double stands for.

use num_rational::BigRational;

/// A double as `mantissa · 2^exponent` with an odd mantissa, or `(0, 0)`. Exact.
///
/// * Returns `None` for infinities and NaN.
pub const fn decode(x: f64) -> Option<(i64, i32)> {
    if !x.is_finite() {
        return None;
    }
    let bits = x.to_bits();
    let (biased, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (magnitude, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    if magnitude == 0 {
        return Some((0, 0));
    }
    let zeros = magnitude.trailing_zeros();
    let odd = magnitude >> zeros;
    Some((if x < 0.0 { -odd } else { odd }, exponent + zeros as i32))
}

/// A finite double as a reduced fraction. Exact.
///
/// # Panics
/// If `x` is infinite or NaN: callers have checked their coordinates.
pub fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).expect("coordinates are finite")
}
