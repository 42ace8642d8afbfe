//! Jobs: shards in any order, twice, at once, and what is missing or broken.

use crate::toy::{PROGRAM, key, toy};
use proptest::prelude::*;
use sightlines_checkpoint::{Job, JobError, JobProgress, JobRole, JobStore, Manifest, ShardState};
use sightlines_progress::{Halt, UnitStore};
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;

pub(crate) fn plan(folder: &Path, of: &str, max_shards: usize) -> Result<Job, JobError> {
    Job::create(
        folder,
        Manifest::new(PROGRAM, key(of), vec!["bake".to_owned(), of.to_owned()], "/".to_owned(), max_shards),
    )
}

/// Goes through a bake as a role; its answer, or how far it came.
pub(crate) fn run(folder: &Path, n: [usize; 2], role: JobRole) -> Result<Vec<u8>, JobProgress> {
    let store = JobStore::new(Job::open(folder, PROGRAM).unwrap(), role, Duration::ZERO).unwrap();
    toy(n).bake(Some(&store)).map_err(|halt| {
        assert_eq!(halt, Halt::Shared);
        store.outcome().expect("the store ended it")
    })
}

proptest! {
    // Each case writes many files, and waits for the disk each time.
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 6 + 1, ..ProptestConfig::default() })]

    /// Invariant: shards in any order, some of them twice, and a merge give the bytes of a bake of one process.
    #[test]
    fn shards_make_the_same_bytes(n in [0..12_usize, 0..12_usize], max_shards in 1..6_usize, order in any::<u64>()) {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("job");
        plan(&folder, "a", max_shards).unwrap();
        let expected = toy(n).bake(None).unwrap();
        let mut n_rounds = 0;
        let merged = loop {
            match run(&folder, n, JobRole::Merge) {
                Ok(bytes) => break bytes,
                Err(JobProgress::Planned { shards, .. }) => {
                    let mut todo: Vec<usize> = shards.clone().chain(shards.take(1)).collect();
                    let by = order.rotate_left(n_rounds * 9);
                    todo.sort_by_key(|&shard| (by.wrapping_mul(shard as u64 * 2 + 1) >> 7, shard));
                    for shard in todo {
                        prop_assert_eq!(run(&folder, n, JobRole::shard(shard)), Err(JobProgress::Done));
                    }
                }
                Err(other) => prop_assert!(false, "{:?}", other),
            }
            n_rounds += 1;
        };
        prop_assert_eq!(merged, expected);
        // Whoever plans a phase without units goes on at once.
        prop_assert_eq!(n_rounds as usize, n.iter().filter(|&&n| n > 0).count());
        let job = Job::open(&folder, PROGRAM).unwrap();
        let states = (0..job.manifest().n_shards()).map(|shard| job.state(shard).unwrap());
        prop_assert!(states.into_iter().all(|state| state == ShardState::Done));
        // Nothing is left but parts.
        let names = fs::read_dir(folder.join("parts")).unwrap().map(|entry| entry.unwrap().file_name());
        prop_assert!(names.into_iter().all(|name| name.to_str().unwrap().ends_with(".part")));
    }
}

/// A job with all parts of its first phase, of six units in three shards.
pub(crate) fn first_phase(folder: &Path) -> Job {
    plan(folder, "a", 3).unwrap();
    assert_eq!(run(folder, [6, 4], JobRole::Merge), Err(JobProgress::Planned { phase: 0, shards: 0..3 }));
    for shard in 0..3 {
        assert_eq!(run(folder, [6, 4], JobRole::shard(shard)), Err(JobProgress::Done));
    }
    Job::open(folder, PROGRAM).unwrap()
}

/// The same, for those that need many: copied from one that is made once.
pub(crate) fn copy_of_first_phase(folder: &Path) -> Job {
    static MADE: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
        let folder = tempfile::tempdir().unwrap();
        first_phase(folder.path());
        folder
    });
    fs::create_dir_all(folder.join("parts")).unwrap();
    for name in ["job.json", "parts/0.part", "parts/1.part", "parts/2.part"] {
        fs::copy(MADE.path().join(name), folder.join(name)).unwrap();
    }
    Job::open(folder, PROGRAM).unwrap()
}

#[test]
fn what_is_missing_or_broken_is_named() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    let job = first_phase(&folder);
    let missing = |expected: &[(usize, ShardState)]| {
        let shards = expected.to_vec();
        assert_eq!(run(&folder, [6, 4], JobRole::Merge), Err(JobProgress::Missing { phase: 0, shards }));
        assert!(expected.iter().all(|(shard, state)| job.state(*shard).unwrap() == *state));
    };
    let parts: Vec<Vec<u8>> = (0..3).map(|shard| fs::read(job.part_path(shard)).unwrap()).collect();
    fs::remove_file(job.part_path(1)).unwrap();
    missing(&[(1, ShardState::Missing)]);
    // The part of another shard in its place, a part with a bit changed, and one of another job.
    let name = job.part_path(1).display().to_string();
    fs::write(job.part_path(1), &parts[0]).unwrap();
    let text = format!("{name}: it does not have the results of just the units of its shard");
    missing(&[(1, ShardState::Broken(text))]);
    let mut changed = parts[1].clone();
    *changed.last_mut().unwrap() ^= 1;
    fs::write(job.part_path(1), &changed).unwrap();
    assert!(matches!(job.state(1).unwrap(), ShardState::Broken(text) if text.contains("it is cut off after byte")));
    let other = all.path().join("other");
    plan(&other, "b", 3).unwrap();
    assert!(matches!(run(&other, [6, 4], JobRole::Merge), Err(JobProgress::Planned { .. })));
    assert_eq!(run(&other, [6, 4], JobRole::shard(1)), Err(JobProgress::Done));
    fs::copy(Job::open(&other, PROGRAM).unwrap().part_path(1), job.part_path(1)).unwrap();
    let text = format!("{name}: the results are of another input or of other options");
    missing(&[(1, ShardState::Broken(text))]);
    // A process that does the shard replaces what is broken.
    assert_eq!(run(&folder, [6, 4], JobRole::shard(1)), Err(JobProgress::Done));
    assert_eq!(fs::read(job.part_path(1)).unwrap(), parts[1]);
    assert!(matches!(run(&folder, [6, 4], JobRole::Merge), Err(JobProgress::Planned { phase: 1, .. })));
}

/// A shard goes on from what stopped processes left, and two at once write the same part.
#[test]
fn shards_go_on_and_may_be_done_at_once() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    let job = first_phase(&folder);
    let part = fs::read(job.part_path(1)).unwrap();
    fs::remove_file(job.part_path(1)).unwrap();
    let store = |job: &Job| JobStore::new(job.clone(), JobRole::shard(1), Duration::ZERO).unwrap();
    let mut stopped = toy([6, 4]);
    stopped.stop_after = 1;
    assert_eq!(stopped.bake(Some(&store(&job))), Err(Halt::Store("killed".to_owned())));
    assert_eq!(job.state(1).unwrap(), ShardState::Partial(1));
    // What the process with another number left is as good.
    let journal = fs::read_dir(folder.join("parts")).unwrap().map(|entry| entry.unwrap().path());
    let journal = journal.into_iter().find(|path| path.extension().is_some_and(|e| e == "journal")).unwrap();
    fs::rename(&journal, folder.join("parts/1.part.elsewhere-00000000-1.journal")).unwrap();
    let going_on = toy([6, 4]);
    let [first, second] = [store(&job), store(&job)];
    assert_eq!(going_on.bake(Some(&first)), Err(Halt::Shared));
    let plan = *job.shard(1).unwrap().1;
    let n_units = plan.end - plan.begin;
    assert_eq!(n_units, 2);
    assert_eq!((going_on.n(), fs::read(job.part_path(1)).unwrap()), (n_units - 1, part.clone()));
    assert_eq!(toy([6, 4]).bake(Some(&second)), Err(Halt::Shared));
    assert_eq!(fs::read(job.part_path(1)).unwrap(), part);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(run(&folder, [6, 4], JobRole::shard(2)), Err(JobProgress::Done)));
        }
    });
    assert_eq!(job.state(2).unwrap(), ShardState::Done);
}

#[test]
fn other_inputs_and_programs_are_refused() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    let job = first_phase(&folder);
    assert_eq!(plan(&folder, "a", 3).unwrap(), job);
    assert!(matches!(plan(&folder, "b", 3), Err(JobError::OtherJob(_))));
    let error = Job::open(&folder, "2.0").unwrap_err().to_string();
    assert!(
        error.ends_with("job.json: planned by version 1.0 of the program, and this is 2.0; plan it anew"),
        "{error}"
    );
    // A bake with other units than were planned.
    let store = JobStore::new(job.clone(), JobRole::shard(1), Duration::ZERO).unwrap();
    let Err(Halt::Store(text)) = toy([7, 4]).bake(Some(&store)) else { panic!("it went on") };
    assert!(text.starts_with("the job was planned with 6 units of phase pairs, and there are 7"), "{text}");
    assert!(matches!(
        JobStore::new(job, JobRole::shard(3), Duration::ZERO),
        Err(JobError::NoShard { shard: 3, n: 3, .. })
    ));
    let stranger = JobStore::new(Job::open(&folder, PROGRAM).unwrap(), JobRole::Merge, Duration::ZERO).unwrap();
    assert!(!stranger.wants("pairs", 0) && stranger.save("pairs", 0, b"").is_err());
}

proptest! {
    // Each case writes many files, and waits for the disk each time.
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 6 + 1, ..ProptestConfig::default() })]

    /// Invariant: however shards are grouped, each part has the bytes that a process of its own writes, and so has the merge.
    #[test]
    fn groups_of_shards_make_the_same_parts(n in [1..16_usize, 1..16_usize], max_shards in 1..8_usize, groups in any::<u64>()) {
        let all = tempfile::tempdir().unwrap();
        let folders = ["alone", "together"].map(|name| all.path().join(name));
        folders.iter().for_each(|folder| drop(plan(folder, "a", max_shards).unwrap()));
        let mut n_rounds = 0;
        while let Err(JobProgress::Planned { shards, .. }) = run(&folders[0], n, JobRole::Merge) {
            prop_assert_eq!(run(&folders[1], n, JobRole::Merge), Err(JobProgress::Planned { phase: n_rounds, shards: shards.clone() }));
            shards.clone().for_each(|shard| assert_eq!(run(&folders[0], n, JobRole::shard(shard)), Err(JobProgress::Done)));
            // Four groups, named from the last shard on, some shards twice.
            for group in 0..4 {
                let is_of = |shard: &usize| groups.rotate_left(*shard as u32 * 7 + 1) % 4 == group;
                let mut of: Vec<usize> = shards.clone().rev().filter(is_of).collect();
                of.extend(of.first().copied());
                if !of.is_empty() {
                    prop_assert_eq!(run(&folders[1], n, JobRole::Shards(of)), Err(JobProgress::Done));
                }
            }
            let jobs = [0, 1].map(|k| Job::open(&folders[k], PROGRAM).unwrap());
            for shard in shards {
                let [alone, together] = [0, 1].map(|k: usize| fs::read(jobs[k].part_path(shard)).unwrap());
                prop_assert_eq!(alone, together);
            }
            n_rounds += 1;
        }
        prop_assert_eq!(run(&folders[1], n, JobRole::Merge), Ok(toy(n).bake(None).unwrap()));
    }
}

/// A process that is stopped in the middle of its shards leaves whole parts of those that were done, and what it knew of the next.
#[test]
fn parts_of_a_group_are_written_one_by_one() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    plan(&folder, "a", 4).unwrap();
    assert_eq!(run(&folder, [12, 2], JobRole::Merge), Err(JobProgress::Planned { phase: 0, shards: 0..4 }));
    let job = Job::open(&folder, PROGRAM).unwrap();
    let n_units = |shard: usize| job.shard(shard).unwrap().1.end - job.shard(shard).unwrap().1.begin;
    let mut stopped = toy([12, 2]);
    stopped.stop_after = n_units(1) + n_units(2) + 1;
    let store = JobStore::new(job.clone(), JobRole::Shards(vec![3, 1, 2]), Duration::ZERO).unwrap();
    assert_eq!(stopped.bake(Some(&store)), Err(Halt::Store("killed".to_owned())));
    let states = [0, 1, 2, 3].map(|shard| job.state(shard).unwrap());
    assert_eq!(states, [ShardState::Missing, ShardState::Done, ShardState::Done, ShardState::Partial(1)]);
    // Who goes on computes what is missing.
    let going_on = toy([12, 2]);
    let store = JobStore::new(job.clone(), JobRole::Shards(vec![0, 3]), Duration::ZERO).unwrap();
    assert_eq!(going_on.bake(Some(&store)), Err(Halt::Shared));
    assert_eq!(going_on.n(), n_units(0) + n_units(3) - 1);
    assert!(matches!(run(&folder, [12, 2], JobRole::Merge), Err(JobProgress::Planned { phase: 1, .. })));
    // Shards of two phases cannot be done together: the second waits for all of the first.
    let refused = JobStore::new(Job::open(&folder, PROGRAM).unwrap(), JobRole::Shards(vec![3, 4]), Duration::ZERO);
    assert!(matches!(&refused, Err(JobError::TwoPhases { shards: [3, 4], .. })), "{refused:?}");
}
