//! What is done of a job and what is left, as fields for programs and as lines for people.

use crate::{Job, JobError, PhasePlan, ShardState, in_words};
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use sightlines_progress::words::{count, percent, rough, seconds_of};
use std::fmt;
use std::path::Path;
use std::time::Duration;

/// A phase of a job, and its shards.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct PhaseFacts {
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
    fn new(job: &Job, phase: usize) -> Self {
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
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Planned {
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
    /// The shards of `phase`, or else that the output was written.
    pub fn new(name: String, job: &Job, phase: Option<usize>, out: Option<&Path>) -> Self {
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
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct ShardsDone {
    /// The folder of the job.
    pub job: String,
    /// Each shard, in ascending order.
    pub shards: Vec<ShardDone>,
    /// Seconds in all.
    pub seconds: f64,
}

/// What one shard gave.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct ShardDone {
    /// The number of the shard.
    pub shard: usize,
    /// Its phase.
    pub phase: String,
    /// Its first unit.
    pub begin: usize,
    /// The unit behind its last one.
    pub end: usize,
    /// Whether its part was there already.
    pub was_done: bool,
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
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Missing {
    /// Their phase.
    phase: String,
    #[serde(flatten)]
    undone: Undone,
}

impl Missing {
    /// Of a phase; `shards` has what there is of each.
    pub fn new(job: &Job, phase: usize, shards: Vec<(usize, ShardState)>) -> Self {
        Self { phase: job.manifest().phases[phase].name.clone(), undone: Undone::of(shards) }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.undone.write_missing(f)?;
        self.undone.write_broken(f)
    }
}

/// Shards that are not done.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Undone {
    /// Numbers of shards without a part.
    missing: Vec<usize>,
    /// Shards whose part cannot be used.
    broken: Vec<Broken>,
}

/// A shard whose part cannot be used.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Broken {
    /// The number of the shard.
    shard: usize,
    /// What is wrong, with the name of the file.
    reason: String,
}

impl Undone {
    fn of(shards: Vec<(usize, ShardState)>) -> Self {
        let (mut missing, mut broken) = (Vec::new(), Vec::new());
        for (shard, state) in shards {
            match state {
                ShardState::Broken(reason) => broken.push(Broken { shard, reason }),
                ShardState::Missing | ShardState::Partial(_) => missing.push(shard),
                ShardState::Done => {}
            }
        }
        Self { missing, broken }
    }

    fn write_missing(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.missing.is_empty() { Ok(()) } else { writeln!(f, "missing        {}", in_words(&self.missing)) }
    }

    fn write_broken(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.broken
            .iter()
            .try_for_each(|Broken { shard, reason }| writeln!(f, "broken         shard {shard}: {reason}"))
    }
}

/// Exit code 3 if shards are to be done, first or again.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Merged {
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
    /// The output was written, and the process that wrote it printed this.
    pub fn written(job: String, out: &Path, text: Option<String>) -> Self {
        let out = Some(out.display().to_string());
        Self { job, status: "written", out, next: None, undone: None, text }
    }

    /// All is done, and another worker has written the output.
    pub fn shared(job: String, out: &Path) -> Self {
        let text = format!("done; another worker has written {}\n", out.display());
        Self { status: "shared", ..Self::written(job, out, Some(text)) }
    }

    /// The shards of a phase are to be done.
    pub fn planned(name: String, job: &Job, phase: usize) -> Self {
        let next = Some(PhaseFacts::new(job, phase));
        Self { job: name, status: "planned", out: None, next, undone: None, text: None }
    }

    /// Shards of a phase are not done.
    pub fn missing(job: String, undone: Missing) -> Self {
        Self { job, status: "missing", out: None, next: None, undone: Some(undone), text: None }
    }

    /// What a worker has printed that has written the output, from the JSON of this.
    pub fn told(printed: &[u8]) -> Option<String> {
        let found: Value = serde_json::from_slice(printed).ok()?;
        found["text"].as_str().filter(|_| found["status"] == "written").map(str::to_owned)
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
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct PhaseStatus {
    #[serde(flatten)]
    facts: PhaseFacts,
    /// Shards with a part that can be used.
    n_done: usize,
    /// The share of the phase's predicted cost that is done.
    done_share: f64,
    /// Numbers of shards without a part that were begun.
    begun: Vec<usize>,
    #[serde(flatten)]
    undone: Undone,
    /// Seconds that are left, if the rest takes as long as what was done since the phase was planned; null if unknown.
    seconds_left: Option<f64>,
}

/// What there is of a job.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Status {
    /// The folder of the job.
    job: String,
    /// The command, in words.
    command: Vec<String>,
    /// The phases that are known.
    phases: Vec<PhaseStatus>,
}

impl Status {
    /// Of a job, which users call `name`. Reads all of its parts.
    ///
    /// # Errors
    /// [`JobError::Read`].
    pub fn of(job: &Job, name: String) -> Result<Self, JobError> {
        let phase = |phase| {
            let (status, facts) = (job.status(phase)?, PhaseFacts::new(job, phase));
            let begun = status.shards.iter().filter(|(_, state)| matches!(state, ShardState::Partial(_)));
            let begun = begun.map(|(shard, _)| *shard).collect();
            let crate::PhaseStatus { n_done, done_share, seconds_left, shards } = status;
            Ok(PhaseStatus { facts, n_done, done_share, begun, undone: Undone::of(shards), seconds_left })
        };
        let manifest = job.manifest();
        let phases = (0..manifest.phases.len()).map(phase).collect::<Result<_, JobError>>()?;
        Ok(Self { job: name, command: manifest.command.clone(), phases })
    }
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
            undone.write_missing(f)?;
            if !begun.is_empty() {
                writeln!(f, "begun          {}", in_words(begun))?;
            }
            undone.write_broken(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worker_that_has_written_says_so() {
        for other in [&b""[..], b"what?", br#"{"status": "shared", "text": "done"}"#, b"[]"] {
            assert_eq!(Merged::told(other), None);
        }
        assert_eq!(Merged::told(br#"{"status": "written", "text": "wrote it"}"#).as_deref(), Some("wrote it"));
    }
}
