//! How much memory the program may use.

use crate::error::{Result, anyhow};
use crate::interrupt;
use crate::output::bytes;
use sightlines::progress::memory::{MemoryBudget, Needs, TooLarge, n_threads};
use std::fmt;
use std::io::ErrorKind;

/// A number of bytes as an argument: `2GiB`, `800MB`, or a plain number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Size(pub(crate) u64);

/// Units of sizes; longer names first.
const UNITS: [(&str, u64); 9] = [
    ("kib", 1 << 10),
    ("mib", 1 << 20),
    ("gib", 1 << 30),
    ("tib", 1 << 40),
    ("kb", 1_000),
    ("mb", 1_000_000),
    ("gb", 1_000_000_000),
    ("tb", 1_000_000_000_000),
    ("b", 1),
];

impl std::str::FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || "not a size such as 2GiB, 800MB or a number of bytes".to_owned();
        let lower = text.trim().to_ascii_lowercase();
        let found = UNITS.iter().find_map(|(name, unit)| Some((lower.strip_suffix(name)?, *unit)));
        let (number, unit) = found.unwrap_or((&lower, 1));
        let n = number.trim().parse::<f64>().map_err(|_| wrong())? * unit as f64;
        // Beyond 2^53 bytes nothing is exact, nor does it matter.
        if n.is_finite() && (1.0..9e15).contains(&n) { Ok(Self(n as u64)) } else { Err(wrong()) }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&bytes(self.0))
    }
}

/// The memory that a command may use.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub(crate) struct MemoryArgs {
    /// Memory that the program may use, such as 2GiB or 800MB. What is known to need more is refused before the work, or done with fewer threads; if more is
    /// used after all, the work is stopped so that --resume can go on with more memory or fewer threads; exit code 4
    #[arg(long, help_heading = "Method", value_name = "SIZE")]
    memory: Option<Size>,
}

impl MemoryArgs {
    /// A budget of so much.
    pub(crate) fn of(memory: Option<Size>) -> Self {
        Self { memory }
    }

    /// This budget, or another if it is none.
    #[must_use]
    pub(crate) fn or(self, other: Self) -> Self {
        Self { memory: self.memory.or(other.memory) }
    }

    fn budget(self) -> MemoryBudget {
        MemoryBudget(self.memory.map(|Size(limit)| limit))
    }

    /// Looks at the memory in use from here on, again and again, and ends the work under way if it is too much.
    pub(crate) fn watch(self) {
        if let Err(error) = self.budget().watch(interrupt::request_for_memory) {
            let about =
                if error.kind() == ErrorKind::Unsupported { "" } else { "the memory in use cannot be looked at: " };
            tracing::warn!("--memory: {about}{error}");
        }
    }

    /// As many of the threads as there is room for: 0 stands for one for each core.
    pub(crate) fn threads(self, threads: usize, needs: Needs) -> Result<usize> {
        let n = self.budget().threads(threads, needs).map_err(|TooLarge { needed, limit }| {
            interrupt::forget_memory();
            anyhow!("--memory {}: with one thread this needs about {} at least", bytes(limit), bytes(needed))
        })?;
        if let Some(limit) = self.memory.filter(|_| n != threads) {
            tracing::warn!("--memory: {n} of {} threads, for which there is room in {limit}", n_threads(threads));
        }
        Ok(n)
    }

    /// Whether there is room for that with one thread.
    pub(crate) fn has_room(self, needs: Needs) -> bool {
        self.budget().has_room(needs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        let size = |text: &str| text.parse::<Size>().map(|size| size.0);
        for (text, n) in [("2GiB", 2 << 30), ("800MB", 800_000_000), ("1.5 kib", 1536), ("77", 77), ("9b", 9)] {
            assert_eq!(size(text), Ok(n), "{text}");
        }
        for text in ["", "GiB", "-1", "0", "1 Gi", "nan", "inf", "1e30"] {
            assert_eq!(size(text), Err("not a size such as 2GiB, 800MB or a number of bytes".to_owned()), "{text}");
        }
    }
}
