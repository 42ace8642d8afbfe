//! How much memory the program has used.

/// The most bytes of memory that were in use at once so far; `None` where the system does not report it.
pub(crate) fn peak_bytes() -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// Finds the line `VmHWM:   1234 kB`.
fn parse(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_found() {
        assert_eq!(parse("VmPeak:\t 9 kB\nVmHWM:\t    5120 kB\nThreads:\t1\n"), Some(5 << 20));
        assert_eq!(parse("VmRSS:\t 9 kB\n"), None);
        assert_eq!(parse("VmHWM:\t 99999999999999999999 kB\n"), None);
    }
}
