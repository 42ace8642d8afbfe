//! How fast a search goes.

use crate::Progress;
use std::time::{Duration, Instant};

/// The pace of a run in a phase, for estimates of the time that is left. Whoever has a clock names the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    phase: &'static str,
    since: Instant,
    /// The share that was done before this run.
    before: f64,
}

impl Pace {
    /// The pace in the phase of a report, after that of earlier ones. The first report of each phase gives the share that was done before.
    #[must_use]
    pub fn after(last: Option<Self>, Progress { phase, share, .. }: Progress, now: Instant) -> Self {
        last.filter(|last| last.phase == phase).unwrap_or(Self { phase, since: now, before: share })
    }

    /// The time since the first report of the phase.
    pub fn took(self, now: Instant) -> Duration {
        now.saturating_duration_since(self.since)
    }

    /// The time left if the rest proceeds at the pace of this run; `None` until there is something to estimate it from. What came from a store took no time.
    pub fn left(self, Progress { share, kept, .. }: Progress, elapsed: Duration) -> Option<Duration> {
        let done = share - self.before.max(kept);
        let left = elapsed.as_secs_f64() * (1.0 - share) / done;
        if done > 0.0 { Duration::try_from_secs_f64(left.max(0.0)).ok() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_estimated_from_this_run() {
        let left_with = |before: f64, kept: f64, share: f64, seconds: u64| {
            let pace = Pace { phase: "", since: Instant::now(), before };
            let progress = Progress::new("", 0, 1).with_share(share).with_kept(kept);
            pace.left(progress, Duration::from_secs(seconds)).map(|left| left.as_secs_f64())
        };
        let left = |before: f64, share: f64, seconds: u64| left_with(before, 0.0, share, seconds);
        assert_eq!([left_with(0.0, 0.5, 0.75, 10), left_with(0.5, 0.25, 0.75, 10)], [Some(10.0); 2]);
        assert_eq!(left(0.0, 0.25, 10), Some(30.0));
        // What an earlier run did took no time of this one.
        assert_eq!(left(0.5, 0.75, 10), Some(10.0));
        assert_eq!(left(0.0, 1.0, 10), Some(0.0));
        assert_eq!([left(0.5, 0.5, 10), left(0.5, 0.4, 10), left(0.0, f64::NAN, 10)], [None; 3]);
        assert_eq!([left(0.0, 1e-300, 10), left(0.0, 1.5, 10)], [None, Some(0.0)]);
    }
}
