//! The store of a bake that is part of a job.

use super::cut::cut;
use super::manifest::PhasePlan;
use super::{JOURNAL, Job, JobError, ShardState};
use crate::error::StateError;
use crate::index::Results;
use crate::journal::{Journal, Opening};
use sightlines_formats::process_mark;
use sightlines_progress::{Halt, Phase, UnitStore};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What a process does for a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Goes through the bake with the results of all parts: it ends at the first phase that is not complete, and plans one that is not known.
    Merge,
    /// Computes the units of one shard, and writes its part.
    Shard(usize),
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
        shards: std::ops::Range<usize>,
    },
    /// Shards of a phase are not done.
    Missing {
        /// The place of the phase.
        phase: usize,
        /// The shards, and what there is of each.
        shards: Vec<(usize, ShardState)>,
    },
    /// The part of the shard is written.
    Done,
}

/// A store of units in the folder of a job.
#[derive(Debug)]
pub struct JobStore {
    role: Role,
    /// For the phase of the shard.
    own: Option<Own>,
    state: Mutex<State>,
}

/// The shard that a process computes.
#[derive(Debug)]
struct Own {
    shard: usize,
    phase: String,
    begin: usize,
    end: usize,
    journal: Journal,
}

#[derive(Debug)]
struct State {
    job: Job,
    /// How many phases have begun.
    n_begun: usize,
    /// Parts of the phases before, and of this one if it is complete; of the phase under way, journals of others.
    parts: Vec<(String, Vec<Results>)>,
    outcome: Option<Outcome>,
}

impl JobStore {
    /// The store of a process with this role. Results of a shard are kept in a journal after a while.
    ///
    /// # Errors
    /// [`JobError::NoShard`].
    pub fn new(job: Job, role: Role, after: Duration) -> Result<Self, JobError> {
        let own = match role {
            Role::Merge => None,
            Role::Shard(shard) => Some(Own::new(&job, shard, after)?),
        };
        let state = State { job, n_begun: 0, parts: Vec::new(), outcome: None };
        Ok(Self { role, own, state: Mutex::new(state) })
    }

    /// Why the bake ended early, if the store ended it.
    pub fn outcome(&self) -> Option<Outcome> {
        self.lock().outcome.clone()
    }

    /// The job, with phases that were planned.
    pub fn job(&self) -> Job {
        self.lock().job.clone()
    }

    /// Keeps results that are in memory for a later run of the same shard.
    ///
    /// # Errors
    /// [`Halt::Store`] if they cannot be written.
    pub fn flush(&self) -> Result<(), Halt> {
        self.own.as_ref().map_or(Ok(()), |own| own.journal.flush().map_err(|error| Halt::Store(error.to_string())))
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The shard of this process, if it is of a phase.
    fn own_of(&self, phase: &str) -> Option<&Own> {
        self.own.as_ref().filter(|own| own.phase == phase)
    }
}

impl Own {
    fn new(job: &Job, shard: usize, after: Duration) -> Result<Self, JobError> {
        let (phase, plan) = job.shard(shard)?;
        // A process may have several stores.
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let mark = format!("{}-{}", process_mark(), COUNT.fetch_add(1, Relaxed));
        let path: PathBuf = job.part_path(shard).with_extension(format!("part.{mark}{JOURNAL}"));
        let (key, program) = (job.key(), &job.manifest().program);
        // What an earlier process with this number left is read with all other journals.
        let opening = if path.exists() { Opening::Resume } else { Opening::Anew };
        let journal = Journal::open(&path, key, program, opening, after);
        let journal = journal.or_else(|_| Journal::open(&path, key, program, Opening::Anew, after));
        let read = |error: StateError| JobError::State(Box::new(error));
        let phase = job.manifest().phases[phase].name.clone();
        Ok(Self { shard, phase, begin: plan.begin, end: plan.end, journal: journal.map_err(read)? })
    }

    fn has(&self, unit: usize) -> bool {
        (self.begin..self.end).contains(&unit)
    }
}

impl State {
    fn end_with(&mut self, outcome: Outcome) -> Halt {
        self.outcome = Some(outcome);
        Halt::Shared
    }

    /// The parts of a phase, or what is missing of them.
    fn open_parts(&self, phase: usize) -> Result<Vec<Results>, Vec<(usize, ShardState)>> {
        let PhasePlan { name, shards, .. } = &self.job.manifest.phases[phase];
        let (mut parts, mut missing) = (Vec::new(), Vec::new());
        for (shard, plan) in self.job.manifest.shards_of(phase).zip(shards) {
            match self.job.part(shard, name, plan) {
                Ok(Some(part)) => parts.push(part),
                _ => missing.push((shard, self.job.state(shard).unwrap_or(ShardState::Missing))),
            }
        }
        if missing.is_empty() { Ok(parts) } else { Err(missing) }
    }

    fn load(&mut self, phase: &str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let of_phase = self.parts.iter_mut().find(|(name, _)| name == phase);
        for part in of_phase.into_iter().flat_map(|(_, parts)| parts) {
            if part.has(phase, unit as u64) {
                return part.load(phase, unit as u64).map_err(|error| Halt::Store(error.to_string()));
            }
        }
        Ok(None)
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
        let parts = match self.own_of(phase.name) {
            Some(own) => state.job.journals(own.shard),
            None => match state.open_parts(place) {
                Ok(parts) => parts,
                Err(shards) => return Err(state.end_with(Outcome::Missing { phase: place, shards })),
            },
        };
        state.parts.push((phase.name.to_owned(), parts));
        Ok(())
    }

    fn wants(&self, phase: &'static str, unit: usize) -> bool {
        self.own_of(phase).is_some_and(|own| own.has(unit))
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        if let Some(own) = self.own_of(phase) {
            if !own.has(unit) {
                return Ok(None);
            }
            if let Some(result) = own.journal.load(phase, unit)? {
                return Ok(Some(result));
            }
        }
        self.lock().load(phase, unit)
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        match self.own_of(phase) {
            Some(own) => own.journal.save(phase, unit, result),
            None => Err(Halt::Store(format!("unit {unit} of phase {phase} is none of this process"))),
        }
    }

    fn end(&self, phase: &'static str) -> Result<(), Halt> {
        let Some(own) = self.own_of(phase) else {
            // Nothing of the phase is loaded any more, and open files are few.
            self.lock().parts.retain(|(name, _)| name != phase);
            return Ok(());
        };
        let mut results = Vec::with_capacity(own.end - own.begin);
        for unit in own.begin..own.end {
            match self.load(phase, unit)? {
                Some(result) => results.push((unit as u64, result)),
                None => return Err(Halt::Store(format!("unit {unit} of phase {phase} was not computed"))),
            }
        }
        let mut state = self.lock();
        let saved = state.job.save_part(own.shard, phase, &results);
        saved.map_err(|error| Halt::Store(error.to_string()))?;
        Err(state.end_with(Outcome::Done))
    }
}

impl JobStore {
    /// What the process does.
    pub fn role(&self) -> Role {
        self.role
    }
}
