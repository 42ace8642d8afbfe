#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the [`Observer`] trait, its reports ([`Progress`]) and kinds of work ([`Work`]), the error of a cancelled search ([`Cancelled`]), and
//!   the counter that threads of a search share ([`Counter`]), what a search may spend ([`Budget`]), and the contract of stores that keep the
//!   results of units of work ([`UnitStore`]).
//! - **Out of scope**: time, terminals, what is searched.

mod budget;
mod units;

pub use budget::{Allowance, Budget, Shares, scattered};
pub use units::{Halt, Phase, UnitStore, Units};

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// What the work of a phase is, for programs that treat phases differently. The name of a phase is for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Work {
    /// A scene is cut into cells, or prepared for that. It may still be refused.
    Cutting,
    /// What is visible is decided, in units of which every beginning is a sample: the rest will take about as long for each.
    Deciding,
    /// Anything else.
    #[default]
    Other,
}

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is being done, in a word or two, for people.
    pub phase: &'static str,
    /// What kind of work that is.
    pub work: Work,
    /// Units of this phase that are done. Their kind depends on the search: cells, pairs, objects.
    pub done: u64,
    /// Units of this phase.
    pub total: u64,
    /// The share of this phase, or of all phases of a search that knows them, that is done; from 0 to 1, as an estimate of time.
    pub share: f64,
}

impl Progress {
    /// A report of a search with one phase, of [`Work::Other`]; the share is that of its units.
    pub fn new(phase: &'static str, done: u64, total: u64) -> Self {
        let share = if total == 0 { 1.0 } else { done as f64 / total as f64 };
        Self { phase, work: Work::Other, done, total, share }
    }

    /// The same report of a kind of work.
    #[must_use]
    pub const fn of(self, work: Work) -> Self {
        Self { work, ..self }
    }

    /// The same report with another estimate of the share.
    #[must_use]
    pub const fn with_share(self, share: f64) -> Self {
        Self { share, ..self }
    }
}

/// Receives the progress of a search, and may cancel it.
pub trait Observer: Sync {
    /// Takes a report. [`ControlFlow::Break`] cancels the search as soon as its threads have finished the units that
    /// they are at; further reports may come until then. Called from any thread, several at once; reports of different
    /// threads may come out of order.
    fn report(&self, progress: Progress) -> ControlFlow<()>;
}

impl<F: Fn(Progress) -> ControlFlow<()> + Sync> Observer for F {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self(progress)
    }
}

/// A search was cancelled by its [`Observer`]: there is no answer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, thiserror::Error)]
#[error("the search was cancelled")]
pub struct Cancelled;

/// Counts the finished units of a phase for an observer. Threads share it by reference.
pub struct Counter<'a> {
    observer: Option<&'a dyn Observer>,
    phase: &'static str,
    work: Work,
    total: u64,
    /// How many units come first, and the share of the time that they take.
    first: (u64, f64),
    done: AtomicU64,
    cancelled: AtomicBool,
}

impl std::fmt::Debug for Counter<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Counter")
            .field("phase", &self.phase)
            .field("work", &self.work)
            .field("total", &self.total)
            .field("done", &self.done)
            .field("cancelled", &self.cancelled)
            .finish_non_exhaustive()
    }
}

impl<'a> Counter<'a> {
    /// None of `total` units, of [`Work::Other`], are done. Without an observer nothing is reported, and nothing cancels.
    pub const fn new(observer: Option<&'a dyn Observer>, phase: &'static str, total: usize) -> Self {
        let (done, cancelled) = (AtomicU64::new(0), AtomicBool::new(false));
        Self { observer, phase, work: Work::Other, total: total as u64, first: (0, 0.0), done, cancelled }
    }

    /// The same counter for units of a kind of work.
    #[must_use]
    pub fn of(self, work: Work) -> Self {
        Self { work, ..self }
    }

    /// The same counter for units of two kinds: the first `n` take about this share of the time, however many others there are.
    #[must_use]
    pub fn with_first(self, n: usize, share: f64) -> Self {
        Self { first: (n as u64, share), ..self }
    }

    /// The share of the time that is over once `done` units are done.
    fn share(&self, done: u64) -> Option<f64> {
        let (n, share) = self.first;
        let part = |done: u64, of: u64| done as f64 / of as f64;
        // With units of one kind, a report knows the share itself.
        (0 < n && n < self.total).then(|| match done.checked_sub(n) {
            None => share * part(done, n),
            Some(later) => share + (1.0 - share) * part(later.min(self.total - n), self.total - n),
        })
    }

    /// Counts a unit and reports it.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer cancels, or has cancelled before.
    pub fn step(&self) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Relaxed) + 1;
        let progress = Progress::new(self.phase, done, self.total).of(self.work);
        let progress = self.share(done).map_or(progress, |share| progress.with_share(share));
        if self.observer.is_some_and(|observer| observer.report(progress).is_break()) {
            self.cancelled.store(true, Relaxed);
        }
        self.check()
    }

    /// Whether to go on; for threads before a unit, and at the end.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer has cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Whether the observer has cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }
}

/// Passes reports on, and does not let them cancel: for work of which a part is worth nothing and that leaves nothing
/// behind when it is stopped.
#[derive(Clone, Copy)]
pub struct Uncancelled<'a>(pub &'a dyn Observer);

impl std::fmt::Debug for Uncancelled<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Uncancelled").finish_non_exhaustive()
    }
}

impl Observer for Uncancelled<'_> {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        let _ = self.0.report(progress);
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn every_step_is_reported_and_none_after_a_cancellation_succeeds() {
        let seen = Mutex::new(Vec::new());
        let observer = |progress: Progress| {
            seen.lock().expect("no panic").push(progress.done);
            if progress.done == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let counter = Counter::new(Some(&observer), "units", 5);
        let steps: Vec<bool> = (0..5).map(|_| counter.step().is_ok()).collect();
        assert_eq!(steps, [true, true, false, false, false]);
        assert_eq!(*seen.lock().expect("no panic"), [1, 2, 3, 4, 5]);
        assert_eq!((counter.check(), counter.is_cancelled()), (Err(Cancelled), true));
    }

    #[test]
    fn without_an_observer_nothing_cancels() {
        let counter = Counter::new(None, "units", 2);
        assert_eq!([counter.step(), counter.step(), counter.check()], [Ok(()); 3]);
    }

    /// Few long units come before many short ones; counted alike, the first of them would promise hours.
    #[test]
    fn shares_are_of_time_where_units_differ() {
        let seen = std::sync::Mutex::new(Vec::new());
        let observer = |progress: Progress| {
            seen.lock().unwrap().push(progress.share);
            ControlFlow::Continue(())
        };
        for first in [2, 0, 6] {
            let counter = Counter::new(Some(&observer), "pairs and objects", 6).with_first(first, 0.5);
            (0..6).for_each(|_| counter.step().unwrap());
        }
        let alike = (1..=6).map(|done| f64::from(done) / 6.0);
        let expected: Vec<f64> =
            [0.25, 0.5, 0.625, 0.75, 0.875, 1.0].into_iter().chain(alike.clone()).chain(alike).collect();
        assert_eq!(*seen.lock().unwrap(), expected);
    }

    #[test]
    fn shares_are_those_of_units_unless_given() {
        assert_eq!([Progress::new("", 1, 4).share, Progress::new("", 0, 0).share], [0.25, 1.0]);
        let half = Progress { phase: "", work: Work::Other, done: 1, total: 4, share: 0.5 };
        assert_eq!(Progress::new("", 1, 4).with_share(0.5), half);
    }

    #[test]
    fn counters_report_their_kind_of_work() {
        let seen = Mutex::new(Vec::new());
        let observer = |progress: Progress| {
            seen.lock().expect("no panic").push(progress.work);
            ControlFlow::Continue(())
        };
        let steps = [Counter::new(Some(&observer), "", 1), Counter::new(Some(&observer), "", 1).of(Work::Deciding)];
        assert_eq!(steps.map(|counter| counter.step()), [Ok(()); 2]);
        assert_eq!(*seen.lock().expect("no panic"), [Work::Other, Work::Deciding]);
    }

    #[test]
    fn what_must_not_be_cancelled_is_not() {
        let stop = |_: Progress| ControlFlow::Break(());
        assert!(Uncancelled(&stop).report(Progress::new("", 0, 1)).is_continue());
    }
}
