//! REJECT lumps of several WADs: the maps of all are units of one phase, and each file is as if it had been done alone.

use crate::reject::{BLIND, three_maps, with_wall};
use sightlines_bake::{RejectError, RejectMaps, RejectOptions, RejectTables, RejectWadsError, reject_wad, reject_wads};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Wad};
use sightlines_progress::{Cancelled, Halt, Progress, Units};
use sightlines_testkit::units::{Memory, Results};
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// Maps by names, each a row of rooms of another length, or damaged.
fn wad(maps: &[(&str, Option<u16>)]) -> Wad {
    let mut builder = WadBuilder::new(WadKind::Patch);
    builder.lump("FIRST", b"something else").unwrap();
    for (name, n_sectors) in maps {
        let mut map = with_wall(n_sectors.unwrap_or(2));
        if n_sectors.is_none() {
            map.0.lines[3].v2 = 99;
        }
        map.0.add_to(&mut builder, LumpName::new(name).unwrap()).unwrap();
    }
    Wad::parse(builder.finish().unwrap()).unwrap()
}

/// Three files with six maps, one of which is damaged.
fn files() -> Vec<Wad> {
    let some = [("MAP01", Some(5)), ("MAP04", None), ("E1M1", Some(9))];
    vec![three_maps(&BLIND), wad(&some[..2]), wad(&some[2..])]
}

type Found = Result<Vec<Result<RejectTables, RejectError>>, RejectWadsError<usize>>;

/// Does files; also which of them were read.
fn run(files: &[Wad], options: &RejectOptions<'_>) -> (Found, Vec<usize>) {
    let maps: Vec<RejectMaps> = files.iter().map(|wad| RejectMaps::of(wad, &options.maps)).collect();
    let read = RefCell::new(Vec::new());
    let found = reject_wads(
        &maps,
        |k| {
            read.borrow_mut().push(k);
            files.get(k).ok_or(k)
        },
        options,
    );
    (found, read.into_inner())
}

/// The bytes that each file gets.
fn bytes(files: &[Wad], found: &Found, names: &[String]) -> Vec<Option<Vec<u8>>> {
    let found = found.as_ref().unwrap();
    assert_eq!(found.len(), files.len());
    let one = |(wad, tables): (&Wad, &Result<RejectTables, RejectError>)| {
        let tables = tables.as_ref().ok()?;
        Some(tables.write(wad, &RejectMaps::of(wad, names)).unwrap())
    };
    files.iter().zip(found).map(one).collect()
}

const ONE: RejectOptions<'_> = RejectOptions {
    maps: Vec::new(),
    force: false,
    strict: false,
    game: None,
    rmb: None,
    threads: 1,
    progress: None,
    units: Units(None),
};

#[test]
fn each_file_is_as_if_it_were_alone() {
    let files = files();
    let (found, read) = run(&files, &ONE);
    assert_eq!(read, [0, 1, 2], "each is read once");
    let alone: Vec<_> = files.iter().map(|wad| reject_wad(wad, &ONE).unwrap()).collect();
    let together = bytes(&files, &found, &[]);
    for ((alone, together), tables) in alone.iter().zip(&together).zip(found.unwrap()) {
        assert_eq!(Some(&alone.bytes), together.as_ref());
        let tables = tables.unwrap();
        assert!(tables.maps.iter().zip(&alone.maps).all(|(a, b)| (a.name, &a.status) == (b.name, &b.status)));
        assert_eq!(tables.maps.len(), alone.maps.len());
    }
    // The impostor: files in another order are told apart.
    assert!(together[0] != together[1] && together[1] != together[2]);
    let (found, _) = run(&files[..2], &ONE);
    let [Ok(first), Ok(second)] = &found.unwrap()[..] else { panic!("two files") };
    let [of_first, of_second] = [0, 1].map(|k: usize| RejectMaps::of(&files[k], &[]));
    assert_eq!(first.write(&files[1], &of_first), Err(RejectError::Changed));
    assert_eq!(first.write(&files[1], &of_second).unwrap_err(), RejectError::Changed);
    assert!(second.write(&files[1], &of_second).is_ok());
}

/// One phase for all maps; three processes that each do some of them, and one that puts them together, which reads no file.
#[test]
fn the_maps_of_all_files_are_units_of_one_phase() {
    let mut files = files();
    // Without the damaged map, of which the reason is found out again.
    files[1] = wad(&[("MAP01", Some(5)), ("MAP04", Some(3))]);
    let with = |store: &Memory| run(&files, &RejectOptions { units: Units(Some(store)), ..ONE });
    let mut kept = Results::new();
    for third in 0..3 {
        let store = Memory::default().of_part(third, 3);
        let (found, read) = with(&store);
        assert_eq!(found, Err(RejectWadsError::Halted(Halt::Shared)));
        assert!(read.is_sorted_by(|a, b| a < b), "{read:?}");
        let costs: Vec<f64> = match &store.phases()[..] {
            [("maps", costs)] => costs.clone(),
            other => panic!("{other:?}"),
        };
        assert_eq!(costs.len(), 6);
        let mut computed = store.into_results();
        assert_eq!(computed.keys().copied().collect::<Vec<_>>(), [("maps", third), ("maps", third + 3)]);
        kept.append(&mut computed);
    }
    let (alone, _) = run(&files, &ONE);
    let (merged, read) = with(&Memory::with(&kept).of_part(3, 3));
    assert!(read.is_empty());
    assert_eq!(bytes(&files, &merged, &[]), bytes(&files, &alone, &[]));
    // A process of which a map of the last file is, reads no other.
    let last = Memory::default().of_part(5, 6);
    assert_eq!(with(&last).1, [2]);
    // Stopped after some maps, and taken up.
    let store = Memory::default().stopping_after(4);
    assert_eq!(with(&store).0, Err(RejectWadsError::Halted(Halt::Cancelled(Cancelled))));
    let store = Memory::with(&store.into_results());
    let (resumed, read) = with(&store);
    assert_eq!((read, bytes(&files, &resumed, &[])), (vec![1, 2], bytes(&files, &alone, &[])));
    // In passes, as workers go through a phase.
    let (passed, _) = with(&Memory::default().in_passes(3));
    assert_eq!(bytes(&files, &passed, &[]), bytes(&files, &alone, &[]));
    // The impostor: the tables of two files, exchanged.
    let [a, b] = [("maps", 0), ("maps", 3)];
    let (of_a, of_b) = (kept[&a].clone(), kept[&b].clone());
    kept.extend([(a, of_b), (b, of_a)]);
    let (mixed, _) = with(&Memory::with(&kept).of_part(3, 3));
    assert!(bytes(&files, &mixed, &[]) != bytes(&files, &alone, &[]));
}

#[test]
fn a_file_that_cannot_be_done_is_left_out() {
    let mut files = files();
    let bad = wad(&[("MAP02", None), ("MAP03", None)]);
    files.insert(1, bad.clone());
    let reason = reject_wad(&bad, &ONE).unwrap_err();
    assert!(reason.to_string().starts_with("map MAP02: LINEDEFS 3: vertex 99"), "{reason}");
    let (found, _) = run(&files, &ONE);
    let found = found.unwrap();
    assert_eq!(found[1], Err(reason.clone()));
    assert!([0, 2, 3].iter().all(|&k| found[k].is_ok()));
    // So it is for shards: the unit is kept as one that failed, and the reason is found again.
    let store = Memory::default();
    let kept = |store: &Memory| run(&files, &RejectOptions { units: Units(Some(store)), ..ONE });
    assert_eq!(kept(&store).0.unwrap()[1], Err(reason.clone()));
    let (merged, read) = kept(&Memory::with(&store.into_results()).of_part(1, 1));
    assert_eq!((&merged.unwrap()[1], read), (&Err(reason.clone()), vec![1, 2]));
    // Named, the map is one that its file insists on; the others have none of that name.
    let named = RejectOptions { maps: vec!["map04".to_owned()], ..ONE };
    let (found, _) = run(&files[1..3], &named);
    let found = found.unwrap();
    assert_eq!(found[0], Err(RejectError::NoMaps));
    assert!(matches!(&found[1], Err(RejectError::Map(_))), "{found:?}");
    // Strict, the first is an error, with its file; so is a map that is named in a file that is alone.
    let strict = RejectOptions { strict: true, ..ONE };
    assert_eq!(run(&files, &strict).0, Err(RejectWadsError::File { file: 1, source: reason.clone() }));
    let named = RejectOptions { maps: vec!["MAP02".to_owned()], ..ONE };
    assert_eq!(run(&files[1..2], &named).0, Err(RejectWadsError::File { file: 0, source: reason }));
}

#[test]
fn files_that_cannot_be_read_or_have_changed_are_errors() {
    let files = files();
    let maps: Vec<RejectMaps> = files.iter().map(|wad| RejectMaps::of(wad, &[])).collect();
    assert_eq!(maps.iter().map(RejectMaps::len).collect::<Vec<_>>(), [3, 2, 1]);
    let read = |k: usize| if k == 1 { Err("gone") } else { Ok(&files[k]) };
    assert_eq!(reject_wads(&maps, read, &ONE), Err(RejectWadsError::Read("gone")));
    let changed = reject_wads(&maps, |k| Ok::<_, ()>(&files[if k == 2 { 0 } else { k }]), &ONE);
    assert_eq!(changed, Err(RejectWadsError::File { file: 2, source: RejectError::Changed }));
    assert_eq!(reject_wads(&[], |_| Ok::<&Wad, ()>(&files[0]), &ONE), Ok(Vec::new()));
}

/// The share of progress is that of all maps, and an observer that cancels ends the work: no map counts as one that cannot be done.
#[test]
fn progress_is_that_of_all_maps_and_cancels_all() {
    let files = files();
    let seen = Mutex::new(Vec::new());
    let watch = |progress: Progress| {
        seen.lock().unwrap().push(progress.share);
        ControlFlow::Continue(())
    };
    let (found, _) = run(&files, &RejectOptions { progress: Some(&watch), ..ONE });
    assert!(found.is_ok());
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 5 && seen.is_sorted(), "{seen:?}");
    assert!(seen.last().is_some_and(|share| (0.999..=1.0).contains(share)), "{seen:?}");
    // After so many reports.
    let n_left = Mutex::new(2);
    let stop = |_: Progress| {
        let mut n_left = n_left.lock().unwrap();
        *n_left -= 1;
        if *n_left < 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let stopping = RejectOptions { progress: Some(&stop), ..ONE };
    assert_eq!(run(&files, &stopping).0, Err(RejectWadsError::Halted(Halt::Cancelled(Cancelled))));
    // In the second map of a file too, although the first is done.
    let two = wad(&[("MAP01", Some(4)), ("MAP02", Some(4))]);
    *n_left.lock().unwrap() = 1000;
    assert!(reject_wad(&two, &stopping).is_ok());
    let n_reports = 1000 - *n_left.lock().unwrap();
    assert!(n_reports >= 4, "{n_reports}");
    *n_left.lock().unwrap() = n_reports / 2;
    assert_eq!(reject_wad(&two, &stopping), Err(RejectError::Halted(Halt::Cancelled(Cancelled))));
}
