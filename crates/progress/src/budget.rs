//! How much a search may spend, and fair shares of it.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// How much of what a search may spend is spent, such as time. The search asks between units of work; what is not decided when
/// nothing is left counts as visible.
pub trait Budget: Sync {
    /// The share that is spent: 0 at the start, 1 or more when nothing is left. Called from any thread, and often.
    fn spent(&self) -> f64;
}

impl<F: Fn() -> f64 + Sync> Budget for F {
    fn spent(&self) -> f64 {
        self()
    }
}

/// A budget up to some share of it: what a phase or a unit of work may spend. Without a budget it is never over.
#[derive(Clone, Copy, Default)]
pub struct Allowance<'a> {
    budget: Option<&'a dyn Budget>,
    until: f64,
}

impl std::fmt::Debug for Allowance<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Allowance").field("limited", &self.budget.is_some()).field("until", &self.until).finish()
    }
}

impl<'a> Allowance<'a> {
    /// All of a budget.
    pub const fn all(budget: Option<&'a dyn Budget>) -> Self {
        Self { budget, until: 1.0 }
    }

    /// Whether there is a budget at all.
    pub const fn is_limited(&self) -> bool {
        self.budget.is_some()
    }

    /// This share, from 0 to 1, of what is left of the allowance.
    #[must_use]
    pub fn part(&self, share: f64) -> Self {
        let Some(budget) = self.budget else { return *self };
        let from = budget.spent();
        Self { until: if from < self.until { from + (self.until - from) * share } else { self.until }, ..*self }
    }

    /// Whether nothing is left. What is no number counts as over.
    pub fn is_over(&self) -> bool {
        self.budget.is_some_and(|budget| budget.spent().partial_cmp(&self.until) != Some(std::cmp::Ordering::Less))
    }
}

/// Divides an allowance among units of work that threads begin one after the other. Each has an equal share, and what those before it
/// have left.
#[derive(Debug)]
pub struct Shares<'a> {
    all: Allowance<'a>,
    from: f64,
    n_units: usize,
    n_threads: usize,
    begun: AtomicU64,
}

impl<'a> Shares<'a> {
    /// Shares for `n_units` units, on so many threads.
    pub fn new(all: Allowance<'a>, n_units: usize, n_threads: usize) -> Self {
        let from = all.budget.map_or(0.0, Budget::spent);
        Self { all, from, n_units, n_threads: n_threads.max(1), begun: AtomicU64::new(0) }
    }

    /// What the next unit may spend.
    pub fn next_unit(&self) -> Allowance<'a> {
        let before = self.begun.fetch_add(1, Relaxed) as f64;
        // As many units as there are threads run at once.
        let share = (before + self.n_threads as f64) / self.n_units.max(1) as f64;
        let until = if share < 1.0 { self.from + (self.all.until - self.from) * share } else { self.all.until };
        Allowance { until: until.min(self.all.until), ..self.all }
    }
}

/// The numbers below `n` in an order of which every beginning is spread over all of them: a sample, by which the time of the rest is
/// estimated. O(n).
pub fn scattered(n: usize) -> impl Iterator<Item = usize> {
    let n_bits = n.next_power_of_two().trailing_zeros();
    let reversed = move |i: usize| if n_bits == 0 { 0 } else { i.reverse_bits() >> (usize::BITS - n_bits) };
    (0..1usize << n_bits).map(reversed).filter(move |&i| i < n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU32;

    /// A clock that is set by hand, in hundredths.
    fn clock(hundredths: &AtomicU32) -> impl Fn() -> f64 + '_ {
        || f64::from(hundredths.load(Relaxed)) / 100.0
    }

    #[test]
    fn without_a_budget_nothing_is_over() {
        let all = Allowance::all(None);
        assert!(!all.is_limited() && !all.is_over() && !all.part(0.0).is_over());
        assert!(!Shares::new(all, 0, 0).next_unit().is_over());
    }

    #[test]
    fn every_beginning_is_spread() {
        assert_eq!(scattered(6).collect::<Vec<_>>(), [0, 4, 2, 1, 5, 3]);
        for n in [0, 1, 2, 37, 256] {
            let mut all: Vec<usize> = scattered(n).collect();
            all.sort_unstable();
            assert_eq!(all, (0..n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn an_allowance_ends_where_it_says() {
        let now = AtomicU32::new(20);
        let clock = clock(&now);
        let all = Allowance::all(Some(&clock));
        // Half of what is left after 20 is until 60, but for rounding.
        let half = all.part(0.5);
        let over = |at: u32| {
            now.store(at, Relaxed);
            [half.is_over(), all.is_over()]
        };
        assert_eq!([20, 59, 61, 99, 100, 300].map(over).concat(), {
            let (no, first, both) = ([false; 2], [true, false], [true; 2]);
            [no, no, first, first, both, both].concat()
        });
        let no_number = || f64::NAN;
        assert!(Allowance::all(Some(&no_number)).is_over());
    }

    #[test]
    fn units_have_equal_shares_and_what_is_left_before_them() {
        let now = AtomicU32::new(0);
        let clock = clock(&now);
        let shares = Shares::new(Allowance::all(Some(&clock)), 4, 1);
        let ends: Vec<u32> = (0..5)
            .map(|_| {
                let unit = shares.next_unit();
                now.store(0, Relaxed);
                (0..=100).find(|&at| (now.store(at, Relaxed), unit.is_over()).1).expect("it ends")
            })
            .collect();
        assert_eq!(ends, [25, 50, 75, 100, 100]);
        now.store(0, Relaxed);
        // Two at once: the first two may both take until half of it is spent.
        let shares = Shares::new(Allowance::all(Some(&clock)), 4, 2);
        let first = shares.next_unit();
        now.store(49, Relaxed);
        assert!(!first.is_over());
    }
}
