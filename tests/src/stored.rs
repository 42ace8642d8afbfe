//! Checks of files that keep results of units: journals, parts of jobs and their manifests.

use sightlines::checkpoint::{Job, JobProgress, JobRole, JobStore, Journal, Key, Manifest, OpenMode, ShardState};
use sightlines::progress::{Halt, Phase, UnitStore, Units};
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;

const PROGRAM: &str = "1.0";
const KEY: Key = Key([7; 16]);
const COSTS: [f64; 9] = [1.0, 3.0, 0.0, 2.0, 1.0, 1.0, 5.0, 1.0, 1.0];

/// What a unit gives.
fn result(unit: usize) -> Vec<u8> {
    (unit as u32).wrapping_mul(0x9e37_79b9).to_le_bytes().repeat(unit % 4)
}

/// A bake of one phase; how many units it computed.
fn bake(store: &dyn UnitStore) -> Result<usize, Halt> {
    let units = Units(Some(store));
    units.begin(&Phase::new("pairs", &COSTS))?;
    let mut n_computed = 0;
    for unit in 0..COSTS.len() {
        let found = units.get("pairs", unit, || {
            n_computed += 1;
            Ok::<_, Halt>(result(unit))
        })?;
        if let Some(found) = found {
            assert_eq!(found, result(unit), "a wrong result of unit {unit}");
        }
    }
    units.end("pairs")?;
    Ok(n_computed)
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn open(path: &Path) -> Option<Journal> {
    Journal::open(path, KEY, PROGRAM, OpenMode::Resume, Duration::ZERO).ok()
}

/// A job in a folder, with its parts.
fn job(folder: &Path) -> Job {
    let manifest = Manifest::new(PROGRAM, KEY, vec!["bake".to_owned()], "/".to_owned(), 3);
    let job = Job::create(folder, manifest).expect("an empty folder");
    let run =
        |role| bake(&JobStore::new(Job::open(folder, PROGRAM).expect("a job"), role, Duration::ZERO).expect("a role"));
    assert_eq!(run(JobRole::Merge), Err(Halt::Shared));
    (0..3).for_each(|shard| assert_eq!(run(JobRole::shard(shard)), Err(Halt::Shared)));
    job
}

/// Journals of bakes that came so far.
pub fn journals() -> Vec<Vec<u8>> {
    let folder = folder();
    let path = folder.path().join("state");
    (1..=COSTS.len())
        .map(|n| {
            let journal = open(&path).expect("a new file");
            journal.begin(&Phase::new("pairs", &COSTS)).expect("a phase");
            (0..n).for_each(|unit| journal.save("pairs", unit, &result(unit)).expect("a result"));
            drop(journal);
            fs::read(&path).expect("a file").clone()
        })
        .collect()
}

/// A journal is refused, or every result that it gives is right, and a bake that goes on from it can be gone on from.
pub fn check_journal(bytes: &[u8]) -> bool {
    let folder = folder();
    let path = folder.path().join("state");
    fs::write(&path, bytes).expect("a file");
    let Some(journal) = open(&path) else { return false };
    let n = journal.n_taken_up();
    // Results of other phases count, but are of no use.
    match bake(&journal) {
        Ok(n_computed) => assert!(n + n_computed >= COSTS.len()),
        Err(halt) => assert!(matches!(halt, Halt::Store(_)), "{halt}"),
    }
    drop(journal);
    let again = open(&path).expect("what was opened can be opened again");
    assert!(again.n_taken_up() >= n && (n > 0 || bake(&again) == Ok(0)));
    again.remove().expect("it is its own");
    n > 0
}

/// Parts of a job.
pub fn parts() -> Vec<Vec<u8>> {
    let folder = folder();
    let job = job(&folder.path().join("job"));
    (0..3).map(|shard| fs::read(job.part_path(shard)).expect("a part")).collect()
}

/// A part is broken, or is the one that was written.
pub fn check_part(bytes: &[u8]) -> bool {
    // Made once, and put back as it was.
    static MADE: LazyLock<(tempfile::TempDir, Job)> = LazyLock::new(|| {
        let folder = folder();
        let job = job(&folder.path().join("job"));
        (folder, job)
    });
    let (folder, job) = (MADE.1.folder(), &MADE.1);
    let mut n_done = 0;
    for shard in 0..3 {
        let path = job.part_path(shard);
        let before = fs::read(&path).expect("a part");
        fs::write(&path, bytes).expect("a part");
        let job = Job::open(folder, PROGRAM).expect("a job");
        let state = job.state(shard).expect("a shard");
        let store = JobStore::new(job, JobRole::Merge, Duration::ZERO).expect("a role");
        match state {
            ShardState::Done => {
                assert!(bytes == before, "a part of other bytes");
                assert_eq!(bake(&store), Ok(0));
                n_done += 1;
            }
            ShardState::Broken(_) => {
                assert_eq!(bake(&store), Err(Halt::Shared));
                let missing =
                    matches!(store.outcome(), Some(JobProgress::Missing { shards, .. }) if shards[0].0 == shard);
                assert!(missing, "shard {shard} is missing");
            }
            state => panic!("{state:?}"),
        }
        fs::write(&path, before).expect("a part");
    }
    n_done > 0
}

/// Manifests of a job before its phase is known, and after.
pub fn manifests() -> Vec<Vec<u8>> {
    let folder = folder();
    let new = Manifest::new(PROGRAM, KEY, vec!["build".to_owned(), "a.glb".to_owned()], "/".to_owned(), 3);
    Job::create(&folder.path().join("new"), new).expect("an empty folder");
    job(&folder.path().join("job"));
    ["new", "job"].map(|name| fs::read(folder.path().join(name).join("job.json")).expect("a manifest")).to_vec()
}

/// A manifest is refused by its name, or all that is asked about the job has an answer.
pub fn check_manifest(bytes: &[u8]) -> bool {
    let folder = folder();
    let path = folder.path().join("job.json");
    fs::write(&path, bytes).expect("a file");
    fs::create_dir(folder.path().join("parts")).expect("a folder");
    let job = match Job::open(folder.path(), PROGRAM) {
        Ok(job) => job,
        Err(error) => {
            assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
            return false;
        }
    };
    let n = job.manifest().n_shards();
    for shard in (0..n.min(50)).chain([n]) {
        assert_eq!(job.state(shard).is_ok(), shard < n);
        assert_eq!(job.has_damaged_part(shard).is_ok(), shard < n);
        let store = JobStore::new(job.clone(), JobRole::shard(shard), Duration::ZERO);
        assert_eq!(store.is_ok(), shard < n);
        // A shard does its part, or is of another bake.
        if let Ok(store) = store {
            assert!(bake(&store).is_err());
        }
    }
    let store = JobStore::new(job, JobRole::Merge, Duration::ZERO).expect("a role");
    // No more than a phase is planned.
    let _ = bake(&store);
    true
}
