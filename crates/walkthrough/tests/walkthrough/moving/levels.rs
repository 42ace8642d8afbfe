//! Levels that are read while the original is drawn.

use sightlines_pvs::CellId;
use sightlines_walkthrough::{Draw, LevelError, LevelIndex, LevelPrefetcher, LevelSize, LoadLevel};
use std::sync::{Arc, Mutex};

/// Returns the number of a level while it is allowed to, and records the requests.
#[derive(Clone, Default)]
struct Loader {
    is_shut: Arc<Mutex<bool>>,
    fails: Option<u32>,
    asked: Arc<Mutex<Vec<u32>>>,
}

impl LoadLevel for Loader {
    type Level = String;
    type Error = String;

    fn load(&mut self, level: u32) -> Result<String, String> {
        while *self.is_shut.lock().unwrap() {
            std::thread::yield_now();
        }
        self.asked.lock().unwrap().push(level);
        if self.fails == Some(level) { Err(format!("no level {level}")) } else { Ok(format!("level {level}")) }
    }
}

/// Cells 0 and 1 have level 0; 2 and 3 level 1; 4 none; 5 level 2, which is large.
fn index() -> LevelIndex {
    let sizes = [100, 100, 5000].map(|bytes| LevelSize { bytes, n_triangles: bytes / 10 });
    LevelIndex::new(vec![Some(0), Some(0), Some(1), Some(1), None, Some(2)], sizes.to_vec()).unwrap()
}

fn cells(ids: &[u32]) -> Vec<CellId> {
    ids.iter().copied().map(CellId).collect()
}

/// Runs frames until all requested levels have arrived; returns the last one.
fn settle(levels: &mut LevelPrefetcher<Loader>, at: &[u32], ahead: &[u32]) -> Draw<String> {
    levels.frame(&cells(at), &cells(ahead));
    while !levels.is_idle() {
        std::thread::yield_now();
    }
    levels.frame(&cells(at), &cells(ahead))
}

fn level(n: u32) -> Draw<String> {
    Draw::Level { level: n, scene: Arc::new(format!("level {n}")) }
}

#[test]
fn levels_are_for_all_cells_that_the_eye_is_in() {
    let index = index();
    let at = |ids: &[u32]| index.level_at(&cells(ids));
    assert_eq!([at(&[0]), at(&[0, 1]), at(&[2, 3]), at(&[5])], [Some(0), Some(0), Some(1), Some(2)]);
    assert_eq!([at(&[]), at(&[4]), at(&[1, 2]), at(&[3, 4]), at(&[9]), at(&[0, 9])], [None; 6]);
    assert_eq!((index.n_triangles_at(&cells(&[2]), 777), index.n_triangles_at(&cells(&[1, 2]), 777)), (10, 777));
    assert_eq!((index.n_cells(), index.levels().len()), (6, 3));
    let wrong = LevelIndex::new(vec![None, Some(1)], vec![LevelSize::default()]).unwrap_err();
    assert_eq!(wrong, LevelError::UnknownLevel { cell: CellId(1), level: 1, n_levels: 1 });
    assert_eq!(wrong.to_string(), "cell 1 has level 1 of 1");
}

#[test]
fn originals_are_drawn_until_a_level_comes() {
    let loader = Loader::default();
    *loader.is_shut.lock().unwrap() = true;
    let mut levels = LevelPrefetcher::new(index(), loader.clone(), 1000);
    // The loader is blocked: if a frame waited, this would never end.
    for _ in 0..1000 {
        assert_eq!(levels.frame(&cells(&[0]), &cells(&[2])), Draw::Original);
    }
    assert_eq!((levels.counters().late, levels.counters().frames), (1000, 1000));
    *loader.is_shut.lock().unwrap() = false;
    assert_eq!(settle(&mut levels, &[0], &[2]), level(0));
    // A level that was ahead is ready at once.
    let n_late = levels.counters().late;
    assert_eq!(levels.frame(&cells(&[3]), &[]), level(1));
    assert_eq!(levels.counters().late, n_late);
    assert_eq!(*loader.asked.lock().unwrap(), [0, 1]);
    // On the border between levels, in a cell without one, and outside: the original.
    for at in [&[1, 2][..], &[4], &[3, 4], &[]] {
        assert_eq!(settle(&mut levels, at, &[]), Draw::Original, "{at:?}");
    }
    assert_eq!(settle(&mut levels, &[0, 1], &[]), level(0));
    assert_eq!(levels.read(), (2, 0));
}

#[test]
fn budget_of_levels_is_kept() {
    let loader = Loader::default();
    let mut levels = LevelPrefetcher::new(index(), loader.clone(), 150);
    for k in 0..20 {
        let (here, ahead) = if k % 2 == 0 { (0, 2) } else { (2, 0) };
        assert_eq!(settle(&mut levels, &[here], &[ahead, 5]), level(k % 2));
        assert_eq!(levels.kept(), (100, 1));
    }
    // The large one is never read, as it exceeds the budget; it counts as unavailable, not as late.
    let n_late = levels.counters().late;
    assert_eq!(settle(&mut levels, &[5], &[]), Draw::Original);
    assert_eq!(levels.counters().late, n_late);
    assert!(!loader.asked.lock().unwrap().contains(&2));
    let mut rich = LevelPrefetcher::new(index(), loader, 5200);
    assert_eq!(settle(&mut rich, &[5], &[0, 2]), level(2));
    assert_eq!(rich.kept(), (5200, 3));
}

#[test]
fn failures_are_reported_and_the_original_is_drawn() {
    let mut levels = LevelPrefetcher::new(index(), Loader { fails: Some(1), ..Loader::default() }, 1000);
    let error = loop {
        assert_eq!(levels.frame(&cells(&[3]), &[]), Draw::Original);
        if let Some(error) = levels.take_error() {
            break error;
        }
    };
    assert_eq!(error, (1, "no level 1".to_owned()));
    assert_eq!(settle(&mut levels, &[0], &[]), level(0));
}

#[test]
fn forgotten_cells_draw_the_original() {
    let mut levels = LevelPrefetcher::new(index(), Loader::default(), 1000);
    assert_eq!(settle(&mut levels, &[0], &[]), level(0));
    levels.forget(cells(&[0, 77]));
    assert_eq!(settle(&mut levels, &[0], &[]), Draw::Original);
    assert_eq!(settle(&mut levels, &[0, 1], &[]), Draw::Original);
    assert_eq!(settle(&mut levels, &[1], &[]), level(0));
    assert_eq!(levels.index().level_of(CellId(0)), None);
    // An index from which a level was removed earlier.
    let mut levels = LevelPrefetcher::new(levels.index().clone(), Loader::default(), 1000);
    assert_eq!(settle(&mut levels, &[1], &[0, 2]), level(0));
    assert_eq!(levels.read(), (2, 0));
}
