//! What something takes: time by the clock, processor time, which other programs on the machine do not lengthen, and memory.
//! Of Linux; elsewhere the time by the clock counts, and memory is not known.

use std::time::{Duration, Instant};

/// Whose processor time is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// That of the thread that asks; exact to microseconds.
    Thread,
    /// That of all threads of this process that live. Of the thread that asks it is exact to microseconds, of others to some
    /// milliseconds: the system adds up when a thread gives way.
    Threads,
    /// That of this process, of threads that have ended too; in steps of a hundredth of a second.
    Process,
    /// That of all ended children of this process, and theirs; in such steps too.
    Children,
}

impl Work {
    /// Its processor time so far.
    fn so_far(self) -> Option<Duration> {
        match self {
            Self::Thread => {
                std::thread::yield_now();
                nanoseconds(&std::fs::read_to_string("/proc/thread-self/schedstat").ok()?)
            }
            Self::Threads => {
                std::thread::yield_now();
                let tasks = std::fs::read_dir("/proc/self/task").ok()?.collect::<Result<Vec<_>, _>>().ok()?;
                // A thread may end while it is looked at.
                let texts = tasks.iter().filter_map(|task| std::fs::read_to_string(task.path().join("schedstat")).ok());
                let sum: Duration = texts.map(|text| nanoseconds(&text)).sum::<Option<_>>()?;
                (!sum.is_zero()).then_some(sum)
            }
            Self::Process => hundredths(11),
            Self::Children => hundredths(13),
        }
    }
}

fn nanoseconds(schedstat: &str) -> Option<Duration> {
    Some(Duration::from_nanos(schedstat.split_whitespace().next()?.parse().ok()?))
}

/// The sum of two fields of what the system says of this process, user and system time.
fn hundredths(first: usize) -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program stands in parentheses and may hold anything.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |k: usize| fields.get(k)?.parse::<u64>().ok();
    Some(Duration::from_millis(10 * (ticks(first)? + ticks(first + 1)?)))
}

/// A clock of processor time; of the time on the wall where the system does not tell it.
#[derive(Debug, Clone, Copy)]
pub struct CpuClock {
    of: Work,
    wall: Instant,
    cpu: Option<Duration>,
}

impl CpuClock {
    /// Starts now.
    pub fn start(of: Work) -> Self {
        Self { of, wall: Instant::now(), cpu: of.so_far() }
    }

    /// Since the start; of a thread, on the one that started it.
    pub fn elapsed(&self) -> Duration {
        let cpu = self.cpu.zip(self.of.so_far()).map(|(before, now)| now.saturating_sub(before));
        cpu.unwrap_or_else(|| self.wall())
    }

    /// Since the start, on the wall.
    pub fn wall(&self) -> Duration {
        self.wall.elapsed()
    }

    /// Whether there was work for longer than `limit` since the start. Quick as long as the wall says no.
    pub fn is_over(&self, limit: Duration) -> bool {
        self.wall() > limit && self.elapsed() >= limit
    }
}

/// Runs that take less than this by the clock are measured by it, in seconds: the system counts the time of processes in steps of 1 % of this.
pub const SHORT: f64 = 1.0;

/// What something gives, and the seconds that it took: by the clock below [`SHORT`], else the processor time of the whole
/// process if that is less. Nothing else may run in the process meanwhile.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let clock = CpuClock::start(Work::Process);
    let value = run();
    let by_clock = clock.wall().as_secs_f64();
    (value, if by_clock < SHORT { by_clock } else { clock.elapsed().as_secs_f64().min(by_clock) })
}

/// What something gives, the seconds of the quickest of up to `most` runs, and of how many. Those of [`SHORT`] and more are not repeated.
pub fn quickest<T>(most: u32, mut run: impl FnMut() -> T) -> (T, f64, u32) {
    let (mut value, mut seconds) = timed(&mut run);
    let mut repeats = 1;
    while repeats < most && seconds < SHORT {
        let (again, time) = timed(&mut run);
        (value, seconds) = (again, seconds.min(time));
        repeats += 1;
    }
    (value, seconds, repeats)
}

/// The number in the middle, the larger of two; none of none.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_unstable_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

/// A line such as `VmHWM:   1234 kB` of what the system says about a process, in bytes.
pub fn memory_of(process: &str, key: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The most memory that this process had in use, in bytes; 0 where the system does not tell.
pub fn peak() -> u64 {
    memory_of("self", "VmHWM:").unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_takes_no_processor_time() {
        let clock = CpuClock::start(Work::Thread);
        std::thread::sleep(Duration::from_millis(50));
        if clock.cpu.is_some() {
            assert!(clock.elapsed() < Duration::from_millis(40) && clock.wall() >= Duration::from_millis(50));
        }
    }

    #[test]
    fn long_runs_count_what_they_work() {
        let (_, asleep) = timed(|| std::thread::sleep(Duration::from_millis(30)));
        assert!((0.03..SHORT).contains(&asleep), "short ones are by the clock: {asleep}");
        for of in [Work::Thread, Work::Threads, Work::Process] {
            let (clock, mut x) = (CpuClock::start(of), 1u64);
            assert!(!clock.is_over(Duration::from_secs(3600)));
            while !clock.is_over(Duration::from_millis(30)) {
                x = std::hint::black_box(x.wrapping_mul(3));
            }
            assert!((0.03..60.0).contains(&clock.elapsed().as_secs_f64()), "{of:?}: {:?} of work", clock.elapsed());
        }
    }

    #[test]
    fn the_middle_is_found() {
        assert_eq!((median(vec![3.0, 1.0, 2.0]), median(vec![2.0, 1.0]), median(vec![]).is_nan()), (2.0, 2.0, true));
        let mut n = 0;
        let (last, _, repeats) = quickest(3, || {
            n += 1;
            n
        });
        assert_eq!((last, repeats), (3, 3));
    }
}
