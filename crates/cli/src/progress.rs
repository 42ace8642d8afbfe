//! A bar on standard error while something takes long, if a person is there to see it.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// A bar that is told how much of how much is done.
#[derive(Debug)]
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar for `what`; an invisible one if `show` is false or standard error is no terminal.
    pub(crate) fn new(what: &'static str, show: bool) -> Self {
        Self::with_template(what, show, "{msg} {wide_bar} {pos}/{len} {eta}")
    }

    fn with_template(what: &'static str, show: bool, template: &str) -> Self {
        let visible = show && std::io::stderr().is_terminal();
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what);
        Self(bar)
    }

    /// `done` of `all` are done; from any thread.
    pub(crate) fn set(&self, done: usize, all: usize) {
        self.0.set_length(all as u64);
        self.0.set_position(done as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A bar that is told which share is done, of something that may have been begun by an earlier run.
#[derive(Debug)]
pub(crate) struct ShareBar {
    bar: Bar,
    pace: Option<Pace>,
}

impl ShareBar {
    /// Steps of the bar.
    const STEPS: u64 = 1000;

    pub(crate) fn new(what: &'static str, show: bool) -> Self {
        let bar = Bar::with_template(what, show, "{prefix} {wide_bar} {percent} % {msg}");
        bar.0.set_prefix(what);
        bar.0.set_message("");
        bar.0.set_length(Self::STEPS);
        Self { bar, pace: None }
    }

    /// The share that is done, from 0 to 1. The first that is told was done before.
    pub(crate) fn set(&mut self, share: f64) {
        let now = Instant::now();
        let pace = self.pace.get_or_insert(Pace { since: now, before: share });
        let left = pace.left(share, now - pace.since);
        self.bar.0.set_position((share.clamp(0.0, 1.0) * Self::STEPS as f64) as u64);
        self.bar.0.set_message(left.map_or_else(String::new, |left| format!("about {} left", rough(left))));
    }
}

/// How quickly shares get done, in this run.
#[derive(Debug, Clone, Copy)]
struct Pace {
    since: Instant,
    /// The share that was done before this run.
    before: f64,
}

impl Pace {
    /// The time left if the rest goes as what was done in this run; `None` until there is something to tell from.
    fn left(self, share: f64, elapsed: Duration) -> Option<Duration> {
        let done = share - self.before;
        let left = elapsed.as_secs_f64() * (1.0 - share) / done;
        if done > 0.0 { Duration::try_from_secs_f64(left.max(0.0)).ok() } else { None }
    }
}

/// A duration as an estimate is worth telling.
fn rough(time: Duration) -> String {
    match time.as_secs() {
        s @ 0..90 => format!("{s} s"),
        s @ 90..5400 => format!("{} min", (s + 30) / 60),
        s => format!("{:.1} h", s as f64 / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_from_this_run() {
        let left = |before: f64, share: f64, seconds: u64| {
            let pace = Pace { since: Instant::now(), before };
            pace.left(share, Duration::from_secs(seconds)).map(|left| left.as_secs_f64())
        };
        assert_eq!(left(0.0, 0.25, 10), Some(30.0));
        // What an earlier run did took no time of this one.
        assert_eq!(left(0.5, 0.75, 10), Some(10.0));
        assert_eq!(left(0.0, 1.0, 10), Some(0.0));
        assert_eq!([left(0.5, 0.5, 10), left(0.5, 0.4, 10), left(0.0, f64::NAN, 10)], [None; 3]);
        assert_eq!([left(0.0, 1e-300, 10), left(0.0, 1.5, 10)], [None, Some(0.0)]);
    }

    #[test]
    fn estimates_are_rough() {
        let text = |s: u64| rough(Duration::from_secs(s));
        assert_eq!([text(0), text(89), text(90), text(3601), text(5400)], ["0 s", "89 s", "2 min", "60 min", "1.5 h"]);
    }
}
