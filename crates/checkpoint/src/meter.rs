//! How much of a phase is done, by the predicted costs of its units.

use sightlines_progress::{Halt, Phase, UnitStore};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A store that tells which units it has results of.
pub trait KnownStore: UnitStore {
    /// Whether there is a result of a unit. It is not read.
    fn has(&self, phase: &'static str, unit: usize) -> bool;
}

/// How much of a phase is done: of the units that this process has to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// The phase.
    pub phase: &'static str,
    /// The share that was done before this process began the phase, from 0 to 1.
    pub before: f64,
    /// The share that is done now.
    pub done: f64,
}

/// What a store has measured, for whoever shows it.
#[derive(Debug, Default)]
pub struct Meter(Mutex<Option<State>>);

#[derive(Debug)]
struct State {
    phase: &'static str,
    costs: Vec<f64>,
    all: f64,
    before: f64,
    done: f64,
}

impl Meter {
    /// How much of the phase that is under way is done; `None` between phases.
    pub fn work(&self) -> Option<Work> {
        let state = self.lock();
        let State { phase, all, before, done, .. } = state.as_ref()?;
        let share = |cost: f64| if *all > 0.0 { (cost / all).clamp(0.0, 1.0) } else { 1.0 };
        Some(Work { phase, before: share(*before), done: share(*done) })
    }

    fn lock(&self) -> MutexGuard<'_, Option<State>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A store whose work is measured.
pub struct Metered<'a> {
    store: &'a dyn KnownStore,
    meter: Arc<Meter>,
}

impl std::fmt::Debug for Metered<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Metered").field("meter", &self.meter).finish_non_exhaustive()
    }
}

impl<'a> Metered<'a> {
    /// A store, and the meter that follows it.
    pub fn new(store: &'a dyn KnownStore, meter: Arc<Meter>) -> Self {
        Self { store, meter }
    }
}

impl UnitStore for Metered<'_> {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        self.store.begin(phase)?;
        // Without predictions all units count alike.
        let is_known = phase.costs.iter().any(|&cost| cost > 0.0);
        let costs: Vec<f64> = phase.costs.iter().map(|&cost| if is_known { cost } else { 1.0 }).collect();
        let (mut all, mut before) = (0.0, 0.0);
        for (unit, &cost) in costs.iter().enumerate() {
            let is_done = self.store.has(phase.name, unit);
            let is_ours = self.store.wants(phase.name, unit);
            all += if is_ours { cost } else { 0.0 };
            before += if is_ours && is_done { cost } else { 0.0 };
        }
        *self.meter.lock() = Some(State { phase: phase.name, costs, all, before, done: before });
        Ok(())
    }

    fn wants(&self, phase: &'static str, unit: usize) -> bool {
        self.store.wants(phase, unit)
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        self.store.load(phase, unit)
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        self.store.save(phase, unit, result)?;
        if let Some(state) = self.meter.lock().as_mut().filter(|state| state.phase == phase) {
            state.done += state.costs.get(unit).copied().unwrap_or(0.0);
        }
        Ok(())
    }

    fn end(&self, phase: &'static str) -> Result<(), Halt> {
        *self.meter.lock() = None;
        self.store.end(phase)
    }
}
