//! Threads, observers and stores of long work.

use rayon::prelude::*;
use sightlines_progress::{Counter, Halt, Kept, Observer, Phase, Units, read_whole, shares_of};
use std::ops::Range;

/// How long work is done: by how many threads, who is told, and where results are kept. None of them changes a result.
#[derive(Clone, Copy, Default)]
pub struct WorkOptions<'a> {
    /// Number of threads; 0 for one per core.
    pub threads: usize,
    /// Is told how far the work is, and may cancel it.
    pub observer: Option<&'a dyn Observer>,
    /// Where results of units of work are kept, to go on after a stop or to share the work among processes. Phases are `sight`,
    /// `local-measures`, `depths`, `metric-paths` and `angular-paths`: a store serves each of them once.
    pub units: Units<'a>,
}

impl std::fmt::Debug for WorkOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("WorkOptions");
        out.field("threads", &self.threads).field("observer", &self.observer.is_some()).field("units", &self.units);
        out.finish()
    }
}

/// A stage of the work: a result for each of some numbers.
pub(crate) struct Stage<'a, R> {
    /// What is done, for people.
    pub(crate) title: &'static str,
    /// Name of the phase of units.
    pub(crate) phase: &'static str,
    /// Results of a unit.
    pub(crate) size: usize,
    /// The predicted cost of each result.
    pub(crate) cost: &'a (dyn Fn(usize) -> f64 + Sync),
    /// Whether something can be the result of a number.
    pub(crate) fits: &'a (dyn Fn(&R, usize) -> bool + Sync),
}

/// Why there is no result of a unit.
enum Stop<E> {
    Halt(Halt),
    Error(E),
}

impl<E> From<Halt> for Stop<E> {
    fn from(halt: Halt) -> Self {
        Self::Halt(halt)
    }
}

impl WorkOptions<'_> {
    /// Applies `one` to the numbers below `n`, each with a state that `state` makes once for some of them, and returns the results in
    /// order, or the error of the lowest number.
    pub(crate) fn each<S, R: Kept + Send, E: From<Halt> + Send>(
        &self,
        stage: &Stage<'_, R>,
        n: usize,
        state: impl Fn() -> S + Sync + Send,
        one: impl Fn(&mut S, usize) -> Result<R, E> + Sync + Send,
    ) -> Result<Vec<R>, E> {
        if self.units.are_kept() {
            return self.each_in_units(stage, n, state, one);
        }
        let counter = Counter::new(self.observer, stage.title, n);
        let all = || {
            let step = |state: &mut S, k: usize| {
                counter.check()?;
                let result = one(state, k);
                counter.step()?;
                Ok(result)
            };
            (0..n).into_par_iter().map_init(&state, step).collect::<Result<Vec<Result<R, E>>, Halt>>()
        };
        self.on_threads(all)?.into_iter().collect()
    }

    fn each_in_units<S, R: Kept + Send, E: From<Halt> + Send>(
        &self,
        stage: &Stage<'_, R>,
        n: usize,
        state_of: impl Fn() -> S + Sync + Send,
        one: impl Fn(&mut S, usize) -> Result<R, E> + Sync + Send,
    ) -> Result<Vec<R>, E> {
        let ranges: Vec<Range<usize>> =
            (0..n).step_by(stage.size).map(|first| first..n.min(first + stage.size)).collect();
        let costs: Vec<f64> = ranges.iter().map(|range| range.clone().map(stage.cost).sum()).collect();
        let shares = shares_of(&costs);
        let counter = Counter::new(self.observer, stage.title, ranges.len());
        let step = |state: &mut Option<S>, unit: usize| -> Result<Result<Vec<R>, E>, Halt> {
            counter.check()?;
            let compute = || {
                let state = state.get_or_insert_with(&state_of);
                let of = |k: usize| {
                    counter.check().map_err(Halt::from)?;
                    one(state, k).map_err(Stop::Error)
                };
                ranges[unit].clone().map(of).collect::<Result<Vec<R>, Stop<E>>>()
            };
            let write = |all: &Vec<R>| {
                let mut bytes = Vec::new();
                R::write_all(all, &mut bytes);
                bytes
            };
            let read = |bytes: &[u8]| {
                let all = read_whole(bytes, |bytes| R::read_all(bytes, ranges[unit].len()))?;
                ranges[unit].clone().zip(&all).all(|(k, one)| (stage.fits)(one, k)).then_some(all)
            };
            let (found, is_kept) = match self.units.value((stage.phase, unit, "this analysis"), compute, write, read) {
                Ok(found) => found,
                Err(Stop::Halt(halt)) => return Err(halt),
                Err(Stop::Error(error)) => return Ok(Err(error)),
            };
            counter.step_by(shares[unit], is_kept)?;
            // Those of another process are missing, and the end of the phase says so.
            Ok(Ok(found.unwrap_or_default()))
        };
        let all = || {
            let units = (0..ranges.len()).into_par_iter().with_max_len(1);
            units.map_init(|| None, step).collect::<Result<Vec<Result<Vec<R>, E>>, Halt>>()
        };
        let found = self.units.through(&Phase::new(stage.phase, &costs), || {
            self.on_threads(all)?.into_iter().collect::<Result<Vec<Vec<R>>, E>>()
        })?;
        Ok(found.into_iter().flatten().collect())
    }

    fn on_threads<T: Send>(&self, all: impl FnOnce() -> T + Send) -> T {
        match rayon::ThreadPoolBuilder::new().num_threads(self.threads).build() {
            Ok(pool) => pool.install(all),
            // The system has no threads left: the shared ones do it.
            Err(_) => all(),
        }
    }
}
