//! Numbers for people: the same words wherever they are reported.

use std::time::Duration;

/// A share as a percentage, with as many digits as small shares need.
pub fn percent(share: f64) -> String {
    let digits = if share > 0.0 && share < 0.01 { 3 } else { 1 };
    format!("{:.*} %", digits, 100.0 * share)
}

/// A share that may be very small.
pub fn parts(share: f64) -> String {
    if share == 0.0 || share >= 0.01 { percent(share) } else { format!("{:.3e}", share) }
}

/// A part of a whole; 0 of nothing.
pub fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// A number of bytes, rounded for the eye.
pub fn bytes(n: u64) -> String {
    match n {
        0..=9_999 => format!("{n} bytes"),
        10_000..=9_999_999 => format!("{:.1} KiB", n as f64 / 1024.0),
        _ => format!("{:.1} MiB", n as f64 / (1024.0 * 1024.0)),
    }
}

/// A duration, rounded for the eye.
pub fn seconds(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 0.01 => format!("{:.2} ms", s * 1e3),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

/// The same of a number of seconds; 0 of what is no duration.
pub fn seconds_of(time: f64) -> String {
    seconds(Duration::try_from_secs_f64(time).unwrap_or_default())
}

/// A duration, rounded as an estimate should be.
pub fn rough(time: Duration) -> String {
    match time.as_secs() {
        s @ 0..90 => format!("{s} s"),
        s @ 90..5400 => format!("{} min", (s + 30) / 60),
        s => format!("{:.1} h", s as f64 / 3600.0),
    }
}

/// A number with its noun, in the plural unless it is one.
pub fn count(n: impl Into<u64>, noun: &str) -> String {
    match n.into() {
        1 => format!("1 {noun}"),
        n => format!("{n} {noun}s"),
    }
}

/// A coordinate for people: as it is if that takes few digits; else with those that single precision needs if it is such a number, or rounded
/// to 15, so that what was computed does not show how doubles round. Programs get all digits.
pub fn coordinate(x: f64) -> String {
    near(x, x.abs())
}

/// A point for people: each coordinate as [`coordinate`] writes it, and to no more decimals than the largest has.
pub fn point(p: &[f64]) -> String {
    let largest = p.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let texts: Vec<String> = p.iter().map(|&x| near(x, largest)).collect();
    format!("({})", texts.join(", "))
}

/// The distance of two coordinates for people, to as many digits as these have.
pub fn distance(low: f64, high: f64) -> String {
    let x = high - low;
    let digits = if [low, high].into_iter().all(is_single) { 7.0 } else { 15.0 };
    if is_short(x) { x.to_string() } else { rounded(x, low.abs().max(high.abs()), digits) }
}

/// Whether single precision holds a number.
fn is_single(x: f64) -> bool {
    f64::from(x as f32) == x
}

/// Whether all digits of a number are few. Decimals that were written by hand are; a number of single precision that was not takes more in a double.
fn is_short(x: f64) -> bool {
    x.to_string().bytes().filter(u8::is_ascii_digit).count() <= 12
}

/// A number to the decimals that 15 digits of `size` have, unless it takes fewer.
fn near(x: f64, size: f64) -> String {
    if is_short(x) {
        x.to_string()
    } else if is_single(x) {
        (x as f32).to_string()
    } else {
        rounded(x, size, 15.0)
    }
}

/// A number to the decimals that so many digits of `size` have; all digits of what is not finite.
fn rounded(x: f64, size: f64, digits: f64) -> String {
    if !(size.is_finite() && size > 0.0) {
        return x.to_string();
    }
    // A double has fewer than 400 places on either side of the point.
    let decimals = (digits - 1.0 - size.log10().floor()).clamp(0.0, 400.0) as usize;
    let rounded = format!("{x:.decimals$}").parse().unwrap_or(x);
    // Minus zero is zero.
    (rounded + 0.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_written_as_they_were_meant() {
        let single = |x: f32| f64::from(x);
        assert_eq!([0.1, 9.42, single(0.452), -2.0, 1e-3].map(coordinate), ["0.1", "9.42", "0.452", "-2", "0.001"]);
        assert_eq!(
            [1.718_750_000_000_000_4, 0.1 + 0.2, 9.972_656_25].map(coordinate),
            ["1.71875", "0.3", "9.97265625"]
        );
        // The impostor: written out, the differences show how doubles round.
        assert_eq!([(9.42 - 9.0).to_string(), distance(9.0, 9.42)], ["0.41999999999999993", "0.42"]);
        assert_eq!([(1009.42 - 1009.0f64).to_string(), distance(1009.0, 1009.42)], ["0.4199999999999591", "0.42"]);
        assert_eq!([distance(single(-0.15), 8.0), distance(single(0.1), single(0.3))], ["8.15", "0.2"]);
        assert_eq!(point(&[single(0.1), -4e-18, 12.570_312_500_000_002]), "(0.1, 0, 12.5703125)");
        assert_eq!([f64::NAN, f64::INFINITY, -0.0, 1e300, 1e-300].map(coordinate)[..3], ["NaN", "inf", "-0"]);
        assert_eq!(coordinate(single(203.833_3)), "203.8333");
        // What was given with at most 15 digits is written as it was given.
        for text in ["123456789.012345", "0.000123456789012345", "-98765.4321", "500002.25", "5400001.1"] {
            assert_eq!(coordinate(text.parse().unwrap()), text);
        }
    }

    #[test]
    fn numbers_are_rounded_for_the_eye() {
        assert_eq!([percent(0.5), percent(0.001_234), percent(0.0)], ["50.0 %", "0.123 %", "0.0 %"]);
        assert_eq!([bytes(9_999), bytes(10_240), bytes(20 << 20)], ["9999 bytes", "10.0 KiB", "20.0 MiB"]);
        let times = [1_500, 250_000, 2_500_000].map(|us| seconds(Duration::from_micros(us)));
        assert_eq!(times, ["1.50 ms", "250 ms", "2.50 s"]);
        assert_eq!([count(0u64, "cell"), count(1u64, "cell"), count(2u64, "cell")], ["0 cells", "1 cell", "2 cells"]);
    }

    #[test]
    fn estimates_are_rough() {
        let text = |s: u64| rough(Duration::from_secs(s));
        assert_eq!([text(0), text(89), text(90), text(3601), text(5400)], ["0 s", "89 s", "2 min", "60 min", "1.5 h"]);
    }
}
