//! All of a job: round by round, and merged.

use super::{Did, Engine, EngineError, Host, Round};
use crate::job::{Job, JobError, ShardState};
use std::fs;
use std::path::Path;

/// How far a merge came.
#[derive(Debug)]
pub enum Merge<T> {
    /// The output is written.
    Written(T),
    /// The next phase is known, and its shards are to be done.
    Planned,
    /// Shards of a phase are not done.
    Missing {
        /// The place of the phase.
        phase: usize,
        /// The shards, and what there is of each.
        shards: Vec<(usize, ShardState)>,
    },
}

/// How rounds have ended.
#[derive(Debug)]
pub enum Rounds<T> {
    /// The output was written by the merge.
    Merged(T),
    /// The output was written by a process of the engine, which had this to tell.
    Elsewhere(Option<String>),
    /// Shards have failed as often as they may.
    Missing {
        /// The place of the phase.
        phase: usize,
        /// The shards, and what there is of each.
        shards: Vec<(usize, ShardState)>,
    },
}

/// Has all shards of the job in a folder done by an engine, phase by phase, and merges them. Sound parts of earlier runs count; parts that are found to be
/// broken are removed, and done again.
///
/// * `program`: the version of the program that planned the job
/// * `retries`: how often shards of a phase that have failed are tried again
/// * `merge`: puts all parts together, as far as there are any
///
/// # Errors
/// [`EngineError`] in all that ends the work, and the errors of `merge`.
pub fn run_rounds<T, E: From<EngineError>>(
    (folder, program): (&Path, &str),
    (engine, retries): (&dyn Engine, u32),
    host: &Host<'_>,
    mut merge: impl FnMut() -> Result<Merge<T>, E>,
) -> Result<Rounds<T>, E> {
    let open = || Job::open(folder, program).map_err(EngineError::from);
    let mut tries = Tries { phase: None, n: 0 };
    loop {
        let job = open()?;
        if let Some((phase, shards)) = undone(&job).map_err(EngineError::from)? {
            if tries.count(phase) > retries + 1 {
                let state = |shard| Ok((shard, job.state(shard)?));
                let shards =
                    shards.into_iter().map(state).collect::<Result<_, JobError>>().map_err(EngineError::from)?;
                return Ok(Rounds::Missing { phase, shards });
            }
            if let Did::Output(told) = engine.run(&Round { job: &job, phase, shards: &shards }, tries.n, host)? {
                return Ok(Rounds::Elsewhere(told));
            }
        }
        if (host.stop)() {
            return Err(EngineError::Stopped.into());
        }
        let job = open()?;
        if undone(&job).map_err(EngineError::from)?.is_some() {
            continue;
        }
        match merge()? {
            Merge::Planned => {}
            // Broken parts, which look like parts.
            Merge::Missing { phase, shards } => {
                shards.iter().for_each(|(shard, _)| remove_damaged(&job, *shard));
                if tries.n > retries {
                    return Ok(Rounds::Missing { phase, shards });
                }
            }
            Merge::Written(written) => return Ok(Rounds::Merged(written)),
        }
    }
}

/// How often the shards of a phase were tried.
struct Tries {
    phase: Option<usize>,
    n: u32,
}

impl Tries {
    /// Counts a try, and returns how many there were of this phase.
    fn count(&mut self, phase: usize) -> u32 {
        if self.phase.replace(phase) != Some(phase) {
            self.n = 0;
        }
        self.n += 1;
        self.n
    }
}

/// The first phase with shards that have no sound part, and these shards.
fn undone(job: &Job) -> Result<Option<(usize, Vec<usize>)>, JobError> {
    for phase in 0..job.manifest().phases.len() {
        let mut shards = Vec::new();
        for shard in job.manifest().shards_of(phase) {
            if job.state(shard)? != ShardState::Done {
                shards.push(shard);
            }
        }
        if !shards.is_empty() {
            return Ok(Some((phase, shards)));
        }
    }
    Ok(None)
}

/// Removes the part of a shard if it is damaged. What cannot be read now may be sound, and what was not there may have been written meanwhile.
fn remove_damaged(job: &Job, shard: usize) {
    if job.has_damaged_part(shard).is_ok_and(|is_damaged| is_damaged) {
        // If it cannot be removed, it is found to be broken again.
        let _ = fs::remove_file(job.part_path(shard));
    }
}
