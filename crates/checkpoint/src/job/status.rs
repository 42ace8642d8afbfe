//! How far a job is, and whether its files are still what they were.

use super::{Job, JobError, MANIFEST, ShardState};
use crate::key::KeyHasher;
use std::fs;
use std::path::PathBuf;

/// How far a phase is.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseStatus {
    /// Its shards, and what there is of each.
    pub shards: Vec<(usize, ShardState)>,
    /// How many are done.
    pub n_done: usize,
    /// The share of its cost that is done.
    pub done_share: f64,
    /// The time left in seconds, if the rest takes as long as what was done since the phase was planned; `None` if unknown.
    pub seconds_left: Option<f64>,
}

impl Job {
    /// How far a phase is. Reads all of its parts.
    ///
    /// # Errors
    /// [`JobError::NoShard`].
    pub fn status(&self, phase: usize) -> Result<PhaseStatus, JobError> {
        let shards = self.manifest.shards_of(phase).map(|shard| Ok((shard, self.state(shard)?)));
        let shards = shards.collect::<Result<Vec<_>, JobError>>()?;
        let (mut all, mut done, mut n_done) = (0.0, 0.0, 0);
        for ((_, state), plan) in shards.iter().zip(&self.manifest.phases[phase].shards) {
            all += plan.cost;
            if *state == ShardState::Done {
                done += plan.cost;
                n_done += 1;
            }
        }
        if n_done == shards.len() {
            return Ok(PhaseStatus { shards, n_done, done_share: 1.0, seconds_left: Some(0.0) });
        }
        // The manifest was written last when the last phase was planned.
        let planned = fs::metadata(self.folder.join(MANIFEST)).and_then(|found| found.modified()).ok();
        let since = planned.and_then(|planned| planned.elapsed().ok()).filter(|_| done > 0.0);
        let seconds_left = since.map(|since| since.as_secs_f64() * (all - done) / done);
        Ok(PhaseStatus { shards, n_done, done_share: done / f64::max(all, f64::MIN_POSITIVE), seconds_left })
    }

    /// Refuses files that are not what they were when the job was planned. Reads all of them; relative paths start from the current folder.
    ///
    /// # Errors
    /// [`JobError::Read`], and [`JobError::OtherInput`].
    pub fn check_inputs(&self) -> Result<(), JobError> {
        for input in &self.manifest.inputs {
            let path = PathBuf::from(&input.path);
            // Opened, so that what cannot be read is told as that.
            let n_bytes = match fs::File::open(&path).and_then(|file| file.metadata()) {
                Ok(found) => found.len(),
                Err(source) => return Err(JobError::Read { path, source }),
            };
            let key = || KeyHasher::new("").file("", &path).map(|(_, key)| key.to_string());
            if n_bytes != input.n_bytes || !key().is_ok_and(|key| key == input.key) {
                return Err(JobError::OtherInput { path, folder: self.folder.clone() });
            }
        }
        Ok(())
    }
}
