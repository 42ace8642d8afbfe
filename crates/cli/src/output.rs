//! Results: standard output, and files that appear whole.

use crate::error::CliError;
use serde::Serialize;
use sightlines::formats::atomic_write;
use std::fmt;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Prints a result: as one line of JSON if `json`, otherwise as it is displayed.
pub(crate) fn print(json: bool, result: &(impl Serialize + fmt::Display)) -> Result<(), CliError> {
    stdout(|out| {
        if json {
            serde_json::to_writer(&mut *out, result)?;
            writeln!(out)
        } else {
            write!(out, "{result}")
        }
    })
}

/// Lets `write` write to standard output.
pub(crate) fn stdout(
    write: impl FnOnce(&mut BufWriter<std::io::StdoutLock<'static>>) -> std::io::Result<()>,
) -> Result<(), CliError> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    write(&mut out).and_then(|()| out.flush()).map_err(CliError::Print)
}

/// Writes a file as a whole.
pub(crate) fn save(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    tracing::debug!("writing {} bytes to {}", bytes.len(), path.display());
    Ok(atomic_write(path, bytes)?)
}

/// Refuses an output that is the input: a slip that would destroy what the output is made from.
pub(crate) fn refuse_same(input: &Path, output: &Path) -> Result<(), CliError> {
    let same = match (input.canonicalize(), output.canonicalize()) {
        (Ok(a), Ok(b)) => a == b && a.is_file(),
        _ => false,
    };
    if same { Err(CliError::SameFile(output.to_owned())) } else { Ok(()) }
}

/// A share as a percentage, with as many digits as small shares need.
pub(crate) fn percent(share: f64) -> String {
    let digits = if share > 0.0 && share < 0.01 { 3 } else { 1 };
    format!("{:.*} %", digits, 100.0 * share)
}

/// A number of bytes, rounded for the eye.
pub(crate) fn bytes(n: u64) -> String {
    match n {
        0..=9_999 => format!("{n} bytes"),
        10_000..=9_999_999 => format!("{:.1} KiB", n as f64 / 1024.0),
        _ => format!("{:.1} MiB", n as f64 / (1024.0 * 1024.0)),
    }
}

/// A duration, rounded for the eye.
pub(crate) fn seconds(time: std::time::Duration) -> String {
    match time.as_secs_f64() {
        s if s < 0.01 => format!("{:.2} ms", s * 1e3),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

/// A number with its noun, in the plural unless it is one.
pub(crate) fn count(n: impl Into<u64>, noun: &str) -> String {
    match n.into() {
        1 => format!("1 {noun}"),
        n => format!("{n} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn numbers_are_rounded_for_the_eye() {
        assert_eq!([percent(0.5), percent(0.001_234), percent(0.0)], ["50.0 %", "0.123 %", "0.0 %"]);
        assert_eq!([bytes(9_999), bytes(10_240), bytes(20 << 20)], ["9999 bytes", "10.0 KiB", "20.0 MiB"]);
        let times = [1_500, 250_000, 2_500_000].map(|us| seconds(Duration::from_micros(us)));
        assert_eq!(times, ["1.50 ms", "250 ms", "2.50 s"]);
        assert_eq!([count(0u64, "cell"), count(1u64, "cell"), count(2u64, "cell")], ["0 cells", "1 cell", "2 cells"]);
    }
}
