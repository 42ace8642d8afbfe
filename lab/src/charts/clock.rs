//! What something takes: by the clock, or, where it takes long, in processor time, so that others who use the machine count
//! less.

use std::time::{Duration, Instant};

/// Runs that take less than this by the clock are measured by it, in seconds; the system counts processor time in steps
/// of a hundredth of a second, which is 1 % of this.
pub(crate) const SHORT: f64 = 1.0;

/// What something gives, and the seconds that it took: by the clock below [`SHORT`], else the processor time of the whole
/// process if that is less. Nothing else may run in the process meanwhile.
pub(crate) fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let start = Start::now();
    let value = run();
    let by_clock = start.clock.elapsed().as_secs_f64();
    (value, if by_clock < SHORT { by_clock } else { start.worked().min(by_clock) })
}

/// When something began.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    clock: Instant,
    ticks: Option<u64>,
}

impl Start {
    pub(crate) fn now() -> Self {
        Self { clock: Instant::now(), ticks: processor_ticks() }
    }

    /// Seconds of processor time since; by the clock where the system does not tell.
    fn worked(&self) -> f64 {
        let ticks = self.ticks.zip(processor_ticks()).map(|(before, now)| now.saturating_sub(before));
        ticks.map_or_else(|| self.clock.elapsed().as_secs_f64(), |ticks| ticks as f64 / 100.0)
    }

    /// Whether the process has worked for longer than `limit` since. Quick as long as the clock says no.
    pub(crate) fn is_over(&self, limit: Duration) -> bool {
        self.clock.elapsed() > limit && self.worked() >= limit.as_secs_f64()
    }
}

/// Processor time of this process so far, of threads that have ended too, in hundredths of a second; of Linux.
fn processor_ticks() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program stands in parentheses and may hold anything.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |k: usize| fields.get(k)?.parse::<u64>().ok();
    Some(ticks(11)? + ticks(12)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_runs_count_what_they_work() {
        let (_, asleep) = timed(|| std::thread::sleep(Duration::from_millis(30)));
        assert!((0.03..SHORT).contains(&asleep), "short ones are by the clock: {asleep}");
        let (start, mut x) = (Start::now(), 1u64);
        assert!(!start.is_over(Duration::from_secs(3600)));
        while !start.is_over(Duration::from_millis(30)) {
            x = std::hint::black_box(x.wrapping_mul(3));
        }
        assert!((0.03..60.0).contains(&start.worked()), "{} s of work", start.worked());
    }
}
