//! The store of a bake that is part of a job.

use super::cut::cut;
use super::manifest::PhasePlan;
use super::own::OwnShards;
use super::{Job, JobError, ShardState};
use crate::index::Results;
use sightlines_progress::{Halt, Phase, UnitStore};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What a process does for a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Role {
    /// Goes through the bake with the results of all parts: it ends at the first phase that is not complete, and plans one that is not known.
    Merge,
    /// Computes the units of these shards, which are all of one phase: one shard after the other, in ascending order. Each part is written as soon as its units are done,
    /// and does not depend on which other shards the process does.
    Shards(Vec<usize>),
}

impl Role {
    /// Computes the units of one shard.
    pub fn shard(shard: usize) -> Self {
        Self::Shards(vec![shard])
    }
}

/// How far a process came.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// The next phase is known now, with these shards.
    Planned {
        /// Its place.
        phase: usize,
        /// Its shards.
        shards: Range<usize>,
    },
    /// Shards of a phase are not done.
    Missing {
        /// The place of the phase.
        phase: usize,
        /// The shards, and what there is of each.
        shards: Vec<(usize, ShardState)>,
    },
    /// The parts of all shards of the process are written.
    Done,
}

/// A store of units in the folder of a job.
#[derive(Debug)]
pub struct JobStore {
    role: Role,
    own: Option<OwnShards>,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    job: Job,
    /// How many phases have begun.
    n_begun: usize,
    /// Those of the phase under way, if it is complete.
    parts: Option<Parts>,
    outcome: Option<Outcome>,
}

/// The parts of a phase, in order.
#[derive(Debug)]
struct Parts {
    phase: String,
    n_units: usize,
    /// Behind the last unit of each.
    ends: Vec<usize>,
    parts: Vec<Results>,
}

impl JobStore {
    /// The store of a process with this role. Results of a shard are kept in a journal after a while.
    ///
    /// # Errors
    /// [`JobError::NoShard`], and [`JobError::TwoPhases`].
    pub fn new(job: Job, role: Role, after: Duration) -> Result<Self, JobError> {
        let own = match &role {
            Role::Merge => None,
            Role::Shards(shards) => Some(OwnShards::new(&job, shards, after)?),
        };
        let state = State { job, n_begun: 0, parts: None, outcome: None };
        Ok(Self { role, own, state: Mutex::new(state) })
    }

    /// What the process does.
    pub fn role(&self) -> &Role {
        &self.role
    }

    /// Why the bake ended early, if the store ended it.
    pub fn outcome(&self) -> Option<Outcome> {
        self.lock().outcome.clone()
    }

    /// The job, with phases that were planned.
    pub fn job(&self) -> Job {
        self.lock().job.clone()
    }

    /// Keeps results that are in memory for a later run of the same shards.
    ///
    /// # Errors
    /// [`Halt::Store`] if they cannot be written.
    pub fn flush(&self) -> Result<(), Halt> {
        self.own.as_ref().map_or(Ok(()), OwnShards::flush)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The shards of this process, if they are of a phase.
    fn own_of(&self, phase: &str) -> Option<&OwnShards> {
        self.own.as_ref().filter(|own| own.are_of(phase))
    }
}

impl State {
    fn end_with(&mut self, outcome: Outcome) -> Halt {
        self.outcome = Some(outcome);
        Halt::Shared
    }

    /// The parts of a phase, or what is missing of them.
    fn open_parts(&self, phase: usize) -> Result<Parts, Vec<(usize, ShardState)>> {
        let PhasePlan { name, n_units, shards } = &self.job.manifest.phases[phase];
        let (mut parts, mut missing) = (Vec::new(), Vec::new());
        for (shard, plan) in self.job.manifest.shards_of(phase).zip(shards) {
            match self.job.part(shard, name, plan) {
                Ok(Some(part)) => parts.push(part),
                Ok(None) => missing.push((shard, self.job.state(shard).unwrap_or(ShardState::Missing))),
                Err(error) => missing.push((shard, ShardState::Broken(error.to_string()))),
            }
        }
        let ends = shards.iter().map(|plan| plan.end).collect();
        let parts = Parts { phase: name.clone(), n_units: *n_units, ends, parts };
        if missing.is_empty() { Ok(parts) } else { Err(missing) }
    }
}

impl Parts {
    fn load(&mut self, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let place = self.ends.partition_point(|end| *end <= unit);
        let Some(part) = self.parts.get_mut(place) else { return Ok(None) };
        part.load(&self.phase, unit as u64).map_err(|error| Halt::Store(error.to_string()))
    }
}

impl UnitStore for JobStore {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        let mut state = self.lock();
        let place = state.n_begun;
        state.n_begun += 1;
        if state.job.manifest.phases.len() <= place {
            if self.own.is_some() {
                return Err(Halt::Store(format!("the job has no phase {} yet", phase.name)));
            }
            let shards = cut(phase.costs, state.job.manifest.max_shards);
            let plan = PhasePlan { name: phase.name.to_owned(), n_units: phase.costs.len(), shards };
            state.job.add_phase(plan).map_err(|error| Halt::Store(error.to_string()))?;
            let shards = state.job.manifest.shards_of(place);
            if !phase.costs.is_empty() {
                return Err(state.end_with(Outcome::Planned { phase: place, shards }));
            }
            // Nobody has anything to do for it.
            let saved = shards.into_iter().try_for_each(|shard| state.job.save_part(shard, phase.name, &[]));
            saved.map_err(|error| Halt::Store(error.to_string()))?;
        }
        let plan = &state.job.manifest.phases[place];
        if plan.name != phase.name || plan.n_units != phase.costs.len() {
            let (name, n, found) = (&plan.name, plan.n_units, phase.costs.len());
            return Err(Halt::Store(format!(
                "the job was planned with {n} units of phase {name}, and there are {found} of {}: the input is another",
                phase.name
            )));
        }
        if let Some(own) = self.own_of(phase.name) {
            own.take_up(&state.job);
            return Ok(());
        }
        match state.open_parts(place) {
            Ok(parts) => state.parts = Some(parts),
            Err(shards) => return Err(state.end_with(Outcome::Missing { phase: place, shards })),
        }
        Ok(())
    }

    fn wants(&self, phase: &'static str, unit: usize) -> bool {
        self.own_of(phase).is_some_and(|own| own.has(unit))
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let mut state = self.lock();
        if let Some(own) = self.own_of(phase) {
            return own.load(&state.job, phase, unit);
        }
        match &mut state.parts {
            Some(parts) if parts.phase == phase => parts.load(unit),
            _ => Ok(None),
        }
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        match self.own_of(phase) {
            Some(own) => own.save(&self.lock().job, phase, unit, result),
            None => Err(Halt::Store(format!("unit {unit} of phase {phase} is none of this process"))),
        }
    }

    fn end(&self, phase: &'static str) -> Result<(), Halt> {
        let mut state = self.lock();
        let Some(own) = self.own_of(phase) else {
            // Nothing of the phase is loaded any more, and open files are few.
            state.parts = None;
            return Ok(());
        };
        own.end(&state.job, phase)?;
        Err(state.end_with(Outcome::Done))
    }

    fn runs(&self, phase: &'static str) -> Option<Vec<Range<usize>>> {
        if let Some(own) = self.own_of(phase) {
            return Some(own.runs());
        }
        // The order of parts is that of reading.
        self.lock().parts.as_ref().map(|parts| std::iter::once(0..parts.n_units).collect())
    }

    fn needs_costs(&self) -> bool {
        let state = self.lock();
        state.job.manifest.phases.len() <= state.n_begun
    }
}
