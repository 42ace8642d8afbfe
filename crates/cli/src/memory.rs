//! How much memory the program uses, and may use.

use crate::error::Result;
use crate::interrupt;
use crate::output::bytes;
use std::fmt;
use std::time::Duration;

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

    /// Looks at the memory in use from here on, again and again, and ends the work under way if it is too much.
    pub(crate) fn watch(self) {
        let Some(Size(limit)) = self.memory else { return };
        if resident_bytes().is_none() {
            tracing::warn!("--memory: this system does not report how much memory is used; only estimates count");
            return;
        }
        let look = move || {
            loop {
                if let Some(used) = resident_bytes().filter(|used| *used > limit) {
                    interrupt::request_for_memory(used, limit);
                    return;
                }
                std::thread::sleep(LOOK);
            }
        };
        // Without another thread, estimates count.
        if let Err(error) = std::thread::Builder::new().name("memory".to_owned()).spawn(look) {
            tracing::warn!("--memory: the memory in use cannot be looked at: {error}");
        }
    }

    /// As many of the threads as there is room for: 0 stands for one for each core. All of them, if nothing is known of what they need.
    ///
    /// # Errors
    /// [`TooLarge`] if there is no room even for one.
    pub(crate) fn threads(self, threads: usize, needs: Needs) -> Result<usize, TooLarge> {
        let Some(Size(limit)) = self.memory.filter(|_| needs != Needs::default()) else { return Ok(threads) };
        let wanted = match threads {
            0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            n => n,
        };
        let fixed = resident_bytes().unwrap_or(0).saturating_add(needs.shared);
        let with = |n: usize| fixed.saturating_add(needs.per_thread.saturating_mul(n as u64));
        if with(wanted) <= limit {
            return Ok(threads);
        }
        let n = limit.saturating_sub(fixed).checked_div(needs.per_thread).unwrap_or(0);
        let n = usize::try_from(n).unwrap_or(usize::MAX).min(wanted);
        if n == 0 || with(n) > limit {
            interrupt::forget_memory();
            return Err(TooLarge { needed: with(1), limit });
        }
        tracing::warn!("--memory: {n} of {wanted} threads, for which there is room in {}", bytes(limit));
        Ok(n)
    }

    /// Whether there is room for that with one thread.
    pub(crate) fn has_room(self, needs: Needs) -> bool {
        let used = resident_bytes().unwrap_or(0);
        let all = used.saturating_add(needs.shared).saturating_add(needs.per_thread);
        self.memory.is_none_or(|Size(limit)| all <= limit)
    }
}

/// Time between two looks at the memory in use.
const LOOK: Duration = Duration::from_millis(20);

/// The memory that is known to be needed beside what is in use already, in bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Needs {
    /// Whatever the number of threads is.
    pub(crate) shared: u64,
    /// For each thread.
    pub(crate) per_thread: u64,
}

impl Needs {
    /// Of so many tables of bits with so many rows and columns, as well.
    #[must_use]
    pub(crate) fn and_bits(self, n_tables: u64, n_rows: u64, n_columns: u64) -> Self {
        // Rows begin with a word.
        let table = n_columns.div_ceil(64).saturating_mul(8).saturating_mul(n_rows);
        Self { shared: self.shared.saturating_add(table.saturating_mul(n_tables)), ..self }
    }
}

/// Not enough memory for what is to be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("--memory {}: with one thread this needs about {} at least", bytes(*limit), bytes(*needed))]
pub(crate) struct TooLarge {
    pub(crate) needed: u64,
    pub(crate) limit: u64,
}

/// The most bytes of memory that were in use at once so far; `None` where the system does not report it.
pub(crate) fn peak_bytes() -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The bytes of memory in use; `None` where the system does not report it.
pub(crate) fn resident_bytes() -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Finds a line such as `VmHWM:   1234 kB`.
fn parse(status: &str, name: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_found() {
        let peak = |text| parse(text, "VmHWM:");
        assert_eq!(peak("VmPeak:\t 9 kB\nVmHWM:\t    5120 kB\nThreads:\t1\n"), Some(5 << 20));
        assert_eq!(peak("VmRSS:\t 9 kB\n"), None);
        assert_eq!(peak("VmHWM:\t 99999999999999999999 kB\n"), None);
        assert_eq!(resident_bytes().is_some(), cfg!(target_os = "linux"));
    }

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

    #[test]
    fn there_are_as_many_threads_as_there_is_room_for() {
        let used = resident_bytes().unwrap_or(0);
        let memory = |n: u64| MemoryArgs::of(Some(Size(used + n)));
        let needs = Needs { shared: 1 << 40, per_thread: 1 << 40 };
        // What this program uses changes a little: half of what a thread needs is to spare.
        let of = |n: u64, threads| memory((n << 40) + (1 << 39)).threads(threads, needs);
        assert_eq!([of(5, 4), of(10, 4), of(4, 4), of(9, 9)].map(Result::ok), [Some(4), Some(4), Some(3), Some(8)]);
        assert!(of(1, 4).is_err() && !memory(1 << 40).has_room(needs) && memory(3 << 40).has_room(needs));
        assert_eq!(MemoryArgs::of(None).threads(7, needs), Ok(7));
        let error = TooLarge { needed: 3 << 30, limit: 1 << 30 }.to_string();
        assert_eq!(error, "--memory 1024.0 MiB: with one thread this needs about 3072.0 MiB at least");
        assert_eq!(Needs::default().and_bits(2, 3, 65).shared, 2 * 3 * 16);
    }
}
