//! Bakes that stop and go on.

use crate::toy::{PROGRAM, key, toy};
use proptest::prelude::*;
use sightlines_checkpoint::{Journal, OpenMode, StateError};
use sightlines_progress::{Phase, UnitStore};
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Bytes of a header of [`PROGRAM`].
const HEADER: usize = 46 + 3 + 4;

fn open(path: &Path, of: &str, opening: OpenMode) -> Result<Journal, StateError> {
    Journal::open(path, key(of), PROGRAM, opening, Duration::ZERO)
}

proptest! {
    /// Invariant: a bake that is stopped after any number of units, with any part of the file's tail lost or any rubbish behind it, gives the bytes
    /// of one that is not stopped, and computes each whole record once.
    #[test]
    fn stopped_bakes_go_on(n in [0..9_usize, 0..9_usize], stops in prop::collection::vec((0..6_usize, 0..40_usize), 0..5)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.state");
        let expected = toy(n).bake(None).unwrap();
        for (stop_after, torn) in stops {
            let mut stopped = toy(n);
            stopped.stop_after = stop_after;
            let journal = open(&path, "a", OpenMode::Resume).unwrap();
            let had = journal.n_taken_up();
            let baked = stopped.bake(Some(&journal));
            prop_assert!(had + stopped.n().min(stop_after) <= n[0] + n[1]);
            if let Ok(bytes) = baked {
                prop_assert_eq!(&bytes, &expected);
            }
            if let Ok(mut bytes) = fs::read(&path) {
                if torn % 2 == 0 { bytes.truncate((bytes.len() - torn / 2).max(HEADER)) } else { bytes.extend(vec![7; torn]) }
                fs::write(&path, bytes).unwrap();
            }
        }
        let last = toy(n);
        let journal = open(&path, "a", OpenMode::Resume).unwrap();
        let had = journal.n_taken_up();
        prop_assert_eq!(last.bake(Some(&journal)).unwrap(), expected);
        prop_assert_eq!(had + last.n(), n[0] + n[1]);
        journal.remove().unwrap();
        prop_assert!(!path.exists());
    }
}

/// The impostor: results of another bake do change the answer.
#[test]
fn a_wrong_result_is_noticed_by_the_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    let journal = open(&path, "a", OpenMode::Anew).unwrap();
    journal.save("pairs", 3, b"wrong").unwrap();
    drop(journal);
    let journal = open(&path, "a", OpenMode::Resume).unwrap();
    assert_ne!(toy([5, 5]).bake(Some(&journal)), toy([5, 5]).bake(None));
}

#[test]
fn short_bakes_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    let journal = Journal::open(&path, key("a"), PROGRAM, OpenMode::Anew, Duration::from_secs(3600)).unwrap();
    toy([4, 4]).bake(Some(&journal)).unwrap();
    assert!(
        !path.exists()
            && !journal.is_in_file()
            && journal.load("pairs", 3).unwrap().is_some()
            && journal.load("pairs", 4).unwrap().is_none()
    );
    journal.flush().unwrap();
    assert!(path.exists() && journal.is_in_file());
    drop(journal);
    let journal = open(&path, "a", OpenMode::Resume).unwrap();
    assert_eq!(journal.n_taken_up(), 8);
    // And no other file either.
    journal.remove().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn files_of_other_bakes_are_refused_or_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    toy([4, 4]).bake(Some(&open(&path, "a", OpenMode::Anew).unwrap())).unwrap();
    let error = open(&path, "b", OpenMode::Resume).unwrap_err().to_string();
    assert_eq!(error, format!("{}: the results are of another input or of other options", path.display()));
    let error = Journal::open(&path, key("a"), "2.0", OpenMode::Resume, Duration::ZERO).unwrap_err().to_string();
    assert_eq!(error, format!("{}: written by version 1.0 of the program, and this is 2.0", path.display()));
    let before = folder.path().join("out.state.before");
    // Until there is something to replace it with, it stays, and then it is kept aside.
    let other = open(&path, "b", OpenMode::Anew).unwrap();
    assert_eq!((other.n_before(), other.before_path()), (0, before.clone()));
    assert!(matches!(open(&path, "a", OpenMode::Resume), Err(StateError::InUse(_))));
    toy([2, 0]).bake(Some(&other)).unwrap();
    drop(other);
    assert_eq!(open(&path, "b", OpenMode::Resume).unwrap().n_taken_up(), 2);
    assert_eq!(open(&before, "a", OpenMode::Resume).unwrap().n_taken_up(), 8);
    // So are results of the same bake, until it is done.
    let again = || open(&path, "b", OpenMode::Anew).unwrap();
    let stopped = again();
    assert_eq!((stopped.n_before(), stopped.n_taken_up()), (2, 0));
    assert!(toy([2, 0]).bake(Some(&stopped)).is_ok());
    assert_eq!(open(&before, "b", OpenMode::Resume).unwrap().n_taken_up(), 2);
    stopped.remove().unwrap();
    assert!(!path.exists() && !before.exists());
    toy([2, 0]).bake(Some(&again())).unwrap();
    again().remove().unwrap();
    assert!(!path.exists(), "a bake that was done before it had a file needs older results no more");
    // Those of another bake stay, and so does what is none of ours.
    toy([4, 4]).bake(Some(&open(&path, "a", OpenMode::Anew).unwrap())).unwrap();
    again().remove().unwrap();
    assert!(path.exists());
    fs::write(&before, "a letter").unwrap();
    let refused = toy([2, 0]).bake(Some(&again())).unwrap_err().to_string();
    assert_eq!(refused, format!("{}: this is no file of results of units", before.display()));
    fs::remove_file(&before).unwrap();
    // The form of another version is not read, and not lost.
    let mut bytes = fs::read(&path).unwrap();
    bytes[8] = 1;
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(open(&path, "a", OpenMode::Resume), Err(StateError::OtherForm(_))));
    toy([2, 0]).bake(Some(&again())).unwrap();
    assert!(fs::read(&before).unwrap() == bytes);
    // So is what the program kept of searches before there were units.
    fs::write(&path, b"\x8ESLVIS\r\n\x01\0\0\0").unwrap();
    assert!(matches!(open(&path, "a", OpenMode::Resume), Err(StateError::OtherForm(_))));
    // What is something else is never overwritten.
    fs::write(&path, "a letter").unwrap();
    for opening in [OpenMode::Anew, OpenMode::Resume] {
        assert!(matches!(open(&path, "a", opening), Err(StateError::NotState(_))), "{opening:?}");
    }
    // What some systems leave of a file whose writer was stopped is nothing.
    fs::write(&path, "").unwrap();
    assert_eq!(open(&path, "a", OpenMode::Resume).unwrap().n_taken_up(), 0);
}

#[test]
fn a_file_that_cannot_be_written_ends_the_bake_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gone/out.state");
    let halted = toy([2, 2]).bake(Some(&open(&path, "a", OpenMode::Anew).unwrap())).unwrap_err().to_string();
    assert!(halted.starts_with(&format!("{}: cannot be written: ", path.display())), "{halted}");
    let journal = open(&path, "a", OpenMode::Anew).unwrap().or_in_memory();
    assert_eq!(toy([2, 2]).bake(Some(&journal)), toy([2, 2]).bake(None));
    assert!(journal.failure().is_some_and(|text| text.contains("cannot be written")));
    assert!(journal.load("objects", 1).unwrap().is_some() && !journal.is_in_file());
}

/// A file belongs to one journal at a time, whether it was there before or not.
#[test]
fn a_file_has_one_writer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    let [first, second, third] = [(); 3].map(|()| open(&path, "a", OpenMode::Anew).unwrap());
    first.save("pairs", 0, b"0").unwrap();
    for opening in [OpenMode::Anew, OpenMode::Resume] {
        let error = open(&path, "a", opening).unwrap_err().to_string();
        assert_eq!(error, format!("{}: another process keeps its results in this file", path.display()));
    }
    // Those that began before there was a file notice it late, and end even if they would go on without a file.
    assert!(second.save("pairs", 0, b"1").unwrap_err().to_string().ends_with("keeps its results in this file"));
    drop(first);
    assert!(third.or_in_memory().save("pairs", 0, b"1").is_err());
    let taken_up = open(&path, "a", OpenMode::Resume).unwrap();
    assert_eq!((taken_up.n_taken_up(), taken_up.load("pairs", 0).unwrap()), (1, Some(b"0".to_vec())));
    // Another file that has the name by now is not removed.
    fs::remove_file(&path).unwrap();
    fs::write(&path, "a letter").unwrap();
    assert!(matches!(taken_up.remove(), Err(StateError::Replaced(_))));
    assert_eq!(fs::read(&path).unwrap(), b"a letter");
}

/// A bake that is divided otherwise under the same key is noticed; so it is if only the costs differ.
#[test]
fn other_units_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    toy([4, 4]).bake(Some(&open(&path, "a", OpenMode::Anew).unwrap())).unwrap();
    let error = toy([4, 5]).bake(Some(&open(&path, "a", OpenMode::Resume).unwrap())).unwrap_err().to_string();
    let of = |phase| format!("{}: the results of phase {phase} are of other units than this bake has", path.display());
    assert_eq!(error, of("objects"));
    let journal = open(&path, "a", OpenMode::Resume).unwrap();
    let begin = |costs: &[f64]| journal.begin(&Phase::new("pairs", costs));
    assert_eq!(begin(&[4.0, 3.0, 2.0, 1.0]), Ok(()));
    assert_eq!(begin(&[4.0, 3.0, 2.0, 1.5]).unwrap_err().to_string(), of("pairs"));
    assert_eq!(journal.n_taken_up(), 8, "what states the division is no result");
}
