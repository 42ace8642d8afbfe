//! Workers: processes that go through all of a bake together.

use crate::jobs::{first_phase, plan};
use crate::toy::{PROGRAM, Toy, toy};
use proptest::prelude::*;
use sightlines_checkpoint::{Job, JobProgress, JobRole, JobStore, ShardState};
use sightlines_progress::Halt;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

fn worker(folder: &Path, n_workers: usize) -> JobStore {
    let role = JobRole::Worker { n_workers, stop: || false };
    JobStore::new(Job::open(folder, PROGRAM).unwrap(), role, Duration::ZERO).unwrap()
}

/// Goes through a bake; its answer, if this worker is the one that writes it.
fn work(toy: &Toy, store: &JobStore) -> Result<Vec<u8>, Halt> {
    let bytes = toy.bake(Some(store))?;
    store.begin_writing(&[])?;
    store.end_writing().unwrap();
    Ok(bytes)
}

/// The names in a folder that do not end like this.
fn others(folder: &Path, end: &str) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_str().unwrap().to_owned());
    names.filter(|name| !name.ends_with(end)).collect()
}

proptest! {
    // Each case writes many files, and waits for the disk each time.
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 6 + 1, ..ProptestConfig::default() })]

    /// Invariant: workers compute each unit once, all come to the end, and one of them writes what a bake of one process makes.
    #[test]
    fn workers_share_a_bake(n in [0..12_usize, 0..12_usize], max_shards in 1..8_usize, n_workers in 1..5_usize) {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("job");
        plan(&folder, "a", max_shards).unwrap();
        let (shared, expected) = (toy(n), toy(n).bake(None).unwrap());
        let ends: Vec<Result<Vec<u8>, JobProgress>> = thread::scope(|scope| {
            let one = || {
                let store = worker(&folder, n_workers);
                work(&shared, &store).map_err(|halt| {
                    assert_eq!(halt, Halt::Shared);
                    store.outcome().unwrap()
                })
            };
            let workers: Vec<_> = (0..n_workers).map(|_| scope.spawn(one)).collect();
            workers.into_iter().map(|worker| worker.join().unwrap()).collect()
        });
        let written: Vec<&Vec<u8>> = ends.iter().flatten().collect();
        prop_assert_eq!(written, vec![&expected]);
        prop_assert!(ends.iter().all(|end| matches!(end, Ok(_) | Err(JobProgress::Done))));
        prop_assert_eq!(shared.n(), n[0] + n[1]);
        prop_assert_eq!(others(&folder.join("parts"), ".part"), Vec::<String>::new());
        prop_assert_eq!(others(&folder, ".written").len(), 2, "the manifest and the folder of parts");
        // The impostor: processes that are told their shards, all of them, compute units twice.
        if n_workers > 1 && n[0] > 0 {
            let other = all.path().join("other");
            plan(&other, "a", max_shards).unwrap();
            let twice = toy(n);
            let planned = JobStore::new(Job::open(&other, PROGRAM).unwrap(), JobRole::Merge, Duration::ZERO).unwrap();
            prop_assert_eq!(twice.bake(Some(&planned)), Err(Halt::Shared));
            let job = planned.job();
            let role = || JobRole::Shards((0..job.manifest().n_shards()).collect());
            let stores = [0, 1].map(|_| JobStore::new(job.clone(), role(), Duration::from_secs(9)).unwrap());
            stores.iter().for_each(|store| assert_eq!(twice.bake(Some(store)), Err(Halt::Shared)));
            prop_assert_eq!(twice.n(), 2 * n[0]);
        }
    }

    /// Invariant: what a killed worker had claimed is done by the others, who go on from what it left; nothing is lost and nothing wrong.
    #[test]
    fn what_a_killed_worker_had_claimed_is_done(n in [1..12_usize, 1..12_usize], stops in [0..8_usize, 0..8_usize]) {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("job");
        plan(&folder, "a", 4).unwrap();
        let killed = stops.map(|stop_after| Toy { stop_after, ..toy(n) });
        let last = toy(n);
        let written = thread::scope(|scope| {
            for toy in &killed {
                // Its claims end with its store, as those of a process do.
                scope.spawn(|| drop(work(toy, &worker(&folder, 3))));
            }
            work(&last, &worker(&folder, 3))
        });
        let expected = toy(n).bake(None).unwrap();
        match written {
            Ok(bytes) => prop_assert_eq!(bytes, expected),
            // One of the others was not killed before it came to the end, and has written.
            Err(halt) => prop_assert_eq!(halt, Halt::Shared),
        }
        let all_of_it = toy(n);
        prop_assert_eq!(all_of_it.bake(Some(&worker(&folder, 1))).unwrap(), toy(n).bake(None).unwrap());
        prop_assert_eq!(all_of_it.n(), 0);
    }
}

/// A worker that waits for another one ends when it is told to, and goes on when the other one ends.
#[test]
fn workers_wait_for_others() {
    static STOP: AtomicBool = AtomicBool::new(false);
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 1).unwrap();
    let holder = worker(&folder, 2);
    let mut stopped = toy([3, 3]);
    stopped.stop_after = 1;
    assert_eq!(work(&stopped, &holder), Err(Halt::Store("killed".to_owned())));
    let role = JobRole::Worker { n_workers: 2, stop: || STOP.load(Relaxed) };
    let waiting = JobStore::new(Job::open(&folder, PROGRAM).unwrap(), role, Duration::ZERO).unwrap();
    let idle = toy([3, 3]);
    thread::scope(|scope| {
        let end = scope.spawn(|| work(&idle, &waiting));
        thread::sleep(Duration::from_millis(50));
        assert!(!end.is_finished());
        STOP.store(true, Relaxed);
        assert!(matches!(end.join().unwrap(), Err(Halt::Cancelled(_))));
    });
    assert_eq!(idle.n(), 0);
    let next = worker(&folder, 2);
    thread::scope(|scope| {
        let end = scope.spawn(|| work(&idle, &next));
        thread::sleep(Duration::from_millis(50));
        assert!(!end.is_finished());
        drop(holder);
        assert_eq!(end.join().unwrap(), toy([3, 3]).bake(None));
    });
    // The one unit that was done before the other one was stopped is not done again.
    assert_eq!(idle.n(), 5);
}

/// A worker that ends while it writes is followed by another one that waited; one that has written is not.
#[test]
fn one_worker_after_the_other_writes_until_one_has() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 2).unwrap();
    let outputs = [all.path().join("out")];
    let writers = [0, 1, 2].map(|_| worker(&folder, 3));
    let toy = toy([3, 3]);
    for store in &writers {
        assert!(toy.bake(Some(store)).is_ok());
    }
    let [first, second, third] = writers;
    assert_eq!((first.begin_writing(&outputs), first.begin_writing(&outputs)), (Ok(()), Ok(())));
    thread::scope(|scope| {
        let waiting = scope.spawn(|| second.begin_writing(&outputs));
        thread::sleep(Duration::from_millis(50));
        assert!(!waiting.is_finished());
        // As if it had been killed.
        drop(first);
        assert_eq!(waiting.join().unwrap(), Ok(()));
    });
    fs::write(&outputs[0], "what the bake makes").unwrap();
    second.end_writing().unwrap();
    assert_eq!((third.begin_writing(&outputs), third.outcome()), (Err(Halt::Shared), Some(JobProgress::Done)));
    // What was removed is written again, and so is another output.
    let store = worker(&folder, 3);
    assert_eq!(store.begin_writing(&[all.path().join("other")]), Ok(()));
    fs::remove_file(&outputs[0]).unwrap();
    assert_eq!(worker(&folder, 3).begin_writing(&outputs), Ok(()));
}

/// A part that cannot be used ends a worker, which names it; so does a job of something else in its folder.
#[test]
fn workers_refuse_what_is_damaged() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    let job = first_phase(&folder);
    let mut part = fs::read(job.part_path(1)).unwrap();
    *part.last_mut().unwrap() ^= 1;
    fs::write(job.part_path(1), &part).unwrap();
    let store = worker(&folder, 1);
    assert_eq!(work(&toy([6, 4]), &store), Err(Halt::Shared));
    let outcome = store.outcome();
    let Some(JobProgress::Missing { phase: 0, shards }) = &outcome else { panic!("{outcome:?}") };
    assert!(matches!(&shards[..], [(1, ShardState::Broken(_))]), "{shards:?}");
    fs::remove_file(job.part_path(1)).unwrap();
    let store = worker(&folder, 1);
    let other = all.path().join("other");
    plan(&other, "b", 3).unwrap();
    fs::copy(other.join("job.json"), folder.join("job.json")).unwrap();
    let Err(Halt::Store(text)) = work(&toy([6, 4]), &store) else { panic!("it went on") };
    assert!(text.ends_with("there is another job in the folder; name a new one, or remove it"), "{text}");
}

/// Each thousand of shards has a folder, so that a part is written as fast in a job with many.
#[test]
fn thousands_of_shards_have_folders_of_their_own() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 5000).unwrap();
    let toy = toy([2001, 0]);
    let store = |role: JobRole| JobStore::new(Job::open(&folder, PROGRAM).unwrap(), role, Duration::ZERO).unwrap();
    let bake = |role: JobRole| {
        let store = store(role);
        assert_eq!(toy.bake(Some(&store)), Err(Halt::Shared));
        store.outcome().unwrap()
    };
    assert_eq!(bake(JobRole::Merge), JobProgress::Planned { phase: 0, shards: 0..2001 });
    let done = [0, 999, 1000, 1001, 1999, 2000];
    assert_eq!(bake(JobRole::Shards(done.to_vec())), JobProgress::Done);
    let parts = |name: &str| {
        let mut names = others(&folder.join("parts").join(name), ".claim");
        names.retain(|name| name.contains(".part"));
        names.sort();
        names
    };
    assert_eq!(["", "1", "2"].map(|name| parts(name).len()), [2, 3, 1]);
    assert_eq!(parts("1"), ["1000.part", "1001.part", "1999.part"]);
    let job = Job::open(&folder, PROGRAM).unwrap();
    let is_done = |shard: &usize| job.state(*shard).unwrap() == ShardState::Done;
    assert_eq!((0..2001).filter(is_done).collect::<Vec<_>>(), done);
}
