//! Numbers as arguments.

use crate::error::{Result, anyhow};
use sightlines::geometry::check_coordinate;
use std::str::FromStr;
use std::time::Duration;

/// A number that fits, or that the text is not what it should be.
pub(crate) fn number<T: FromStr>(text: &str, fits: impl FnOnce(&T) -> bool, what: &str) -> Result<T, String> {
    text.parse().ok().filter(fits).ok_or_else(|| format!("not {what}"))
}

/// Number of threads of a command; 0 stands for one for each core.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    at_most(text, 1024)
}

/// A whole number with a bound.
pub(crate) fn at_most(text: &str, most: usize) -> Result<usize, String> {
    number(text, |n| *n <= most, &format!("a whole number from 0 to {most}"))
}

pub(crate) fn coordinates(text: &str) -> Result<Vec<f64>> {
    let coordinate = |part: &str| -> Result<f64> {
        let x: f64 = part.trim().parse().map_err(|_| anyhow!("'{}' is not a number", part.trim()))?;
        Ok(check_coordinate(x)?)
    };
    text.split(',').map(coordinate).collect()
}

pub(crate) fn share(text: &str) -> Result<f64, String> {
    number(text, |x| (0.0..=1.0).contains(x), "a number from 0 to 1")
}

/// A length in scene units.
pub(crate) fn size(text: &str) -> Result<f64, String> {
    number(text, |x: &f64| x.is_finite() && *x >= 0.0, "a number from 0 on")
}

/// A length in scene units that is one.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    number(text, |x: &f64| x.is_finite() && *x > 0.0, "a number above 0")
}

/// A duration: a number of seconds, or one with the unit s, m or h.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let (number, unit) = match text.trim() {
        t if t.ends_with('s') => (&t[..t.len() - 1], 1.0),
        t if t.ends_with('m') => (&t[..t.len() - 1], 60.0),
        t if t.ends_with('h') => (&t[..t.len() - 1], 3600.0),
        t => (t, 1.0),
    };
    let wrong = || "not a duration such as 90s, 10m or 2h".to_owned();
    let seconds = number.parse::<f64>().map_err(|_| wrong())? * unit;
    Duration::try_from_secs_f64(seconds).map_err(|_| wrong())
}
