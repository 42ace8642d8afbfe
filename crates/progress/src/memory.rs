//! How much memory a process uses and may use, and what a work needs.

use std::time::Duration;
use std::{fs, io, thread};

/// Time between two looks at the memory in use.
const LOOK: Duration = Duration::from_millis(20);

/// The memory that is known to be needed beside what is in use already, in bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Whatever the number of threads is.
    pub shared: u64,
    /// For each thread.
    pub per_thread: u64,
}

impl Needs {
    /// Of so many tables of bits with so many rows and columns, as well.
    #[must_use]
    pub fn and_bits(self, n_tables: u64, n_rows: u64, n_columns: u64) -> Self {
        // Rows begin with a word.
        let table = n_columns.div_ceil(64).saturating_mul(8).saturating_mul(n_rows);
        Self { shared: self.shared.saturating_add(table.saturating_mul(n_tables)), ..self }
    }

    /// With so many threads.
    pub fn with_threads(self, n: usize) -> u64 {
        self.shared.saturating_add(self.per_thread.saturating_mul(n as u64))
    }
}

/// A number of bytes as people write it: `2GiB`, `800MB`, or a plain number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemorySize(pub u64);

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

impl std::str::FromStr for MemorySize {
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

/// Not enough memory for what is to be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("with one thread this needs about {needed} bytes of memory at least, and {limit} may be used")]
pub struct TooLarge {
    /// In bytes, with what is in use already.
    pub needed: u64,
    /// In bytes.
    pub limit: u64,
}

/// The bytes of memory that a process may use, by what it needs and by what the system reports; `None` for no limit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MemoryBudget(pub Option<u64>);

impl MemoryBudget {
    /// As many of the threads as there is room for: 0 stands for [one for each core](n_threads), and is returned if there is room for all. All of them
    /// if nothing is known of what they need.
    ///
    /// # Errors
    /// [`TooLarge`] if there is no room even for one.
    pub fn threads(self, threads: usize, needs: Needs) -> Result<usize, TooLarge> {
        let Some(limit) = self.0.filter(|_| needs != Needs::default()) else { return Ok(threads) };
        let (wanted, used) = (n_threads(threads), resident_bytes().unwrap_or(0));
        let with = |n: usize| used.saturating_add(needs.with_threads(n));
        if with(wanted) <= limit {
            return Ok(threads);
        }
        let n = limit.saturating_sub(with(0)).checked_div(needs.per_thread).unwrap_or(0);
        let n = usize::try_from(n).unwrap_or(usize::MAX).min(wanted);
        if n == 0 || with(n) > limit { Err(TooLarge { needed: with(1), limit }) } else { Ok(n) }
    }

    /// Whether there is room for that with one thread.
    pub fn has_room(self, needs: Needs) -> bool {
        let all = resident_bytes().unwrap_or(0).saturating_add(needs.with_threads(1));
        self.0.is_none_or(|limit| all <= limit)
    }

    /// Looks at the memory in use from here on, every 20 ms on a thread of its own. Calls `exceeded` with what is in use and the limit, once it is more.
    ///
    /// # Errors
    /// A system that does not report it, or has no room for a thread: then nothing is watched, and estimates count alone.
    pub fn watch(self, exceeded: impl FnOnce(u64, u64) + Send + 'static) -> io::Result<()> {
        let Some(limit) = self.0 else { return Ok(()) };
        let unknown = "this system does not report how much memory is used; only estimates count";
        resident_bytes().ok_or_else(|| io::Error::new(io::ErrorKind::Unsupported, unknown))?;
        let look = move || {
            loop {
                if let Some(used) = resident_bytes().filter(|used| *used > limit) {
                    return exceeded(used, limit);
                }
                thread::sleep(LOOK);
            }
        };
        thread::Builder::new().name("memory".to_owned()).spawn(look)?;
        Ok(())
    }
}

/// How many threads that are: 0 stands for one for each core.
pub fn n_threads(threads: usize) -> usize {
    if threads == 0 { thread::available_parallelism().map_or(1, usize::from) } else { threads }
}

/// The most bytes of memory that were in use at once so far; `None` where the system does not report it.
pub fn peak_bytes() -> Option<u64> {
    parse(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// The bytes of memory in use; `None` where the system does not report it.
pub fn resident_bytes() -> Option<u64> {
    parse(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
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
    fn sizes_have_units() {
        let size = |text: &str| text.parse::<MemorySize>().map(|size| size.0);
        for (text, n) in [("2GiB", 2 << 30), ("800MB", 800_000_000), ("1.5 kib", 1536), ("77", 77), ("9b", 9)] {
            assert_eq!(size(text), Ok(n), "{text}");
        }
        for text in ["", "GiB", "-1", "0", "1 Gi", "nan", "inf", "1e30"] {
            assert_eq!(size(text), Err("not a size such as 2GiB, 800MB or a number of bytes".to_owned()), "{text}");
        }
    }

    #[test]
    fn the_peak_is_found() {
        let peak = |text| parse(text, "VmHWM:");
        assert_eq!(peak("VmPeak:\t 9 kB\nVmHWM:\t    5120 kB\nThreads:\t1\n"), Some(5 << 20));
        assert_eq!(peak("VmRSS:\t 9 kB\n"), None);
        assert_eq!(peak("VmHWM:\t 99999999999999999999 kB\n"), None);
        assert_eq!(resident_bytes().is_some(), cfg!(target_os = "linux"));
    }

    #[test]
    fn there_are_as_many_threads_as_there_is_room_for() {
        let used = resident_bytes().unwrap_or(0);
        let memory = |n: u64| MemoryBudget(Some(used + n));
        let needs = Needs { shared: 1 << 40, per_thread: 1 << 40 };
        // What this program uses changes a little: half of what a thread needs is to spare.
        let of = |n: u64, threads| memory((n << 40) + (1 << 39)).threads(threads, needs);
        assert_eq!([of(5, 4), of(10, 4), of(4, 4), of(9, 9)], [Ok(4), Ok(4), Ok(3), Ok(8)]);
        assert!(of(1, 4).is_err() && !memory(1 << 40).has_room(needs) && memory(3 << 40).has_room(needs));
        assert_eq!((MemoryBudget(None).threads(7, needs), n_threads(7)), (Ok(7), 7));
        assert_eq!(Needs::default().and_bits(2, 3, 65).shared, 2 * 3 * 16);
    }

    #[test]
    fn too_much_is_noticed() {
        let (sender, receiver) = std::sync::mpsc::channel();
        let watched =
            MemoryBudget(Some(1)).watch(move |used, limit| sender.send((used, limit)).expect("it is awaited"));
        assert_eq!(watched.is_ok(), cfg!(target_os = "linux"));
        assert!(watched.is_err() || receiver.recv().is_ok_and(|(used, limit)| used > limit && limit == 1));
        assert!(MemoryBudget(None).watch(|_, _| unreachable!("there is no limit")).is_ok());
    }
}
