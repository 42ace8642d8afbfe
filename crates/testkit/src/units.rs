//! Bakes whose results are kept by units of work: stopped and taken up again, or shared by processes, they end with the same bytes.

use sightlines_progress::{Cancelled, Halt, Pass, Phase, UnitStore, Units};
use std::collections::BTreeMap;
use std::fmt::{Debug, Display};
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Results of units, by phase and unit.
pub type Results = BTreeMap<(&'static str, usize), Vec<u8>>;

/// Keeps results in memory, and does a part of them.
#[derive(Debug, Default)]
pub struct Memory {
    results: Mutex<Results>,
    sizes: Mutex<Vec<(&'static str, Vec<f64>)>>,
    /// Whether the phase under way is a chain.
    is_chain: AtomicBool,
    n_saved: Mutex<usize>,
    /// Ends the bake after so many results.
    stop_after: Option<usize>,
    /// Which of how many processes this is.
    part: Option<(usize, usize)>,
    /// How many passes compute a run of units each, before one reads all.
    n_passes: usize,
    /// How many of them are over.
    n_passed: Mutex<usize>,
}

impl UnitStore for Memory {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        assert!(phase.costs.iter().all(|cost| cost.is_finite() && *cost >= 0.0));
        let mut sizes = self.sizes.lock().unwrap();
        assert!(sizes.iter().all(|(name, _)| *name != phase.name), "{} begins twice", phase.name);
        sizes.push((phase.name, phase.costs.to_vec()));
        *self.n_passed.lock().unwrap() = 0;
        self.is_chain.store(phase.is_chain, Relaxed);
        Ok(())
    }

    fn wants(&self, phase: &'static str, unit: usize) -> bool {
        // One process does all of a chain.
        let of_process = if self.is_chain.load(Relaxed) { 0 } else { unit };
        self.part.is_none_or(|(part, of)| of_process % of == part) && self.is_of_pass(phase, unit)
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        if !self.is_of_pass(phase, unit) {
            return Ok(None);
        }
        Ok(self.results.lock().unwrap().get(&(phase, unit)).cloned())
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        if self.is_chain.load(Relaxed) {
            let is_next = unit == 0 || self.results.lock().unwrap().contains_key(&(phase, unit - 1));
            assert!(is_next, "unit {unit} of the chain {phase} comes before the one that it depends on");
        }
        let mut n = self.n_saved.lock().unwrap();
        if self.stop_after.is_some_and(|most| *n >= most) {
            return Err(Cancelled.into());
        }
        *n += 1;
        assert!(self.results.lock().unwrap().insert((phase, unit), result.to_vec()).is_none(), "{phase} {unit} twice");
        Ok(())
    }

    fn end(&self, phase: &'static str) -> Result<Pass, Halt> {
        let (results, n) = (self.results.lock().unwrap(), self.n_units(phase));
        let mut n_passed = self.n_passed.lock().unwrap();
        if *n_passed < self.n_passes {
            *n_passed += 1;
            return Ok(Pass::Again);
        }
        if (0..n).all(|unit| results.contains_key(&(phase, unit))) { Ok(Pass::Last) } else { Err(Halt::Shared) }
    }

    fn runs(&self, phase: &'static str) -> Option<Vec<Range<usize>>> {
        (self.n_passes > 0).then(|| vec![self.run_of_pass(phase)])
    }
}

impl Memory {
    /// One that has these results.
    pub fn with(results: &Results) -> Self {
        Self { results: Mutex::new(results.clone()), ..Self::default() }
    }

    /// The same, but it ends the work when so many more results are kept.
    #[must_use]
    pub fn stopping_after(self, n_results: usize) -> Self {
        Self { stop_after: Some(n_results), ..self }
    }

    /// The same, but of one of `of` processes.
    #[must_use]
    pub fn of_part(self, part: usize, of: usize) -> Self {
        Self { part: Some((part, of)), ..self }
    }

    /// The same, but it goes through each phase so many times, from the last units to the first, before it has all results.
    #[must_use]
    pub fn in_passes(self, n_passes: usize) -> Self {
        Self { n_passes, ..self }
    }

    /// How many units the phase has that has begun.
    fn n_units(&self, phase: &'static str) -> usize {
        let size = self.sizes.lock().unwrap().last().map(|(name, costs)| (*name, costs.len()));
        size.filter(|(name, _)| *name == phase).expect("a phase that has begun").1
    }

    fn run_of_pass(&self, phase: &'static str) -> Range<usize> {
        let (n, passed) = (self.n_units(phase), *self.n_passed.lock().unwrap());
        if passed == self.n_passes {
            return 0..n;
        }
        let left = self.n_passes - passed;
        if self.is_chain.load(Relaxed) {
            // All of it in the last of them.
            return if left == 1 { 0..n } else { 0..0 };
        }
        n * (left - 1) / self.n_passes..n * left / self.n_passes
    }

    fn is_of_pass(&self, phase: &'static str, unit: usize) -> bool {
        self.n_passes == 0 || self.run_of_pass(phase).contains(&unit)
    }

    /// The phases that have begun, each with the costs of its units.
    pub fn phases(&self) -> Vec<(&'static str, Vec<f64>)> {
        self.sizes.lock().unwrap().clone()
    }

    /// The results that it has.
    pub fn into_results(self) -> Results {
        self.results.into_inner().unwrap()
    }
}

/// Does some work in every way and compares what it gives; returns the phases, each with its number of units.
///
/// * `work`: with a store, on so many threads
///
/// # Panics
/// If a stopped or a shared run gives something else.
pub fn check_units<E: Display + Debug>(
    work: impl Fn(Units<'_>, usize) -> Result<Vec<u8>, E>,
) -> Vec<(&'static str, usize)> {
    let bytes = |store: &Memory, threads: usize| work(Units(Some(store)), threads);
    let is_shared =
        |answer: &Result<Vec<u8>, E>| answer.as_ref().is_err_and(|error| error.to_string() == Halt::Shared.to_string());
    let plain = work(Units::default(), 2).unwrap();
    let whole = Memory::default();
    assert!(bytes(&whole, 2).unwrap() == plain, "a store changes the result");
    let phases = whole.phases().iter().map(|(name, costs)| (*name, costs.len())).collect();
    let all = whole.into_results();

    // Nothing is computed twice where everything is kept.
    let kept = Memory::with(&all).stopping_after(0);
    assert!(bytes(&kept, 1).unwrap() == plain, "kept results are others");

    // Stopped again and again.
    let (mut results, mut n_stops) = (BTreeMap::new(), 0);
    let step = all.len() / 5 + 1;
    let resumed = loop {
        let store = Memory::with(&results).stopping_after(step);
        let answer = bytes(&store, 1 + n_stops % 2);
        results = store.into_results();
        match answer {
            Ok(bytes) => break bytes,
            Err(error) => assert_eq!(error.to_string(), Cancelled.to_string()),
        }
        n_stops += 1;
        assert!(n_stops < 9, "it does not go on where it was stopped");
    };
    assert!(resumed == plain && n_stops > 2, "{n_stops} stops");

    // Phases gone through several times, each time with results of a part alone, and in the end with all.
    for n_passes in [1, 3] {
        let store = Memory::default().in_passes(n_passes);
        assert!(bytes(&store, 2).unwrap() == plain, "{n_passes} passes give something else");
        // What is not found in a pass may be looked for again in another, so results may differ in their effort.
        assert!(store.into_results().keys().eq(all.keys()), "{n_passes} passes keep results of other units");
        // Whatever is found, results of another process count.
        let store = Memory::with(&all).in_passes(n_passes).stopping_after(0);
        assert!(bytes(&store, 1).unwrap() == plain, "{n_passes} passes over kept results give something else");
    }

    // Shared by three processes that know only what earlier phases have found.
    let (mut results, mut rounds) = (BTreeMap::new(), 0);
    let merged = loop {
        let mut found = BTreeMap::new();
        for part in 0..3 {
            let store = Memory::with(&results).of_part(part, 3);
            let answer = bytes(&store, 1);
            assert!(answer.is_ok() || is_shared(&answer), "{answer:?}");
            found.extend(store.into_results());
        }
        results = found;
        let store = Memory::with(&results).of_part(usize::MAX, usize::MAX).stopping_after(0);
        match bytes(&store, 1) {
            Ok(bytes) => break bytes,
            answer => assert!(is_shared(&answer), "{answer:?}"),
        }
        rounds += 1;
        assert!(rounds < 12, "the results of three processes are not all");
    };
    assert!(merged == plain, "three processes give something else");
    phases
}

/// A kept result is used: with that of another unit in its place the work gives something else, or fails; and it fails, without a panic,
/// with one that is cut short.
///
/// # Panics
/// If nobody notices.
pub fn check_impostor<E: Display + Debug>(work: impl Fn(Units<'_>, usize) -> Result<Vec<u8>, E>, phase: &str) {
    let whole = Memory::default();
    let plain = work(Units(Some(&whole)), 2).unwrap();
    let all = whole.into_results();
    let of_phase: Vec<_> = all.iter().filter(|((name, _), _)| *name == phase).collect();
    let (longest, bytes) = of_phase.iter().max_by_key(|(_, bytes)| bytes.len()).expect("a result");
    let others = of_phase.iter().filter(|(key, bytes)| key != longest && **bytes != all[*longest]).take(20);
    let with = |other: &[u8]| {
        let mut wrong = all.clone();
        wrong.insert(**longest, other.to_vec());
        work(Units(Some(&Memory::with(&wrong))), 1)
    };
    let n_noticed = others.filter(|(_, other)| !with(other).is_ok_and(|bytes| bytes == plain)).count();
    assert!(n_noticed > 0, "no result of {phase} counts");
    for length in [0, bytes.len() / 2, bytes.len() - 1] {
        assert!(with(&bytes[..length]).is_err(), "{length} bytes of a result of {phase} are enough");
    }
}
