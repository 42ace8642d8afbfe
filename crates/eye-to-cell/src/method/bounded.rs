//! Answers within a budget: all of the exact answer, nothing beyond that of the incident portals, and named rightly.

use super::agreement::{block, plan};
use super::exact::by_sequences;
use super::missing::list_missing;
use super::query::Query;
use crate::{Doors, Method, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph};
use proptest::prelude::*;
use sightlines_pvs::{CellId, Table};
use std::f64::consts::TAU;

/// A view from each cell that the eye is in.
fn subgraphs(table: &Table, view: &View) -> Vec<VisibleSubgraph> {
    let roots = table.place_at(view.eye()).cells().to_vec();
    let prepare = |root| VisibleSubgraph::prepare(&TableCells::new(table), root).unwrap_or_else(|never| match never {});
    roots.into_iter().map(prepare).collect()
}

fn look(method: Method, budget: StepBudget, subgraph: &VisibleSubgraph, view: &View) -> (Method, Vec<CellId>) {
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    seen.clear(1 << 10, 0);
    scratch.allow(budget);
    let by = method.look(subgraph, view, &Doors::all_open(), &mut scratch, &mut seen);
    seen.sort();
    (by, seen.cells().to_vec())
}

/// What is wrong with an answer: cells of the exact one that are missing, and cells that the coarser one has not.
fn faults(answer: &[CellId], exact: &[CellId], coarser: &[CellId]) -> usize {
    let dropped = exact.iter().filter(|cell| !answer.contains(cell)).count();
    dropped + answer.iter().filter(|cell| !coarser.contains(cell)).count()
}

/// Checks the answers of an eye within a budget; how many were exact, how many those of the incident portals, and how many between.
fn check(table: &Table, view: &View, budget: StepBudget) -> Result<[usize; 3], TestCaseError> {
    let mut counts = [0; 3];
    for subgraph in subgraphs(table, view) {
        let (by, answer) = look(Method::Exact, budget, &subgraph, view);
        let (best, exact) = look(Method::Exact, StepBudget::UNLIMITED, &subgraph, view);
        let (_, coarser) = look(Method::IncidentPortals, budget, &subgraph, view);
        prop_assert_eq!(best, Method::Exact);
        prop_assert_eq!(faults(&answer, &exact, &coarser), 0);
        if by == Method::Exact {
            prop_assert_eq!(&answer, &exact);
        } else if budget == StepBudget::steps(0) {
            prop_assert_eq!(&answer, &coarser);
        }
        counts[match (by, answer.len() < coarser.len()) {
            (Method::Exact, _) => 0,
            (_, false) => 1,
            (_, true) => 2,
        }] += 1;
        prop_assert_eq!((by, answer), look(Method::Exact, budget, &subgraph, view));
    }
    Ok(counts)
}

proptest! {
    /// Invariant: whatever the budget, between the exact answer and the coarser one, and the one that it is said to be.
    #[test]
    fn answers_lie_between(
        doors in prop::collection::vec(prop::array::uniform4(0u8..9), 1..30),
        eye in prop::array::uniform3(0.03f64..3.97),
        dir in prop::array::uniform3(-1.0f64..1.0),
        fov in 0.1f64..TAU,
        steps in 0u64..20_000,
    ) {
        prop_assume!(dir.iter().any(|x| x.abs() > 0.01));
        let view = View::perspective_horizontal(eye, dir, [0.0, 0.0, 1.0], fov, 1.25).unwrap();
        let n: usize = check(&block(&doors), &view, StepBudget::steps(steps))?.iter().sum();
        prop_assert!(n > 0);
    }

    /// The same in the plane.
    #[test]
    fn answers_lie_between_in_the_plane(
        doors in prop::collection::vec(prop::array::uniform4(0u8..9), 1..30),
        eye in prop::array::uniform2(0.03f64..5.97),
        turn in 0.0f64..TAU,
        fov in 0.01f64..TAU,
        steps in 0u64..4000,
    ) {
        let view = View::planar(eye, [turn.cos(), turn.sin()], fov).unwrap();
        let n: usize = check(&plan(&doors, 6), &view, StepBudget::steps(steps))?.iter().sum();
        prop_assert!(n > 0);
    }
}

/// Views all round a house of rooms with doors.
fn views() -> (Table, Vec<View>) {
    let table = plan(&[[2, 6, 1, 5], [3, 5, 0, 0], [1, 3, 4, 7], [4, 8, 2, 2]], 8);
    let view = |k: u32| {
        let (sin, cos) = (f64::from(k) * 0.7).sin_cos();
        let eye = [0.31 + f64::from(k % 8), 0.43 + f64::from(k / 8 % 8)];
        View::planar(eye, [cos, sin], 1.3).unwrap()
    };
    (table, (0..128).map(view).collect())
}

/// Most answers of a frame's budget are exact, none without work, and a larger budget never has fewer.
#[test]
fn most_answers_are_exact() {
    let (table, views) = views();
    let (mut last, mut n_between) = (0, 0);
    for steps in [0, 64, 256, 384, 512, 768, 1024, StepBudget::FRAME.n_steps(), u64::MAX] {
        let mut n_exact = 0;
        for view in &views {
            let counts = check(&table, view, StepBudget::steps(steps)).unwrap();
            n_exact += counts[0];
            n_between += counts[2];
        }
        assert!(n_exact >= last, "{steps}: {n_exact}");
        assert!(steps > 0 || n_exact == 0);
        assert!(steps < StepBudget::FRAME.n_steps() || n_exact * 10 > views.len() * 9, "{steps}: {n_exact}");
        last = n_exact;
    }
    // Who has done some of the work has some of the gain.
    assert!(last == 128 && n_between > 30, "{last} {n_between}");
}

/// Impostors: who stops without falling back, or drops one cell of the coarser answer that is seen.
#[test]
fn whoever_drops_something_is_noticed() {
    let (table, views) = views();
    let (mut n_stopped, mut n_dropped) = (0, 0);
    for view in &views {
        let subgraph = &subgraphs(&table, view)[0];
        let (_, exact) = look(Method::Exact, StepBudget::UNLIMITED, subgraph, view);
        let (by, mut coarser) = look(Method::Exact, StepBudget::steps(0), subgraph, view);
        assert_eq!((by, faults(&coarser, &exact, &coarser)), (Method::IncidentPortals, 0));
        let (mut scratch, mut seen, doors) = (Scratch::new(), VisibleSet::new(), Doors::all_open());
        seen.clear(1 << 10, 0);
        let mut query = Query::new(subgraph, view, &view.parts()[0], &doors, &mut scratch, &mut seen);
        list_missing(&mut query);
        if !by_sequences(&mut query, 2) && seen.cells().len() < exact.len() {
            assert!(faults(seen.cells(), &exact, &coarser) > 0);
            n_stopped += 1;
        }
        let full = coarser.clone();
        coarser.retain(|cell| Some(cell) != exact.last());
        assert!(faults(&coarser, &exact, &full) > 0);
        n_dropped += 1;
    }
    assert!(n_stopped > 30 && n_dropped == 128, "{n_stopped} {n_dropped}");
}

/// What is left is for all queries together.
#[test]
fn queries_share_what_is_left() {
    let (table, views) = views();
    let subgraph = &subgraphs(&table, &views[9])[0];
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    scratch.allow(StepBudget::steps(2000));
    let mut left = vec![scratch.left()];
    let mut by = Method::Exact;
    while by == Method::Exact {
        seen.clear(1 << 10, 0);
        by = Method::Exact.look(subgraph, &views[9], &Doors::all_open(), &mut scratch, &mut seen);
        left.push(scratch.left());
        assert!(left.len() < 2000);
    }
    assert!(left.len() > 3 && left.is_sorted_by(|a, b| a > b) && scratch.left() == StepBudget::steps(0));
}
