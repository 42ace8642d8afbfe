//! Rounds: an engine that fails now and then, and one that gives up.

use crate::jobs::{plan, run};
use crate::toy::{PROGRAM, toy};
use sightlines_checkpoint::engine::{Did, Engine, EngineError, Host, Merge, Round, Rounds, run_rounds};
use sightlines_checkpoint::{JobProgress, JobRole};
use sightlines_progress::{Observer, Progress};
use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::Path;

const N: [usize; 2] = [5, 7];

/// Does shards in this process; of each first attempt all but the first.
struct Forgetful<'a> {
    n_rounds: &'a Cell<u32>,
    /// Whether later attempts are no better.
    is_hopeless: bool,
}

impl Engine for Forgetful<'_> {
    fn run(&self, round: &Round<'_>, attempt: u32, _: &Host<'_>) -> Result<Did, EngineError> {
        self.n_rounds.set(self.n_rounds.get() + 1);
        let n_forgotten = usize::from(attempt == 1 || self.is_hopeless);
        for &shard in &round.shards[n_forgotten..] {
            assert_eq!(run(round.job.folder(), N, JobRole::shard(shard)), Err(JobProgress::Done));
        }
        Ok(Did::Shards)
    }
}

fn rounds(
    folder: &Path,
    engine: &dyn Engine,
    retries: u32,
    stop: fn() -> bool,
) -> Result<Rounds<Vec<u8>>, EngineError> {
    let observe = || -> Box<dyn Observer> { Box::new(|_: Progress| ControlFlow::Continue(())) };
    let host = Host { observe: &observe, stop, warn: |_| {}, said: |_| {} };
    run_rounds((folder, PROGRAM), (engine, retries), &host, || {
        Ok(match run(folder, N, JobRole::Merge) {
            Ok(bytes) => Merge::Written(bytes),
            Err(JobProgress::Missing { phase, shards }) => Merge::Missing { phase, shards },
            Err(_) => Merge::Planned,
        })
    })
}

#[test]
fn what_failed_is_tried_again_as_often_as_allowed() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 3).unwrap();
    let n_rounds = Cell::new(0);
    let stopped = rounds(&folder, &Forgetful { n_rounds: &n_rounds, is_hopeless: false }, 1, || true);
    assert!(matches!(stopped, Err(EngineError::Stopped)) && n_rounds.get() == 0);
    let hopeless = rounds(&folder, &Forgetful { n_rounds: &n_rounds, is_hopeless: true }, 0, || false);
    assert!(matches!(hopeless, Ok(Rounds::Missing { phase: 0, ref shards, .. }) if shards.len() == 1), "{hopeless:?}");
    assert_eq!(n_rounds.replace(0), 1);
    // The shard that is left of the first phase, and two rounds for the second.
    let merged = rounds(&folder, &Forgetful { n_rounds: &n_rounds, is_hopeless: false }, 1, || false);
    assert!(matches!(merged, Ok(Rounds::Merged(bytes)) if bytes == toy(N).bake(None).unwrap()));
    assert_eq!(n_rounds.get(), 4);
}
