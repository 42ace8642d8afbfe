//! Phases whose units build on each other: one process has all of them.

use crate::jobs::plan;
use crate::toy::PROGRAM;
use sightlines_checkpoint::{Job, JobProgress, JobRole, JobStore};
use sightlines_progress::{Halt, Phase, UnitStore, Units};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

const N: usize = 20;

/// A chain of numbers, each made from the one before it; counts those that it computes, and ends as if killed before one too many.
fn bake(store: Option<&dyn UnitStore>, n_computed: &AtomicUsize, most: usize) -> Result<u64, Halt> {
    let units = Units(store);
    let found = units.through(&Phase::chain("sums", &[1.0; N]), || {
        let mut sum = 1_u64;
        for unit in 0..N {
            let result = units.get("sums", unit, || {
                if n_computed.fetch_add(1, Relaxed) >= most {
                    return Err(Halt::Store("killed".to_owned()));
                }
                Ok::<_, Halt>((sum * 31 % 1_000_003 + unit as u64).to_le_bytes().to_vec())
            })?;
            let Some(result) = result else { return Ok(None) };
            sum = u64::from_le_bytes(result.try_into().unwrap());
        }
        Ok::<_, Halt>(Some(sum))
    })?;
    found.ok_or(Halt::Shared)
}

fn store(folder: &Path, role: JobRole) -> JobStore {
    JobStore::new(Job::open(folder, PROGRAM).unwrap(), role, Duration::ZERO).unwrap()
}

/// A chain is one shard, and goes on where it was stopped.
#[test]
fn a_chain_is_one_shard() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 5).unwrap();
    let n_computed = AtomicUsize::new(0);
    let merge = store(&folder, JobRole::Merge);
    assert_eq!(bake(Some(&merge), &n_computed, N), Err(Halt::Shared));
    assert_eq!(merge.outcome(), Some(JobProgress::Planned { phase: 0, shards: 0..1 }));
    let stopped = bake(Some(&store(&folder, JobRole::shard(0))), &n_computed, 7);
    assert_eq!((stopped, n_computed.swap(0, Relaxed)), (Err(Halt::Store("killed".to_owned())), 8));
    let own = store(&folder, JobRole::shard(0));
    assert_eq!(bake(Some(&own), &n_computed, N), Err(Halt::Shared));
    assert_eq!((own.outcome(), n_computed.swap(0, Relaxed)), (Some(JobProgress::Done), N - 7));
    let merged = bake(Some(&store(&folder, JobRole::Merge)), &n_computed, 0);
    assert_eq!(merged, bake(None, &n_computed, N));
}

/// Of workers one does all of a chain, and the others wait for it.
#[test]
fn workers_leave_a_chain_to_one_of_them() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 5).unwrap();
    let n_computed = AtomicUsize::new(0);
    let work = || {
        let store = store(&folder, JobRole::Worker { n_workers: 3, stop: || false });
        bake(Some(&store), &n_computed, usize::MAX)
    };
    let found: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = (0..3).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).collect()
    });
    assert_eq!(n_computed.load(Relaxed), N);
    assert_eq!(found, vec![bake(None, &n_computed, usize::MAX); 3]);
}
