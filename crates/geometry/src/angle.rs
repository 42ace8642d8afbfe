//! Sines and cosines that are the same on every machine: sums, products and quotients only.

/// Sine and cosine of an angle in degrees: within 2^-50 of the true ones, and exact for whole quarters of a turn.
pub fn sin_cos(degrees: f64) -> [f64; 2] {
    // Both the remainder and what is left of the quarter are exact.
    let mut rest = degrees % 360.0;
    if rest < 0.0 {
        rest += 360.0;
    }
    let quarter = ((rest + 45.0) / 90.0).floor();
    let x = (rest - 90.0 * quarter) * (std::f64::consts::PI / 180.0);
    // |x| is at most an eighth of a turn, so that the first term left out is below 2^-58.
    let (square, mut term, mut sum) = (x * x, 1.0, [0.0, 0.0]);
    for k in 0..18u32 {
        // The terms x^k / k!, with the signs of the series.
        let sign = if k % 4 < 2 { 1.0 } else { -1.0 };
        sum[(k % 2) as usize] += sign * term;
        term = term * x / f64::from(k + 1);
    }
    let [cos, sin] = if square == 0.0 { [1.0, 0.0] } else { sum };
    // The quarter is one of 0 to 4.
    match quarter as u8 % 4 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_are_exact_and_others_near() {
        for turn in -3..=3 {
            let at = |degrees: i32| sin_cos(f64::from(360 * turn + degrees)).map(|x| x + 0.0);
            let all = [0, 90, 180, 270].map(at);
            assert_eq!(all, [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]]);
        }
        for k in -10_000..10_000 {
            let degrees = f64::from(k) * 0.017;
            let (sin, cos) = degrees.to_radians().sin_cos();
            let [s, c] = sin_cos(degrees);
            // The angle in radians is rounded as well.
            assert!((s - sin).abs() < 4e-15 && (c - cos).abs() < 4e-15, "{degrees}");
            assert!((s * s + c * c - 1.0).abs() < 2.5e-15, "{degrees}");
        }
        // An impostor: the series in degrees.
        assert!((sin_cos(30.0)[0] - 0.5).abs() < 1e-15 && (sin_cos(30.0)[0] - 30f64.sin()).abs() > 1.0);
    }
}
