//! Processor time, which other programs on the machine do not lengthen.

use std::time::{Duration, Instant};

/// A clock of the processor time of this thread; of the time on the wall where the system does not tell it.
#[derive(Debug, Clone, Copy)]
pub struct CpuClock {
    wall: Instant,
    cpu: Option<Duration>,
}

/// Processor time of this thread so far; Linux only.
fn thread_time() -> Option<Duration> {
    // The system adds up when a thread gives way.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}

impl CpuClock {
    /// Starts now.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: thread_time() }
    }

    /// Since the start, on the thread that started it.
    pub fn elapsed(&self) -> Duration {
        match (self.cpu, thread_time()) {
            (Some(start), Some(now)) => now - start,
            _ => self.wall.elapsed(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_takes_no_processor_time() {
        let clock = CpuClock::start();
        std::thread::sleep(Duration::from_millis(50));
        if clock.cpu.is_some() {
            assert!(clock.elapsed() < Duration::from_millis(40));
        }
    }
}
