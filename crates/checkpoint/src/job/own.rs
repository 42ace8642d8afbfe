//! The shards that a process computes.

use super::{JOURNAL, Job, JobError};
use crate::error::StateError;
use crate::index::Results;
use crate::journal::{Journal, OpenMode};
use sightlines_formats::process_mark;
use sightlines_progress::{Halt, UnitStore};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Shards of one phase, in ascending order.
#[derive(Debug)]
pub(super) struct OwnShards {
    phase: String,
    shards: Vec<OwnShard>,
}

/// A shard, and what there is of it.
#[derive(Debug)]
struct OwnShard {
    shard: usize,
    units: Range<usize>,
    work: Mutex<Work>,
}

#[derive(Debug)]
struct Work {
    /// None once the part is written.
    journal: Option<Journal>,
    /// Journals of other processes; the part, once it is written.
    others: Vec<Results>,
    /// Units without a result.
    missing: Vec<bool>,
    n_missing: usize,
}

impl OwnShards {
    /// Shards of a job, each named once, whose results are kept in journals after a while.
    pub(super) fn new(job: &Job, shards: &[usize], after: Duration) -> Result<Self, JobError> {
        let mut sorted = shards.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        let mut places = Vec::with_capacity(sorted.len());
        for &shard in &sorted {
            places.push(job.shard(shard)?.0);
        }
        if let Some(k) = places.windows(2).position(|pair| pair[0] != pair[1]) {
            let path = job.folder().join(super::MANIFEST);
            return Err(JobError::TwoPhases { path, shards: [sorted[k], sorted[k + 1]] });
        }
        let phase = places.first().map_or_else(String::new, |&place| job.manifest().phases[place].name.clone());
        let shards = sorted.into_iter().map(|shard| OwnShard::new(job, shard, after)).collect::<Result<_, _>>()?;
        Ok(Self { phase, shards })
    }

    /// Whether the shards are of a phase.
    pub(super) fn are_of(&self, phase: &str) -> bool {
        self.phase == phase
    }

    /// The units of all of them.
    pub(super) fn runs(&self) -> Vec<Range<usize>> {
        self.shards.iter().map(|own| own.units.clone()).collect()
    }

    /// Takes up what other processes have found.
    pub(super) fn take_up(&self, job: &Job) {
        self.shards.iter().for_each(|own| own.lock().others = job.journals(own.shard));
    }

    fn of(&self, unit: usize) -> Option<&OwnShard> {
        let place = self.shards.partition_point(|own| own.units.end <= unit);
        self.shards.get(place).filter(|own| own.units.contains(&unit))
    }

    /// Whether a unit is of one of the shards.
    pub(super) fn has(&self, unit: usize) -> bool {
        self.of(unit).is_some()
    }

    /// The result of a unit; with the last one of a shard, the part is written.
    pub(super) fn load(&self, job: &Job, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        let Some(own) = self.of(unit) else { return Ok(None) };
        let mut work = own.lock();
        let found = work.load(phase, unit)?;
        if found.is_some() {
            own.found(&mut work, job, phase, unit)?;
        }
        Ok(found)
    }

    /// Keeps the result of a unit; with the last one of a shard, the part is written.
    pub(super) fn save(&self, job: &Job, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        let Some(own) = self.of(unit) else {
            return Err(Halt::Store(format!("unit {unit} of phase {phase} is none of this process")));
        };
        let mut work = own.lock();
        if let Some(journal) = &work.journal {
            journal.save(phase, unit, result)?;
        }
        own.found(&mut work, job, phase, unit)
    }

    /// Writes the parts of shards without units; all others are written.
    pub(super) fn end(&self, job: &Job, phase: &'static str) -> Result<(), Halt> {
        for own in &self.shards {
            let mut work = own.lock();
            if let Some(unit) = work.missing.iter().position(|missing| *missing) {
                let unit = own.units.start + unit;
                return Err(Halt::Store(format!("unit {unit} of phase {phase} was not computed")));
            }
            own.finish(&mut work, job, phase)?;
        }
        Ok(())
    }

    /// Writes what is in memory to journals.
    pub(super) fn flush(&self) -> Result<(), Halt> {
        let flush = |own: &OwnShard| own.lock().journal.as_ref().map_or(Ok(()), Journal::flush);
        self.shards.iter().try_for_each(flush).map_err(|error| Halt::Store(error.to_string()))
    }
}

impl OwnShard {
    fn new(job: &Job, shard: usize, after: Duration) -> Result<Self, JobError> {
        let plan = job.shard(shard)?.1;
        // A process may have several stores.
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let mark = format!("{}-{}", process_mark(), COUNT.fetch_add(1, Relaxed));
        let path: PathBuf = job.part_path(shard).with_extension(format!("part.{mark}{JOURNAL}"));
        let (key, program) = (job.key(), &job.manifest().program);
        job.make_folder_of(shard)?;
        // What an earlier process with this number left is read with all other journals.
        let opening = if path.exists() { OpenMode::Resume } else { OpenMode::Anew };
        let journal = Journal::open(&path, key, program, opening, after);
        let journal = journal.or_else(|_| Journal::open(&path, key, program, OpenMode::Anew, after));
        let journal = Some(journal.map_err(|error: StateError| JobError::State(Box::new(error)))?);
        let (units, n) = (plan.begin..plan.end, plan.end - plan.begin);
        let work = Work { journal, others: Vec::new(), missing: vec![true; n], n_missing: n };
        Ok(Self { shard, units, work: Mutex::new(work) })
    }

    fn lock(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn found(&self, work: &mut Work, job: &Job, phase: &'static str, unit: usize) -> Result<(), Halt> {
        if std::mem::take(&mut work.missing[unit - self.units.start]) {
            work.n_missing -= 1;
        }
        if work.n_missing == 0 { self.finish(work, job, phase) } else { Ok(()) }
    }

    /// Writes the part, once.
    fn finish(&self, work: &mut Work, job: &Job, phase: &'static str) -> Result<(), Halt> {
        if work.journal.is_none() {
            return Ok(());
        }
        let mut results = Vec::with_capacity(self.units.len());
        for unit in self.units.clone() {
            match work.load(phase, unit)? {
                Some(result) => results.push((unit as u64, result)),
                None => return Err(Halt::Store(format!("unit {unit} of phase {phase} was lost"))),
            }
        }
        let failed = |error: &dyn std::fmt::Display| Halt::Store(error.to_string());
        job.save_part(self.shard, phase, &results).map_err(|error| failed(&error))?;
        let mut part = Results::read(&job.part_path(self.shard), &job.owner()).map_err(|error| failed(&error))?;
        // It is rarely read again, and a process may have many shards.
        part.iter_mut().for_each(Results::close);
        (work.journal, work.others) = (None, part.into_iter().collect());
        Ok(())
    }
}

impl Work {
    fn load(&mut self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        if let Some(result) = self.journal.as_ref().map_or(Ok(None), |journal| journal.load(phase, unit))? {
            return Ok(Some(result));
        }
        match self.others.iter_mut().find(|of| of.has(phase, unit as u64)) {
            Some(of) => of.load(phase, unit as u64).map_err(|error| Halt::Store(error.to_string())),
            None => Ok(None),
        }
    }
}
