//! Searches with a budget: whenever it is spent, everything that is visible without one stays visible, and the rest is listed.

use crate::boxes::{cut, faces, objects};
use proptest::prelude::*;
use sightlines_geometry::Aabb;
use sightlines_kdtree::AxialFace;
use sightlines_progress::{Allowance, Budget};
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{PairMask, SearchOptions, axial_visibility, box_visibility};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Spends one part of `n` each time that it is asked.
fn calls(n: u64) -> impl Fn() -> f64 + Sync {
    let asked = AtomicU64::new(0);
    move || asked.fetch_add(1, Relaxed) as f64 / n as f64
}

fn options(threads: usize, budget: Option<&dyn Budget>) -> SearchOptions<'_> {
    SearchOptions { threads, budget: Allowance::all(budget), ..SearchOptions::default() }
}

/// What is visible, and what of it was not decided.
struct Found {
    visible: PairMask,
    left: Option<PairMask>,
}

/// Pairs of a matrix that another has not.
fn beyond(a: &BitMatrix, b: &BitMatrix) -> u64 {
    (0..a.n_rows()).map(|row| a.iter_ones(row).filter(|&col| !b.get(row, col)).count() as u64).sum()
}

/// Pairs that are visible without a limit and hidden with one, and pairs that are visible only with one and not listed as left.
fn faults(full: &Found, limited: &Found) -> [u64; 2] {
    let (a, b) = (&full.visible, &limited.visible);
    let hidden = beyond(&a.boxes, &b.boxes) + beyond(&a.objects, &b.objects);
    let mut known = a.clone();
    if let Some(left) = &limited.left {
        for (known, left) in [(&mut known.boxes, &left.boxes), (&mut known.objects, &left.objects)] {
            (0..left.n_rows()).for_each(|row| left.iter_ones(row).for_each(|col| known.set(row, col, true)));
        }
    }
    [hidden, beyond(&b.boxes, &known.boxes) + beyond(&b.objects, &known.objects)]
}

/// The answer without what was left: what a search would return that calls hidden what it has not decided.
fn impostor(limited: &Found) -> Found {
    let mut visible = limited.visible.clone();
    if let Some(left) = &limited.left {
        for (own, left) in [(&mut visible.boxes, &left.boxes), (&mut visible.objects, &left.objects)] {
            (0..left.n_rows()).for_each(|row| left.iter_ones(row).for_each(|col| own.set(row, col, false)));
        }
    }
    Found { visible, left: None }
}

/// Runs a search without a limit and with limits of all sizes; `run` is given what may be spent.
fn compare(name: &str, run: impl Fn(&[AxialFace<3>], &[bool], &[Aabb<3>], Option<&dyn Budget>) -> Option<Found>) {
    let [n_left, n_looser, n_caught, n_whole] = [(); 4].map(|()| Cell::new(0u64));
    let add = |cell: &Cell<u64>, n: u64| cell.set(cell.get() + n);
    let config = ProptestConfig::with_source_file(file!());
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let out = || prop::collection::vec(prop::bool::weighted(0.2), 1..9);
    let strategy = (faces(24), out(), objects(), 1u64..400);
    let result = runner.run(&strategy, |(faces, out, objects, n)| {
        let Some(full) = run(&faces, &out, &objects, None) else { return Ok(()) };
        prop_assert!(full.left.is_none());
        for n in [0, n] {
            let limited = run(&faces, &out, &objects, Some(&calls(n))).expect("the same scene");
            prop_assert_eq!(faults(&full, &limited), [0; 2], "after {} questions", n);
            add(&n_left, limited.left.iter().map(|left| left.boxes.count_ones() + left.objects.count_ones()).sum());
            add(&n_looser, beyond(&limited.visible.boxes, &full.visible.boxes));
            add(&n_caught, faults(&full, &impostor(&limited))[0]);
        }
        let whole = run(&faces, &out, &objects, Some(&calls(1 << 40))).expect("the same scene");
        prop_assert!(whole.left.is_none() && whole.visible == full.visible);
        add(&n_whole, 1);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{name}: {e}"));
    let counts = [n_left, n_looser, n_caught, n_whole].map(|n| n.get());
    assert!(counts.iter().all(|&n| n > 10), "{name}: left, looser, caught, whole: {counts:?}");
}

/// What cells see.
fn cells(faces: &[AxialFace<3>], out: &[bool], objects: &[Aabb<3>], budget: Option<&dyn Budget>) -> Option<Found> {
    let (graph, solid) = cut(faces, out);
    let seen = axial_visibility(&graph, &solid, &[], objects, &options(1, budget)).expect("nobody cancels");
    (graph.n_cells() > 0)
        .then_some(Found { visible: PairMask { boxes: seen.cells, objects: seen.objects }, left: seen.left })
}

#[test]
fn cells_that_are_not_decided_are_visible() {
    compare("cells", cells);
}

/// Who sees a cell sees the objects around it. Who only may see it, because that was not decided, may see them.
#[test]
fn objects_around_cells_that_are_not_decided_are_listed() {
    let faces = [
        AxialFace::new(1, [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]),
        AxialFace::new(0, [2.0, 0.0, 0.0], [2.0, 1.0, 4.0]),
        AxialFace::new(2, [0.0, 1.0, 3.0], [3.0, 2.0, 3.0]),
        AxialFace::new(0, [1.0, 0.0, 0.0], [1.0, 2.0, 1.0]),
        AxialFace::new(0, [2.0, 0.0, 1.0], [2.0, 4.0, 4.0]),
    ];
    let object = [Aabb { min: [0.0; 3], max: [1.0, 4.0, 4.0] }];
    let find = |budget: Option<&dyn Budget>| cells(&faces, &[false], &object, budget).expect("there are cells");
    let (full, limited) = (find(None), find(Some(&calls(0))));
    assert_eq!(faults(&full, &limited), [0; 2]);
    let left = limited.left.as_ref().expect("nothing is decided");
    assert!(left.boxes.count_ones() > 0 && left.objects.count_ones() > 0);
    assert!(faults(&full, &impostor(&limited))[0] > 0);
}

#[test]
fn boxes_that_are_not_decided_are_visible() {
    compare("boxes", |faces, out, objects, budget| {
        let (graph, solid) = cut(faces, out);
        let eyes: Vec<Aabb<3>> = graph.cells().iter().map(|cell| cell.bounds).collect();
        let ones = |n_cols: usize| {
            let mut all = BitMatrix::new(eyes.len(), n_cols);
            (0..eyes.len()).for_each(|row| (0..n_cols).for_each(|col| all.set(row, col, true)));
            all
        };
        let asked = PairMask { boxes: ones(eyes.len()), objects: ones(objects.len()) };
        let seen =
            box_visibility(&graph, &solid, &[], &eyes, objects, &asked, &options(1, budget)).expect("nobody cancels");
        (!eyes.is_empty())
            .then_some(Found { visible: PairMask { boxes: seen.boxes, objects: seen.objects }, left: seen.left })
    });
}
