//! Logarithms and angles from additions, multiplications, divisions and square roots alone, which give the same bits on every machine.

/// The logarithm of a positive, finite, normal number to base 2; zero for one. Within a few units in the last place.
pub(crate) fn log2(x: f64) -> f64 {
    debug_assert!(x.is_normal() && x > 0.0, "{x}");
    const MANTISSA: u64 = (1 << 52) - 1;
    let bits = x.to_bits();
    let mut exponent = (bits >> 52) as i64 - 1023;
    let mut m = f64::from_bits((bits & MANTISSA) | (1023 << 52));
    if m > std::f64::consts::SQRT_2 {
        m *= 0.5;
        exponent += 1;
    }
    // ln m = 2 artanh s, where |s| is at most 0.1716: its powers above the 23rd are below 2^-57.
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let mut sum = 0.0;
    for k in (0..=11u32).rev() {
        sum = sum * z + 1.0 / f64::from(2 * k + 1);
    }
    exponent as f64 + 2.0 * s * sum * std::f64::consts::LOG2_E
}

/// The angle between two vectors with this dot product and cross product, in quarter turns: from 0 (one direction) over 1 (a right angle)
/// to 2 (opposite directions). Exact at these three, else within a few units in the last place. 0 for two zeros.
pub(crate) fn quarter_turns(dot: f64, cross: f64) -> f64 {
    let (x, y) = (dot.abs(), cross.abs());
    let acute = if y == 0.0 {
        0.0
    } else if x == 0.0 {
        1.0
    } else if y <= x {
        arctangent(y / x) * std::f64::consts::FRAC_2_PI
    } else {
        1.0 - arctangent(x / y) * std::f64::consts::FRAC_2_PI
    };
    if dot < 0.0 { 2.0 - acute } else { acute }
}

/// A lower bound of [`quarter_turns`] that takes one division: the place on the square with corners on the axes, of which the angle
/// differs by at most 4.1 degrees, less 0.046 quarter turns.
pub(crate) fn quarter_turns_at_least(dot: f64, cross: f64) -> f64 {
    let (x, y) = (dot.abs(), cross.abs());
    let acute = if y == 0.0 { 0.0 } else { y / (x + y) };
    (if dot < 0.0 { 2.0 - acute } else { acute }) - 0.046
}

/// The arctangent of a number from 0 to 1.
fn arctangent(t: f64) -> f64 {
    // Tangents of an eighth, and of three sixteenths and a sixteenth of a half turn divide the range into quarters.
    const STEPS: [(f64, f64); 4] = [
        (0.0, 0.0),
        (0.198_912_367_379_658, 0.125 * std::f64::consts::FRAC_PI_2),
        (0.414_213_562_373_095_05, 0.25 * std::f64::consts::FRAC_PI_2),
        (0.668_178_637_919_298_9, 0.375 * std::f64::consts::FRAC_PI_2),
    ];
    let step = STEPS.iter().rposition(|&(tangent, _)| tangent <= t).unwrap_or(0);
    let (tangent, angle) = STEPS[step];
    // At most the tangent of a sixteenth of a half turn, 0.199: powers above the 25th are below 2^-62.
    let s = (t - tangent) / (1.0 + t * tangent);
    let z = s * s;
    let mut sum = 0.0;
    for k in (0..=12u32).rev() {
        sum = 1.0 / f64::from(2 * k + 1) - sum * z;
    }
    angle + s * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_those_of_the_library() {
        for k in 1..4000u32 {
            let x = f64::from(k) * if k % 2 == 0 { 1.0 / 3.0 } else { 1.0 };
            let error = (log2(x) - x.log2()).abs();
            assert!(error <= 4e-16 * x.log2().abs().max(1.0), "{x}: {error}");
        }
        let powers: Vec<f64> = (-60..60).map(|e| log2(2f64.powi(e))).collect();
        assert_eq!(powers, (-60..60).map(f64::from).collect::<Vec<_>>(), "powers of two are exact");
    }

    #[test]
    fn angles_are_those_of_the_library() {
        let mut largest = [0.0f64; 2];
        for (x, y) in (-40..=40).flat_map(|x| (-40..=40).map(move |y| (f64::from(x), f64::from(y)))) {
            if (x, y) == (0.0, 0.0) {
                continue;
            }
            let true_angle = y.abs().atan2(x) * std::f64::consts::FRAC_2_PI;
            let angle = quarter_turns(x, y);
            largest[0] = largest[0].max((angle - true_angle).abs());
            let below = angle - quarter_turns_at_least(x, y);
            assert!(below >= 0.0, "{x}, {y}: {below}");
            largest[1] = largest[1].max(below);
        }
        assert!(largest[0] <= 9e-16, "{largest:?}");
        assert!(largest[1] <= 0.0921, "the bound is near: {largest:?}");
        assert_eq!([quarter_turns(3.0, 0.0), quarter_turns(0.0, -2.0), quarter_turns(-1.0, 0.0)], [0.0, 1.0, 2.0]);
        assert_eq!([quarter_turns(5.0, 5.0), quarter_turns(-5.0, 5.0)], [0.5, 1.5]);
    }
}
