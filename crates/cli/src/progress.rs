//! Progress on standard error: a bar in a terminal, else a line every few seconds.

use crate::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sightlines::progress::words::rough;
use sightlines::progress::{Observer, Pace, Progress};
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The environment variable with the seconds between two lines of progress where there is no terminal; 0 is as often as there is news.
pub(crate) const SECONDS: &str = "SIGHTLINES_PROGRESS_SECONDS";

/// Those seconds, unless the variable is set. A run that is over sooner prints no line.
const USUAL: Duration = Duration::from_secs(5);

/// A bar with the finished share of a search, which an earlier run may have begun, and the time left. An observer that cancels
/// what is under way once the program is interrupted.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    what: &'static str,
    shown: Mutex<Shown>,
}

/// What was shown last.
#[derive(Debug)]
struct Shown {
    pace: Option<Pace>,
    /// Of lines; none where there is a bar, or nothing is to be shown.
    lines: Option<Lines>,
}

/// When lines are due.
#[derive(Debug, Clone, Copy)]
struct Lines {
    every: Duration,
    last: Instant,
    /// The share of the last line, and its phase.
    share: f64,
    phase: &'static str,
}

impl Lines {
    /// From now on, as the environment has it.
    fn begin() -> Self {
        let every = std::env::var(SECONDS).ok().and_then(|text| crate::numbers::duration(&text).ok());
        Self { every: every.unwrap_or(USUAL), last: Instant::now(), share: 0.0, phase: "" }
    }

    /// Whether a line is due; if so, it counts as printed. A report that another thread has overtaken is not.
    fn is_due(&mut self, Progress { phase, share, .. }: Progress, now: Instant) -> bool {
        let is_late = phase == self.phase && share < self.share;
        let is_due = now.saturating_duration_since(self.last) >= self.every && !is_late;
        if is_due {
            (self.last, self.share, self.phase) = (now, share, phase);
        }
        is_due
    }
}

impl Bar {
    /// Steps of the bar.
    const STEPS: u64 = 1000;

    /// A bar for `what`, or lines if standard error is no terminal; nothing of either if `show` is false.
    pub(crate) fn new(what: &'static str, show: bool) -> Self {
        let visible = show && std::io::stderr().is_terminal();
        let lines = (show && !visible).then(Lines::begin);
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar} {percent} % {msg}") {
            bar.set_style(style);
        }
        bar.set_prefix(what);
        bar.set_length(Self::STEPS);
        Self { bar, what, shown: Mutex::new(Shown { pace: None, lines }) }
    }

    /// `done` of `all` are done; from any thread.
    pub(crate) fn set(&self, done: usize, all: usize) {
        self.show(Progress::new("", done as u64, all as u64));
    }

    /// Prints a line above the bar, whether that is visible or not.
    pub(crate) fn say(&self, line: &str) {
        // Nothing is left to do if standard error is closed.
        self.bar.suspend(|| drop(writeln!(std::io::stderr(), "{line}")));
    }

    /// Removes it from the screen.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self, progress: Progress) {
        let now = Instant::now();
        let Progress { share, phase, .. } = progress;
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        let pace = Pace::after(shown.pace, progress, now);
        shown.pace = Some(pace);
        let left = pace.left(progress, pace.took(now)).map(|left| format!("about {} left", rough(left)));
        if shown.lines.as_mut().is_some_and(|lines| lines.is_due(progress, now)) {
            self.say(&line(self.what, share, phase, left.as_deref()));
        }
        let left = left.unwrap_or_default();
        self.bar.set_position((share.clamp(0.0, 1.0) * Self::STEPS as f64) as u64);
        self.bar.set_message(if phase.is_empty() { left } else { format!("{phase} {left}") });
    }
}

/// A line of progress: `visibility of clusters: 42 %, beams, about 10 s left`.
fn line(what: &str, share: f64, phase: &str, left: Option<&str>) -> String {
    let percent = format!("{:.0} %", 100.0 * share.clamp(0.0, 1.0));
    let parts: Vec<&str> = [&percent, phase].into_iter().chain(left).filter(|part| !part.is_empty()).collect();
    format!("{what}: {}", parts.join(", "))
}

impl Observer for Bar {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.show(progress);
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_every_few_seconds() {
        let start = Instant::now();
        let mut lines = Lines { every: Duration::from_secs(5), last: start, share: 0.0, phase: "" };
        let mut due_of = |phase, share, s| {
            lines.is_due(Progress::new(phase, 0, 0).with_share(share), start + Duration::from_secs(s))
        };
        let due = [0, 4, 5, 6, 9, 10, 30, 34, 35].map(|s| due_of("beams", 0.5, s));
        assert_eq!(due, [false, false, true, false, false, true, true, false, true]);
        assert_eq!([due_of("beams", 0.4, 50), due_of("pairs", 0.1, 50)], [false, true], "another thread was ahead");
        assert_eq!(line("lines", 0.421, "beams", Some("about 9 s left")), "lines: 42 %, beams, about 9 s left");
        assert_eq!(
            [line("lines", 1.5, "", None), line("lines", 0.0, "beams", None)],
            ["lines: 100 %", "lines: 0 %, beams"]
        );
    }
}
