//! What is printed about a job.

use super::task::Made;
use crate::output::{JsonSchema, Serialize, count, percent, seconds_of};
use crate::progress::rough;
use sightlines::checkpoint::{Job, PhasePlan, ShardState, in_words};
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// A phase of a job, and its shards.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct PhaseFacts {
    /// Name of the phase.
    phase: String,
    /// Units of work of the phase.
    n_units: usize,
    /// The number of its first shard; the others follow.
    first_shard: usize,
    /// Shards that the phase is cut into.
    n_shards: usize,
    /// The share of the phase's predicted cost that its most costly shard has.
    largest_share: f64,
}

impl PhaseFacts {
    pub(super) fn new(job: &Job, phase: usize) -> Self {
        let PhasePlan { name, n_units, shards } = &job.manifest().phases[phase];
        let all: f64 = shards.iter().map(|shard| shard.cost).sum();
        let largest = shards.iter().map(|shard| shard.cost).fold(0.0, f64::max);
        Self {
            phase: name.clone(),
            n_units: *n_units,
            first_shard: job.manifest().shards_of(phase).start,
            n_shards: shards.len(),
            largest_share: if all > 0.0 { largest / all } else { 0.0 },
        }
    }
}

impl fmt::Display for PhaseFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { phase, n_units, first_shard, n_shards, largest_share } = self;
        let shards = in_words(&(*first_shard..first_shard + n_shards).collect::<Vec<_>>());
        let units = count(*n_units as u64, "unit");
        write!(f, "{shards}, of {units} of phase {phase}; the largest has {} of the cost", percent(*largest_share))
    }
}

/// What was planned.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Planned {
    /// The folder of the job.
    job: String,
    /// None if the work has nothing that can be shared.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    phase: Option<PhaseFacts>,
    /// What was written, if there was nothing to share.
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
}

impl Planned {
    pub(super) fn new(name: String, job: &Job, phase: Option<usize>, out: Option<&Path>) -> Self {
        let phase = phase.map(|phase| PhaseFacts::new(job, phase));
        Self { job: name, phase, out: out.map(|out| out.display().to_string()) }
    }
}

impl fmt::Display for Planned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.phase, &self.out) {
            (Some(phase), _) => writeln!(f, "planned {}: {phase}", self.job),
            (None, Some(out)) => writeln!(f, "wrote {out}: there was nothing to share"),
            (None, None) => Ok(()),
        }
    }
}

/// What `job shard` has done.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct ShardsDone {
    /// The folder of the job.
    pub(super) job: String,
    /// Each shard, in ascending order.
    pub(super) shards: Vec<ShardDone>,
    /// Seconds in all.
    pub(super) seconds: f64,
}

/// What one shard gave.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ShardDone {
    /// The number of the shard.
    pub(super) shard: usize,
    /// Its phase.
    pub(super) phase: String,
    /// Its first unit.
    pub(super) begin: usize,
    /// The unit behind its last one.
    pub(super) end: usize,
    /// Whether its part was there already.
    pub(super) was_done: bool,
}

impl fmt::Display for ShardsDone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for ShardDone { shard, phase, begin, end, was_done } in &self.shards {
            let units = count((end - begin) as u64, "unit");
            let how = if *was_done { "done already" } else { "done" };
            writeln!(f, "shard {shard} of {}: {units} of phase {phase}, {how}", self.job)?;
        }
        writeln!(f, "in {}", seconds_of(self.seconds))
    }
}

/// Shards of a phase that are not done.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct Missing {
    /// Their phase.
    phase: String,
    /// Numbers of shards without a part.
    missing: Vec<usize>,
    /// Shards whose part cannot be used.
    broken: Vec<Broken>,
}

/// A shard whose part cannot be used.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct Broken {
    /// The number of the shard.
    shard: usize,
    /// What is wrong, with the name of the file.
    reason: String,
}

impl Missing {
    pub(super) fn new(job: &Job, phase: usize, shards: Vec<(usize, ShardState)>) -> Self {
        let (mut missing, mut broken) = (Vec::new(), Vec::new());
        for (shard, state) in shards {
            match state {
                ShardState::Broken(reason) => broken.push(Broken { shard, reason }),
                ShardState::Missing | ShardState::Partial(_) => missing.push(shard),
                ShardState::Done => {}
            }
        }
        Self { phase: job.manifest().phases[phase].name.clone(), missing, broken }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.missing.is_empty() {
            writeln!(f, "missing        {}", in_words(&self.missing))?;
        }
        self.broken
            .iter()
            .try_for_each(|Broken { shard, reason }| writeln!(f, "broken         shard {shard}: {reason}"))
    }
}

/// Exit code 3 if shards are to be done, first or again.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Merged {
    /// The folder of the job.
    job: String,
    /// `written`, `shared` (of `job work`: all is done, and another worker has written the output), `planned` (the shards of the next phase are to
    /// be done) or `missing` (shards are to be done, or done again).
    status: &'static str,
    /// What was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
    /// With `planned`: the next phase.
    #[serde(skip_serializing_if = "Option::is_none")]
    next: Option<PhaseFacts>,
    /// With `missing`: which shards.
    #[serde(skip_serializing_if = "Option::is_none")]
    undone: Option<Missing>,
    /// With `written`: what the command prints; with `shared`: that another worker has written it.
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<String>,
}

impl Merged {
    pub(super) fn written(job: String, out: &Path, made: &Made) -> Self {
        Self::elsewhere(job, out, Some(made.to_string()))
    }

    /// Written by another process, which has printed this.
    pub(super) fn elsewhere(job: String, out: &Path, text: Option<String>) -> Self {
        let out = Some(out.display().to_string());
        Self { job, status: "written", out, next: None, undone: None, text }
    }

    pub(super) fn shared(job: String, out: &Path) -> Self {
        let text = format!("done; another worker has written {}\n", out.display());
        Self { status: "shared", ..Self::elsewhere(job, out, Some(text)) }
    }

    pub(super) fn planned(name: String, job: &Job, phase: usize) -> Self {
        let next = Some(PhaseFacts::new(job, phase));
        Self { job: name, status: "planned", out: None, next, undone: None, text: None }
    }

    pub(super) fn missing(job: String, undone: Missing) -> Self {
        Self { job, status: "missing", out: None, next: None, undone: Some(undone), text: None }
    }
}

impl fmt::Display for Merged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.text, &self.out) {
            (Some(text), _) => f.write_str(text)?,
            (None, Some(out)) => writeln!(f, "wrote {out}")?,
            (None, None) => {}
        }
        self.next.iter().try_for_each(|phase| writeln!(f, "to be done next: {phase}"))?;
        self.undone.iter().try_for_each(|missing| write!(f, "{missing}"))
    }
}

/// What there is of a phase.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PhaseStatus {
    #[serde(flatten)]
    pub(super) facts: PhaseFacts,
    /// Shards with a part that can be used.
    pub(super) n_done: usize,
    /// The share of the phase's predicted cost that is done.
    pub(super) done_share: f64,
    /// Numbers of shards without a part that were begun.
    pub(super) begun: Vec<usize>,
    #[serde(flatten)]
    pub(super) undone: Undone,
    /// Seconds that are left, if the rest takes as long as what was done since the phase was planned; null if unknown.
    pub(super) seconds_left: Option<f64>,
}

/// The same as [`Missing`], without the name of the phase.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Undone {
    /// Numbers of shards without a part.
    pub(super) missing: Vec<usize>,
    /// Shards whose part cannot be used.
    pub(super) broken: Vec<Broken>,
}

impl From<Missing> for Undone {
    fn from(Missing { missing, broken, .. }: Missing) -> Self {
        Self { missing, broken }
    }
}

/// What there is of a job.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Status {
    /// The folder of the job.
    pub(super) job: String,
    /// The command, in words.
    pub(super) command: Vec<String>,
    /// The phases that are known.
    pub(super) phases: Vec<PhaseStatus>,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "job            {}: {}", self.job, self.command.join(" "))?;
        for phase in &self.phases {
            let PhaseStatus { facts, n_done, done_share, begun, undone, seconds_left } = phase;
            let (shards, share) = (count(facts.n_shards as u64, "shard"), percent(*done_share));
            writeln!(f, "phase {:<9} {n_done} of {shards} done, {share} of the cost", facts.phase)?;
            if let Some(left) = seconds_left.and_then(|left| Duration::try_from_secs_f64(left).ok()) {
                writeln!(f, "               about {} left, at the pace since it was planned", rough(left))?;
            }
            if !undone.missing.is_empty() {
                writeln!(f, "missing        {}", in_words(&undone.missing))?;
            }
            if !begun.is_empty() {
                writeln!(f, "begun          {}", in_words(begun))?;
            }
            for Broken { shard, reason } in &undone.broken {
                writeln!(f, "broken         shard {shard}: {reason}")?;
            }
        }
        Ok(())
    }
}

/// The files that would be given to Slurm.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Submitted {
    /// The folder of the job.
    pub(super) job: String,
    /// With `--dry-run`: the files that were written.
    pub(super) files: Vec<String>,
}

impl fmt::Display for Submitted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.files.iter().try_for_each(|file| writeln!(f, "wrote {file}"))
    }
}
