#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the [`Observer`] trait, its reports ([`Progress`]) and kinds of work ([`Work`]), the error of a cancelled search ([`Cancelled`]), and
//!   the counter that threads of a search share ([`Counter`]), what a search may spend ([`Budget`]), how long it will take ([`Pace`]), how much memory a process may use ([`memory`]), the contract of stores that keep the
//!   results of units of work ([`UnitStore`]), and the encoding of these ([`Kept`]), words for numbers ([`words`]).
//! - **Out of scope**: clocks, terminals, what is searched.

mod budget;
mod kept;
pub mod memory;
mod pace;
mod units;
pub mod words;

pub use budget::{Allowance, Budget, Shares, scattered};
pub use kept::{Kept, read_whole, write_list};
pub use pace::Pace;
pub use units::{Halt, Pass, Phase, UnitStore, Units, shares_of};

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
    /// The part of the share that was not computed but taken from a store of units, and so says nothing of the pace.
    pub kept: f64,
}

impl Progress {
    /// A report of a search with one phase, of [`Work::Other`]; the share is that of its units.
    pub fn new(phase: &'static str, done: u64, total: u64) -> Self {
        let share = if total == 0 { 1.0 } else { done as f64 / total as f64 };
        Self { phase, work: Work::Other, done, total, share, kept: 0.0 }
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

    /// The same report of a search that took a part of its share from a store of units.
    #[must_use]
    pub const fn with_kept(self, kept: f64) -> Self {
        Self { kept, ..self }
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
    done: AtomicU64,
    /// The share of the time that is over, and what of it was taken from a store: bits of numbers. Of no meaning where units are alike.
    shares: [AtomicU64; 2],
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
        let shares = [AtomicU64::new(0), AtomicU64::new(0)];
        Self { observer, phase, work: Work::Other, total: total as u64, done, shares, cancelled }
    }

    /// The same counter for units of a kind of work.
    #[must_use]
    pub fn of(self, work: Work) -> Self {
        Self { work, ..self }
    }

    /// Counts a unit and reports it.
    ///
    /// # Errors
    /// [`Cancelled`] if the observer cancels, or has cancelled before.
    pub fn step(&self) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Relaxed) + 1;
        let progress = Progress::new(self.phase, done, self.total).of(self.work);
        self.report(progress)
    }

    /// Counts a unit that takes a known share of the time, from 0 to 1 for all units together, and reports it. All units of a counter are
    /// counted so, or none.
    ///
    /// * `kept`: whether its result came from a store of units
    ///
    /// # Errors
    /// As [`Counter::step`].
    pub fn step_by(&self, share: f64, kept: bool) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Relaxed) + 1;
        let add = |sum: &AtomicU64, x: f64| {
            let plus = |bits: u64| (f64::from_bits(bits) + x).to_bits();
            let before = sum.fetch_update(Relaxed, Relaxed, |bits| Some(plus(bits)));
            f64::from_bits(plus(before.unwrap_or_else(|bits| bits)))
        };
        let [all, of_store] = &self.shares;
        let (all, of_store) = (add(all, share), add(of_store, if kept { share } else { 0.0 }));
        let progress = Progress::new(self.phase, done, self.total).of(self.work);
        self.report(progress.with_share(all.min(1.0)).with_kept(of_store.min(1.0)))
    }

    fn report(&self, progress: Progress) -> Result<(), Cancelled> {
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

    #[test]
    fn shares_are_those_of_units_unless_given() {
        assert_eq!([Progress::new("", 1, 4).share, Progress::new("", 0, 0).share], [0.25, 1.0]);
        let half = Progress { phase: "", work: Work::Other, done: 1, total: 4, share: 0.5, kept: 0.0 };
        assert_eq!(Progress::new("", 1, 4).with_share(0.5), half);
    }

    #[test]
    fn shares_may_be_given_for_each_unit() {
        let seen = Mutex::new(Vec::new());
        let observer = |progress: Progress| {
            seen.lock().expect("no panic").push((progress.done, progress.share, progress.kept));
            ControlFlow::Continue(())
        };
        let counter = Counter::new(Some(&observer), "units", 3);
        for (share, kept) in [(0.5, true), (0.125, false), (0.375, true)] {
            counter.step_by(share, kept).unwrap();
        }
        assert_eq!(*seen.lock().unwrap(), [(1, 0.5, 0.5), (2, 0.625, 0.5), (3, 1.0, 0.875)]);
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
