//! The store of a bake that is part of a job.

use super::claims::{Claim, Claims, batch};
use super::cut::cut;
use super::manifest::PhasePlan;
use super::own::OwnShards;
use super::{Job, JobError, ShardState};
use crate::index::Results;
use crate::key::KeyHasher;
use sightlines_formats::atomic_write;
use sightlines_progress::{Cancelled, Halt, Pass, Phase, UnitStore};
use std::collections::VecDeque;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// What a process does for a job.
#[derive(Debug, Clone)]
pub enum JobRole {
    /// Goes through the bake with the results of all parts: it ends at the first phase that is not complete, and plans one that is not known.
    Merge,
    /// Computes the units of these shards, which are all of one phase: one shard after the other, in ascending order. Each part is written as soon as its units are done,
    /// and does not depend on which other shards the process does.
    Shards(Vec<usize>),
    /// Goes through all of the bake with others of its kind: of each phase it computes shards that nobody has claimed, some at once; waits until the others are done, or
    /// claims those of processes that have ended; and goes on with the results of all. One of them writes what the bake makes.
    Worker {
        /// How many there are, about.
        n_workers: usize,
        /// Whether to end while it waits.
        stop: fn() -> bool,
    },
}

impl JobRole {
    /// Computes the units of one shard.
    pub fn shard(shard: usize) -> Self {
        Self::Shards(vec![shard])
    }
}

/// How far a process came.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum JobProgress {
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
    /// The parts of all shards of the process are written; for a worker, those of all phases, and another worker has written what the bake makes.
    Done,
}

/// How long a worker waits between two looks at the parts of others: at first, and at most.
const LOOKS: [Duration; 2] = [Duration::from_millis(5), Duration::from_millis(200)];

/// Shards that a waiting worker tries to claim at each look, at most.
const TRIED: usize = 32;

/// Parts of a phase that are open at once, at most.
const OPEN: usize = 32;

/// A store of units in the folder of a job.
#[derive(Debug)]
pub struct JobStore {
    role: JobRole,
    /// How long results of a shard are only in memory.
    after: Duration,
    /// The shards that the process computes now.
    own: Mutex<Option<Arc<OwnShards>>>,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    job: Job,
    /// How many phases have begun.
    n_begun: usize,
    /// Those of the phase under way, if it is complete.
    parts: Option<Parts>,
    /// Of a worker: those of its shards.
    claims: Claims,
    /// Of the worker that writes: its claim, and the file that says that it has written.
    writing: Option<(Claim, PathBuf)>,
    outcome: Option<JobProgress>,
}

/// The parts of a phase, in order.
#[derive(Debug)]
struct Parts {
    phase: String,
    n_units: usize,
    /// Behind the last unit of each.
    ends: Vec<usize>,
    parts: Vec<Results>,
    /// Those that are open, by their places; the one that was opened last comes last.
    open: VecDeque<usize>,
}

impl JobStore {
    /// The store of a process with this role. Results of a shard are kept in a journal after a while.
    ///
    /// # Errors
    /// [`JobError::NoShard`], and [`JobError::TwoPhases`].
    pub fn new(job: Job, role: JobRole, after: Duration) -> Result<Self, JobError> {
        let own = match &role {
            JobRole::Merge | JobRole::Worker { .. } => None,
            JobRole::Shards(shards) => Some(Arc::new(OwnShards::new(&job, shards, after)?)),
        };
        let state = State { job, n_begun: 0, parts: None, claims: Claims::default(), writing: None, outcome: None };
        Ok(Self { role, after, own: Mutex::new(own), state: Mutex::new(state) })
    }

    /// Why the bake ended early, if the store ended it.
    pub fn outcome(&self) -> Option<JobProgress> {
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
        self.own().map_or(Ok(()), |own| own.flush())
    }

    /// Before anything is written that the bake makes. Of workers, one writes; the others wait for it, and take over if it ends before it has written.
    ///
    /// * `outputs`: the files or folders
    ///
    /// # Errors
    /// [`Halt::Shared`] if another worker has written them, [`Halt::Cancelled`] if the worker is to end, [`Halt::Store`] if nothing can be claimed.
    pub fn begin_writing(&self, outputs: &[PathBuf]) -> Result<(), Halt> {
        let JobRole::Worker { stop, .. } = self.role else { return Ok(()) };
        let mut state = self.lock();
        if state.writing.is_some() {
            return Ok(());
        }
        let mut hasher = KeyHasher::new("");
        outputs.iter().for_each(|path| hasher.value("output", path.as_os_str().as_encoded_bytes()));
        let path = state.job.folder().join(format!("{}.written", hasher.finish()));
        let claim = wait_for(&path.with_extension("writing.claim"), LOOKS[1], stop)?;
        if path.is_file() && outputs.iter().all(|output| output.exists()) {
            return Err(state.end_with(JobProgress::Done));
        }
        state.writing = Some((claim, path));
        Ok(())
    }

    /// After everything is written: no other worker does it again.
    ///
    /// # Errors
    /// [`JobError::Write`].
    pub fn end_writing(&self) -> Result<(), JobError> {
        match self.lock().writing.take() {
            Some((_claim, path)) => Ok(atomic_write(path, b"")?),
            None => Ok(()),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn own(&self) -> Option<Arc<OwnShards>> {
        self.own.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The shards of this process, if they are of a phase.
    fn own_of(&self, phase: &str) -> Option<Arc<OwnShards>> {
        self.own().filter(|own| own.are_of(phase))
    }

    fn set_own(&self, own: Option<OwnShards>) {
        *self.own.lock().unwrap_or_else(PoisonError::into_inner) = own.map(Arc::new);
    }

    /// What a worker does next for a phase: shards that it claims, or, once all are done, everything.
    fn next_pass(&self, state: &mut State, phase: usize, n_workers: usize, stop: fn() -> bool) -> Result<(), Halt> {
        // Others may claim what was this worker's from here on.
        state.claims = Claims::default();
        self.set_own(None);
        let shards = state.job.manifest.shards_of(phase);
        let n = shards.len();
        let (mut left, mut look, mut n_looks) = (shards.collect::<Vec<usize>>(), LOOKS[0], 0_usize);
        loop {
            if stop() {
                return Err(Halt::Cancelled(Cancelled));
            }
            left.retain(|&shard| !state.job.part_path(shard).is_file());
            if left.is_empty() {
                return state.open(phase);
            }
            // While others are at work on all that is left, a few are looked at each time, each worker beginning elsewhere.
            let is_first = look == LOOKS[0];
            let from =
                if is_first { 0 } else { (std::process::id() as usize).wrapping_add(n_looks * TRIED) % left.len() };
            let some = left[from..].iter().chain(&left[..from]).copied().take(if is_first { n } else { TRIED });
            let claims = Claims::of(&state.job, some, batch(left.len(), n, n_workers)).map_err(failed)?;
            n_looks += 1;
            if !claims.shards.is_empty() {
                let own = OwnShards::new(&state.job, &claims.shards, self.after).map_err(failed)?;
                own.take_up(&state.job);
                state.claims = claims;
                self.set_own(Some(own));
                return Ok(());
            }
            sleep(look);
            look = (look * 2).min(LOOKS[1]);
        }
    }
}

/// Claims a file, once no other process has it.
fn wait_for(path: &Path, look: Duration, stop: fn() -> bool) -> Result<Claim, Halt> {
    loop {
        if let Some(claim) = Claim::of(path.to_owned()).map_err(failed)? {
            return Ok(claim);
        }
        if stop() {
            return Err(Halt::Cancelled(Cancelled));
        }
        sleep(look);
    }
}

fn failed(error: JobError) -> Halt {
    Halt::Store(error.to_string())
}

impl State {
    /// Opens the parts of a phase; without all of them this process ends.
    fn open(&mut self, phase: usize) -> Result<(), Halt> {
        match self.open_parts(phase) {
            Ok(parts) => self.parts = Some(parts),
            Err(shards) => return Err(self.end_with(JobProgress::Missing { phase, shards })),
        }
        Ok(())
    }

    /// Plans a phase together with other workers: one does it, and the others take what it has written.
    fn plan_together(&mut self, phase: &Phase<'_>, place: usize, stop: fn() -> bool) -> Result<(), Halt> {
        let _claim = wait_for(&self.job.folder().join("planning.claim"), LOOKS[0], stop)?;
        self.job.read_again().map_err(failed)?;
        if self.job.manifest.phases.len() <= place {
            self.plan(phase).map_err(failed)?;
        }
        Ok(())
    }

    /// Cuts a phase into shards, and adds it to the manifest.
    fn plan(&mut self, phase: &Phase<'_>) -> Result<(), JobError> {
        // The results of a chain are found one after the other, so others could only wait.
        let shards = cut(phase.costs, if phase.is_chain { 1 } else { self.job.manifest.max_shards });
        self.job.add_phase(PhasePlan { name: phase.name.to_owned(), n_units: phase.costs.len(), shards })?;
        if phase.costs.is_empty() {
            // Nobody has anything to do for it.
            let mut shards = self.job.manifest.shards_of(self.job.manifest.phases.len() - 1);
            shards.try_for_each(|shard| self.job.save_part(shard, phase.name, &[]))?;
        }
        Ok(())
    }

    fn end_with(&mut self, outcome: JobProgress) -> Halt {
        self.outcome = Some(outcome);
        Halt::Shared
    }

    /// The parts of a phase, or what is missing of them.
    fn open_parts(&self, phase: usize) -> Result<Parts, Vec<(usize, ShardState)>> {
        let PhasePlan { name, n_units, shards } = &self.job.manifest.phases[phase];
        let (mut parts, mut missing) = (Vec::new(), Vec::new());
        for (shard, plan) in self.job.manifest.shards_of(phase).zip(shards) {
            match self.job.part(shard, name, plan) {
                Ok(Some(mut part)) => {
                    // There may be more of them than a process may have open files.
                    part.close();
                    parts.push(part);
                }
                Ok(None) => missing.push((shard, self.job.state(shard).unwrap_or(ShardState::Missing))),
                Err(error) => missing.push((shard, ShardState::Broken(error.to_string()))),
            }
        }
        let ends = shards.iter().map(|plan| plan.end).collect();
        let parts = Parts { phase: name.clone(), n_units: *n_units, ends, parts, open: VecDeque::new() };
        if missing.is_empty() { Ok(parts) } else { Err(missing) }
    }
}

impl Parts {
    fn load(&mut self, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let place = self.ends.partition_point(|end| *end <= unit);
        if !self.open.contains(&place) {
            self.open.push_back(place);
            let first = if self.open.len() > OPEN { self.open.pop_front() } else { None };
            first.and_then(|first| self.parts.get_mut(first)).into_iter().for_each(Results::close);
        }
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
            match self.role {
                JobRole::Shards(_) => return Err(Halt::Store(format!("the job has no phase {} yet", phase.name))),
                JobRole::Worker { stop, .. } => state.plan_together(phase, place, stop)?,
                JobRole::Merge => {
                    state.plan(phase).map_err(failed)?;
                    let shards = state.job.manifest.shards_of(place);
                    if !phase.costs.is_empty() {
                        return Err(state.end_with(JobProgress::Planned { phase: place, shards }));
                    }
                }
            }
        }
        let Some(plan) = state.job.manifest.phases.get(place) else {
            return Err(Halt::Store(format!("the manifest of the job has lost the phase before {}", phase.name)));
        };
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
        match self.role {
            JobRole::Worker { n_workers, stop } => self.next_pass(&mut state, place, n_workers, stop),
            _ => state.open(place),
        }
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

    fn end(&self, phase: &'static str) -> Result<Pass, Halt> {
        let mut state = self.lock();
        let Some(own) = self.own_of(phase) else {
            // Nothing of the phase is loaded any more, and open files are few.
            state.parts = None;
            return Ok(Pass::Last);
        };
        own.end(&state.job, phase)?;
        let JobRole::Worker { n_workers, stop } = self.role else { return Err(state.end_with(JobProgress::Done)) };
        let place = state.n_begun - 1;
        self.next_pass(&mut state, place, n_workers, stop)?;
        Ok(Pass::Again)
    }

    fn runs(&self, phase: &'static str) -> Option<Vec<Range<usize>>> {
        if let Some(own) = self.own_of(phase) {
            return Some(own.runs());
        }
        // The order of parts is that of reading.
        self.lock().parts.as_ref().map(|parts| std::iter::once(0..parts.n_units).collect())
    }

    fn needs_costs(&self) -> bool {
        let mut state = self.lock();
        if state.job.manifest.phases.len() <= state.n_begun && matches!(self.role, JobRole::Worker { .. }) {
            // Another worker may have planned it. If that cannot be read, costs are only computed for nothing.
            let _ = state.job.read_again();
        }
        state.job.manifest.phases.len() <= state.n_begun
    }

    fn has_all(&self, phase: &'static str) -> bool {
        self.own_of(phase).is_none()
    }
}
