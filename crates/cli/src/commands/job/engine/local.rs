//! Processes of this program on this machine.

use super::process::{End, Process, TICK};
use super::{Did, Engine, Round, Shown, pool};
use crate::commands::job::interrupted;
use crate::commands::job::numbers::Run;
use crate::commands::job::open;
use crate::error::Result;
use crate::interrupt;
use sightlines::checkpoint::Job;
use std::path::Path;
use std::process::Command;

/// How many ticks pass between two looks at how far the job is.
const TICKS: usize = 50;

/// So many workers with a thread each, which go through all of the job.
pub(in crate::commands::job) struct Local<'a> {
    pub(in crate::commands::job) program: &'a Path,
    pub(in crate::commands::job) workers: usize,
    /// What is written, if not what was planned.
    pub(in crate::commands::job) output: Option<&'a Path>,
    pub(in crate::commands::job) show_progress: bool,
}

impl Engine for Local<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32) -> Result<Did> {
        if attempt == 1 {
            return self.work(round);
        }
        // A shard that ends its process takes others along, so each is alone when it is tried again.
        pool::run(
            round,
            self.workers,
            self.show_progress,
            |_| 1,
            |shards| {
                let mut command = Command::new(self.program);
                command.args(["job", "shard"]).arg(round.job.folder());
                command.args(Run::all(shards).into_iter().map(Run::text)).args(["--threads", "1", "-q"]);
                command
            },
        )?;
        Ok(Did::Shards)
    }
}

impl Local<'_> {
    /// Starts workers, and waits for all.
    fn work(&self, round: &Round<'_>) -> Result<Did> {
        let _watch = interrupt::watch();
        let mut job = round.job.clone();
        let n = self.workers.to_string();
        let mut command = Command::new(self.program);
        command.args(["job", "work"]).arg(job.folder()).args(["--workers", &n, "--threads", "1", "-q", "--json"]);
        if let Some(out) = self.output {
            command.arg("-o").arg(out);
        }
        let (mut running, mut did): (Vec<Process>, Did) = (Vec::new(), Did::Shards);
        for k in 0..self.workers {
            match Process::start(format!("worker {k}"), &mut command) {
                Ok(process) => running.push(process),
                Err(error) => {
                    running.into_iter().for_each(Process::kill);
                    return Err(error);
                }
            }
        }
        while !running.is_empty() {
            let phase = job.manifest().phases.len().saturating_sub(1);
            let shards: Vec<usize> = job.manifest().shards_of(phase).collect();
            let round = Round { job: &job, phase, shards: &shards };
            let shown = Shown::new(&round, self.show_progress);
            let mut tick = 0_usize;
            let next = loop {
                if interrupt::requested() {
                    running.into_iter().for_each(Process::kill);
                    return Err(interrupted());
                }
                let mut hopeless = None;
                running.retain_mut(|process| match process.look() {
                    None => true,
                    Some(End::Hopeless(error)) => {
                        hopeless = Some(error);
                        false
                    }
                    Some(End::Passed(printed)) => {
                        did.take(&printed);
                        false
                    }
                });
                if let Some(error) = hopeless {
                    // The others would wait for what it had to do.
                    running.into_iter().for_each(Process::kill);
                    return Err(error);
                }
                if running.is_empty() {
                    break None;
                }
                if tick.is_multiple_of(TICKS) {
                    shown.update();
                    if let Some(next) = with_more_phases(&job) {
                        break Some(next);
                    }
                }
                tick += 1;
                std::thread::sleep(TICK);
            };
            shown.update();
            drop(shown);
            job = next.unwrap_or(job);
        }
        Ok(did)
    }
}

/// The job as it is now, if workers have planned another phase.
fn with_more_phases(job: &Job) -> Option<Job> {
    // What cannot be read is said by the workers.
    open(job.folder()).ok().filter(|now| now.manifest().phases.len() > job.manifest().phases.len())
}

impl Did {
    /// Takes what a worker has printed: that it has written the output, perhaps.
    fn take(&mut self, printed: &[u8]) {
        let Ok(found) = serde_json::from_slice::<serde_json::Value>(printed) else { return };
        if found["status"] == "written" {
            *self = Self::Output(found["text"].as_str().map(str::to_owned));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worker_that_has_written_says_so() {
        let mut did = Did::Shards;
        for other in [&b""[..], b"what?", br#"{"status": "shared", "text": "done"}"#, b"[]"] {
            did.take(other);
            assert!(matches!(did, Did::Shards));
        }
        did.take(br#"{"status": "written", "text": "wrote it"}"#);
        did.take(br#"{"status": "shared"}"#);
        assert!(matches!(did, Did::Output(Some(text)) if text == "wrote it"));
    }
}
