//! Bakes that stop and go on.

use crate::toy::{PROGRAM, key, toy};
use proptest::prelude::*;
use sightlines_checkpoint::{Journal, Opening, StateError};
use sightlines_progress::UnitStore;
use std::fs;
use std::path::Path;
use std::time::Duration;

fn open(path: &Path, of: &str, opening: Opening) -> Result<Journal, StateError> {
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
            let journal = open(&path, "a", Opening::Resume).unwrap();
            let had = journal.n_taken_up();
            let baked = stopped.bake(Some(&journal));
            prop_assert!(had + stopped.n().min(stop_after) <= n[0] + n[1]);
            if let Ok(bytes) = baked {
                prop_assert_eq!(&bytes, &expected);
            }
            if let Ok(mut bytes) = fs::read(&path) {
                if torn % 2 == 0 { bytes.truncate((bytes.len() - torn / 2).max(41)) } else { bytes.extend(vec![7; torn]) }
                fs::write(&path, bytes).unwrap();
            }
        }
        let last = toy(n);
        let journal = open(&path, "a", Opening::Resume).unwrap();
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
    let journal = open(&path, "a", Opening::Anew).unwrap();
    journal.save("pairs", 3, b"wrong").unwrap();
    let journal = open(&path, "a", Opening::Resume).unwrap();
    assert_ne!(toy([5, 5]).bake(Some(&journal)), toy([5, 5]).bake(None));
}

#[test]
fn short_bakes_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    let journal = Journal::open(&path, key("a"), PROGRAM, Opening::Anew, Duration::from_secs(3600)).unwrap();
    toy([4, 4]).bake(Some(&journal)).unwrap();
    assert!(
        !path.exists()
            && !journal.is_in_file()
            && journal.load("pairs", 3).unwrap().is_some()
            && journal.load("pairs", 4).unwrap().is_none()
    );
    journal.flush().unwrap();
    assert!(path.exists() && journal.is_in_file());
    assert_eq!(open(&path, "a", Opening::Resume).unwrap().n_taken_up(), 8);
    // And no other file either.
    journal.remove().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn files_of_other_bakes_are_refused_or_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    toy([4, 4]).bake(Some(&open(&path, "a", Opening::Anew).unwrap())).unwrap();
    let error = open(&path, "b", Opening::Resume).unwrap_err().to_string();
    assert_eq!(error, format!("{}: the results are of another input or of other options", path.display()));
    let error = Journal::open(&path, key("a"), "2.0", Opening::Resume, Duration::ZERO).unwrap_err().to_string();
    assert_eq!(error, format!("{}: written by version 1.0 of the program, and this is 2.0", path.display()));
    // Until there is something to replace it with, it stays.
    let other = open(&path, "b", Opening::Anew).unwrap();
    assert_eq!(open(&path, "a", Opening::Resume).unwrap().n_taken_up(), 8);
    toy([2, 0]).bake(Some(&other)).unwrap();
    assert_eq!(open(&path, "b", Opening::Resume).unwrap().n_taken_up(), 2);
    // What is something else is never overwritten.
    fs::write(&path, "a letter").unwrap();
    for opening in [Opening::Anew, Opening::Resume] {
        assert!(matches!(open(&path, "a", opening), Err(StateError::NotState(_))), "{opening:?}");
    }
    // What some systems leave of a file whose writer was stopped is nothing.
    fs::write(&path, "").unwrap();
    assert_eq!(open(&path, "a", Opening::Resume).unwrap().n_taken_up(), 0);
}

#[test]
fn a_file_that_cannot_be_written_ends_the_bake_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gone/out.state");
    let halted = toy([2, 2]).bake(Some(&open(&path, "a", Opening::Anew).unwrap())).unwrap_err().to_string();
    assert!(halted.starts_with(&format!("{}: cannot be written: ", path.display())), "{halted}");
    let journal = open(&path, "a", Opening::Anew).unwrap().or_in_memory();
    assert_eq!(toy([2, 2]).bake(Some(&journal)), toy([2, 2]).bake(None));
    assert!(journal.failure().is_some_and(|text| text.contains("cannot be written")));
    assert!(journal.load("objects", 1).unwrap().is_some() && !journal.is_in_file());
}

/// Two processes that write to one file: each result is a whole record of one of them.
#[test]
fn two_writers_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.state");
    let first = open(&path, "a", Opening::Anew).unwrap();
    first.save("pairs", 0, b"0").unwrap();
    let second = open(&path, "a", Opening::Resume).unwrap();
    for unit in 1..50 {
        [&first, &second][unit % 2].save("pairs", unit, &vec![unit as u8; unit]).unwrap();
    }
    for unit in 1..50 {
        let of = [&first, &second][unit % 2];
        assert_eq!(of.load("pairs", unit).unwrap(), Some(vec![unit as u8; unit]));
    }
    assert_eq!(open(&path, "a", Opening::Resume).unwrap().n_taken_up(), 50);
}
