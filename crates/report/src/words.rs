//! Numbers for people: the same words wherever they are reported.

use std::time::Duration;

/// A share as a percentage, with as many digits as small shares need.
pub fn percent(share: f64) -> String {
    let digits = if share > 0.0 && share < 0.01 { 3 } else { 1 };
    format!("{:.*} %", digits, 100.0 * share)
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

/// A number with its noun, in the plural unless it is one.
pub fn count(n: impl Into<u64>, noun: &str) -> String {
    match n.into() {
        1 => format!("1 {noun}"),
        n => format!("{n} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_for_the_eye() {
        assert_eq!([percent(0.5), percent(0.001_234), percent(0.0)], ["50.0 %", "0.123 %", "0.0 %"]);
        assert_eq!([bytes(9_999), bytes(10_240), bytes(20 << 20)], ["9999 bytes", "10.0 KiB", "20.0 MiB"]);
        let times = [1_500, 250_000, 2_500_000].map(|us| seconds(Duration::from_micros(us)));
        assert_eq!(times, ["1.50 ms", "250 ms", "2.50 s"]);
        assert_eq!([count(0u64, "cell"), count(1u64, "cell"), count(2u64, "cell")], ["0 cells", "1 cell", "2 cells"]);
    }
}
