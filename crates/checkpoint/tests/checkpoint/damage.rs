//! Whatever the bytes of a file are, nothing wrong is taken and nothing panics.

use crate::jobs::{copy_of_first_phase, run};
use crate::toy::{PROGRAM, key, toy};
use proptest::prelude::*;
use sightlines_checkpoint::{Job, JobProgress, JobRole, Journal, OpenMode, ShardState};
use std::fs;
use std::time::Duration;

/// One byte changed, or the end cut off.
fn damaged(bytes: &[u8], at: usize, flip: u8) -> Vec<u8> {
    let at = at % bytes.len();
    if flip == 0 {
        return bytes[..at].to_vec();
    }
    let mut changed = bytes.to_vec();
    changed[at] ^= flip;
    changed
}

proptest! {
    /// Invariant: a damaged journal is refused, or gives the right answer.
    #[test]
    fn damaged_journals_give_no_wrong_answer(at in any::<usize>(), flip in any::<u8>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.state");
        let open = || Journal::open(&path, key("a"), PROGRAM, OpenMode::Resume, Duration::ZERO);
        let expected = toy([5, 5]).bake(Some(&open().unwrap())).unwrap();
        fs::write(&path, damaged(&fs::read(&path).unwrap(), at, flip)).unwrap();
        if let Ok(journal) = open() {
            prop_assert_eq!(toy([5, 5]).bake(Some(&journal)).unwrap(), expected);
        }
    }

    /// Invariant: damage costs the results of the records that it touches, and no others. Between two records it costs at most one.
    #[test]
    fn only_what_is_damaged_is_computed_again(at in any::<usize>(), flip in 1..=255_u8, n_bytes in 1..60_usize, cut in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.state");
        let open = || Journal::open(&path, key("a"), PROGRAM, OpenMode::Resume, Duration::ZERO);
        let expected = toy([9, 9]).bake(Some(&open().unwrap())).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        // Behind the header.
        let at = 53 + at % (bytes.len() - 53);
        let end = (at + n_bytes).min(bytes.len());
        // No record is shorter than 35 bytes.
        let n_touched = (end - at).div_ceil(35) + 1;
        if cut { drop(bytes.drain(at..end)) } else { bytes[at..end].iter_mut().for_each(|byte| *byte ^= flip) }
        fs::write(&path, bytes).unwrap();
        let journal = open().unwrap();
        prop_assert!(journal.n_taken_up() + n_touched >= 18, "{} of 18", journal.n_taken_up());
        let again = toy([9, 9]);
        prop_assert_eq!(again.bake(Some(&journal)).unwrap(), expected);
        prop_assert_eq!(again.n(), 18 - journal.n_taken_up());
        drop(journal);
        prop_assert_eq!(open().unwrap().n_taken_up(), 18);
    }

    /// Invariant: a damaged part is never merged.
    #[test]
    fn damaged_parts_are_found(at in any::<usize>(), flip in any::<u8>(), shard in 0..3_usize) {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("job");
        let job = copy_of_first_phase(&folder);
        let part = fs::read(job.part_path(shard)).unwrap();
        fs::write(job.part_path(shard), damaged(&part, at, flip)).unwrap();
        prop_assert!(matches!(job.state(shard).unwrap(), ShardState::Broken(_)));
        match run(&folder, [6, 4], JobRole::Merge) {
            Err(JobProgress::Missing { shards, .. }) => prop_assert_eq!(shards[0].0, shard),
            other => prop_assert!(false, "{:?}", other),
        }
    }

    /// Invariant: a damaged manifest is refused with the name of the file, or is still one that can be worked with.
    #[test]
    fn damaged_manifests_do_no_harm(at in any::<usize>(), flip in any::<u8>()) {
        let all = tempfile::tempdir().unwrap();
        let folder = all.path().join("job");
        copy_of_first_phase(&folder);
        let path = folder.join("job.json");
        fs::write(&path, damaged(&fs::read(&path).unwrap(), at, flip)).unwrap();
        match Job::open(&folder, PROGRAM) {
            Err(error) => prop_assert!(error.to_string().starts_with(&path.display().to_string())),
            Ok(job) => for shard in 0..job.manifest().n_shards() {
                prop_assert!(job.state(shard).is_ok());
            },
        }
    }

    /// Invariant: rubbish is refused.
    #[test]
    fn rubbish_is_refused(bytes in prop::collection::vec(any::<u8>(), 1..200)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.state");
        fs::write(&path, &bytes).unwrap();
        prop_assert!(Journal::open(&path, key("a"), PROGRAM, OpenMode::Resume, Duration::ZERO).is_err());
        fs::write(folder.path().join("job.json"), &bytes).unwrap();
        prop_assert!(Job::open(folder.path(), PROGRAM).is_err());
    }
}

#[test]
fn manifests_are_refused_by_place() {
    let all = tempfile::tempdir().unwrap();
    let folder = all.path().join("job");
    copy_of_first_phase(&folder);
    let path = folder.join("job.json");
    let text = fs::read_to_string(&path).unwrap();
    for (from, to, reason) in [
        ("\"sightlines-job\"", "\"other\"", "this is no manifest of a job"),
        ("\"version\": 1", "\"version\": 9", "version 9 of the manifest is not supported"),
        ("\"pairs\"", "\"Pairs\"", "phase 0: the name is not of small letters and hyphens, or another phase has it"),
        (
            "\"begin\": 0",
            "\"begin\": 1",
            "phase 0: shard 0 does not begin where the one before it ends, or its cost is no number",
        ),
        ("\"n_units\": 6", "\"n_units\": 7", "phase 0: the shards do not end with the last unit"),
        ("\"key\": \"", "\"key\": \"0", "key: not 32 hexadecimal digits"),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        fs::write(&path, text.replace(from, to)).unwrap();
        assert_eq!(Job::open(&folder, PROGRAM).unwrap_err().to_string(), format!("{}: {reason}", path.display()));
    }
}
