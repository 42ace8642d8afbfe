//! Numbers for cases.

use sightlines::geometry::Random;

/// A whole number from `low` to `high`, both included.
pub fn between(random: &mut Random, low: i64, high: i64) -> i64 {
    low + random.below((high - low + 1) as usize) as i64
}

/// A number from -1 to 1.
pub fn signed_unit(random: &mut Random) -> f64 {
    2.0 * random.unit() - 1.0
}

/// `x` by so many units in the last place up. Zero and what would cross it stay as they are: what is near zero is no
/// coordinate.
pub fn up_by(x: f64, ulps: i64) -> f64 {
    let bits = x.to_bits() as i64;
    let magnitude = bits & i64::MAX;
    let moved = if x > 0.0 { magnitude.saturating_add(ulps) } else { magnitude.saturating_sub(ulps) };
    let y = f64::from_bits(moved.max(0) as u64);
    if x == 0.0 || moved <= 0 || y < 1e-30 || !y.is_finite() { x } else { y.copysign(x) }
}

/// With one chance in four, `x` by up to `most` units in the last place up or down.
pub fn nudged(random: &mut Random, x: f64, most: i64) -> f64 {
    if random.below(4) == 0 { up_by(x, between(random, -most, most)) } else { x }
}

/// `10^from`, `10^(from + step)`, …, `10^to`.
pub fn powers_of_ten(from: i32, to: i32, step: usize) -> Vec<f64> {
    // Read from text, for powers computed are not the same everywhere.
    (from..=to).step_by(step).map(|e| format!("1e{e}").parse().expect("a number")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_the_last_place() {
        assert_eq!(up_by(1.0, 1), 1.0f64.next_up());
        assert_eq!(up_by(1.0, -1), 1.0f64.next_down());
        assert_eq!(up_by(-3.5, 1), (-3.5f64).next_up());
        assert_eq!([up_by(0.0, 5), up_by(1e-3, -(1 << 62))], [0.0, 1e-3]);
        assert_eq!(powers_of_ten(-2, 2, 2), [0.01, 1.0, 100.0]);
    }
}
