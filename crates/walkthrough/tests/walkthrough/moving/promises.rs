//! Broken promises, and the impostor: volumes that last too long.

use crate::moving::grid::{frame, see};
use crate::moving::movers::row;
use sightlines_eye_to_cell::VisibleSet;
use sightlines_geometry::Aabb;
use sightlines_walkthrough::{AnswerKind, Broken, BrokenPromise, Motion, MoverError, MoverId, MoverOptions, Movers};

fn at(x: f64) -> Aabb<3> {
    Aabb { min: [x, 0.25, 0.25], max: [x + 0.25, 0.75, 0.75] }
}

/// A mover comes along the row by one room per second, to a viewer that sees the first four rooms, and stays there: the
/// number of frames in which it is there and missed, and the reports about its promise.
fn missed(promised: f64) -> (usize, Vec<Broken>) {
    let grid = row(40);
    let mut movers = Movers::new(grid.cells(), MoverOptions::default());
    let motion = Motion::speed(promised).unwrap().and_within(movers.bounds()).unwrap();
    movers.add(at(30.0), motion, 0.0).unwrap();
    let mut seen = VisibleSet::new();
    see(&mut seen, 40, 0..4);
    let (mut n_missed, mut broken) = (0, Vec::new());
    for k in 0..6000 {
        let now = f64::from(k) / 60.0;
        let here = at((30.0 - now).max(0.5));
        let reported = movers.frame(now, &frame(&seen, AnswerKind::Full), &mut |_| here).unwrap();
        n_missed += usize::from(here.min[0] <= 4.0 && reported.is_empty());
        broken.extend_from_slice(movers.broken());
    }
    (n_missed, broken)
}

#[test]
fn volumes_that_hold_too_long_are_caught() {
    // Slightly more than it moves, for the rounding of the test's own positions.
    assert_eq!(missed(1.0 + 1e-9), (0, vec![]));
    // The impostor: its volumes last eight times too long.
    let (n_missed, broken) = missed(0.125);
    assert!(n_missed > 0, "nothing was missed: the comparison cannot fail");
    assert!(broken.iter().all(|b| b.promise == BrokenPromise::Speed && b.known_at < b.at));
    assert!(
        !broken.is_empty() && broken[0].to_string().starts_with("mover 0/0 was faster than promised between 0 and ")
    );
}

#[test]
fn broken_promises_are_reported_and_survived() {
    let grid = row(8);
    let mut movers = Movers::new(grid.cells(), MoverOptions::default());
    let room = Aabb { min: [5.0, 0.0, 0.0], max: [6.0, 1.0, 1.0] };
    let id = movers.add(at(5.5), Motion::within(room).unwrap(), 0.0).unwrap();
    let mut seen = VisibleSet::new();
    see(&mut seen, 8, [0]);
    let step =
        |movers: &mut Movers<_>, now: f64, seen: &VisibleSet, here: Aabb<3>| -> (Vec<MoverId>, Vec<BrokenPromise>) {
            let reported = movers.frame(now, &frame(seen, AnswerKind::Full), &mut |_| here).unwrap().to_vec();
            (reported, movers.broken().iter().map(|b| b.promise).collect())
        };
    assert_eq!(step(&mut movers, 1.0, &seen, at(5.25)), (vec![], vec![]));
    assert_eq!(movers.sleeps_in(id), Some(room));
    // It leaves the room unobserved.
    assert_eq!(step(&mut movers, 2.0, &seen, at(2.5)), (vec![], vec![]));
    // The room comes into view: the mover is found elsewhere, and its region is no longer relied upon.
    see(&mut seen, 8, [5]);
    assert_eq!(step(&mut movers, 3.0, &seen, at(2.5)), (vec![], vec![BrokenPromise::Region]));
    assert_eq!(movers.broken()[0].to_string(), "mover 0/0 was outside its region at 3");
    assert_eq!((movers.sleeps_in(id), movers.n_awake()), (None, 1));
    see(&mut seen, 8, [2]);
    assert_eq!(step(&mut movers, 4.0, &seen, at(2.5)), (vec![id], vec![]));
    // No box at all: it counts as visible.
    for nonsense in
        [Aabb::EMPTY, Aabb { min: [f64::NAN; 3], max: [0.0; 3] }, Aabb { min: [0.0; 3], max: [f64::INFINITY; 3] }]
    {
        assert_eq!(step(&mut movers, 5.0, &seen, nonsense), (vec![id], vec![BrokenPromise::NoBox]));
    }
    assert_eq!(movers.broken()[0].to_string(), "mover 0/0 had no finite box at 5");
    assert_eq!(movers.counters().broken, 4);
    assert_eq!(movers.last_known(id), Some((at(2.5), 4.0)));
}

#[test]
fn nonsense_is_refused() {
    let grid = row(8);
    let mut movers = Movers::new(grid.cells(), MoverOptions::default());
    assert_eq!(movers.add(Aabb::EMPTY, Motion::ANY, 0.0), Err(MoverError::Box));
    assert!(matches!(movers.add(at(1.0), Motion::ANY, f64::NAN), Err(MoverError::Time { .. })));
    let id = movers.add(at(1.0), Motion::ANY, 3.0).unwrap();
    let mut seen = VisibleSet::new();
    see(&mut seen, 8, [1]);
    let early = movers.frame(2.0, &frame(&seen, AnswerKind::Full), &mut |_| unreachable!()).unwrap_err();
    assert_eq!(early.to_string(), "the time 2 is not finite, or before 3");
    assert_eq!(
        movers.moved(id, Aabb::EMPTY, 3.0).unwrap_err().to_string(),
        "the box of a mover is empty or not finite"
    );
    assert!(movers.remove(id) && !movers.remove(id));
    assert_eq!(movers.moved(id, at(2.0), 3.0), Ok(false));
    assert!(!movers.promise(id, Motion::ANY));
    let next = movers.add(at(1.0), Motion::ANY, 3.0).unwrap();
    assert_eq!((next.slot(), next == id, movers.len()), (0, false, 1));
    assert_eq!(movers.last_known(id), None);
}

#[test]
fn what_reaches_beyond_all_cells_is_seen() {
    let grid = row(8);
    let mut movers = Movers::new(grid.cells(), MoverOptions::default());
    let id = movers.add(at(7.9), Motion::speed(0.0).unwrap(), 0.0).unwrap();
    let mut seen = VisibleSet::new();
    see(&mut seen, 8, [0]);
    let view = frame(&seen, AnswerKind::Full);
    assert_eq!(movers.frame(0.0, &view, &mut |_| at(7.9)).unwrap(), [id]);
    assert!(movers.sees(&view, &at(7.9)) && !movers.sees(&view, &at(7.5)) && movers.sees(&view, &at(0.5)));
    // With a larger solid region it is not.
    let solid_within = Some(Aabb { min: [-9.0; 3], max: [99.0; 3] });
    let mut movers = Movers::new(grid.cells(), MoverOptions { solid_within, ..MoverOptions::default() });
    movers.add(at(7.9), Motion::speed(0.0).unwrap(), 0.0).unwrap();
    assert_eq!(movers.frame(0.0, &view, &mut |_| at(7.9)).unwrap(), []);
}
