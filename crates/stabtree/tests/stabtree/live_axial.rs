//! Updated answers against answers computed anew, after random edits.

use crate::boxes::{cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::Aabb;
use sightlines_kdtree::AxialFace;
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{AxialVisibility, LiveAxial, SearchOptions, axial_visibility};
use std::cell::Cell;

/// The scene at one time.
#[derive(Debug, Clone)]
struct State {
    graph: CellGraph<Axial>,
    solid: Vec<Aabb<3>>,
    objects: Vec<Aabb<3>>,
}

/// One edit of a scene.
#[derive(Debug, Clone)]
enum Edit {
    /// Faces that are added.
    Build(Vec<AxialFace<3>>),
    /// Faces that are removed, by number.
    TearDown(Vec<prop::sample::Index>),
    /// A face and where to move it along its axis, in steps.
    Move(prop::sample::Index, f64),
    /// Portals that are closed until the next step.
    Close(Vec<prop::sample::Index>),
    /// Which cells are left out.
    LeaveOut(Vec<bool>),
    /// Objects that replace all earlier ones.
    Furnish(Vec<Aabb<3>>),
    /// An object that is removed, and one that is added.
    Carry(prop::sample::Index, Vec<Aabb<3>>),
    /// Back to the step before.
    Undo,
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let index = || any::<prop::sample::Index>();
    let some = move || prop::collection::vec(index(), 1..4);
    let edit = prop_oneof![
        faces(3).prop_map(Edit::Build),
        some().prop_map(Edit::TearDown),
        (index(), -1..=1i8).prop_map(|(face, by)| Edit::Move(face, f64::from(by))),
        some().prop_map(Edit::Close),
        prop::collection::vec(prop::bool::weighted(0.2), 1..9).prop_map(Edit::LeaveOut),
        objects().prop_map(Edit::Furnish),
        (index(), objects()).prop_map(|(gone, new)| Edit::Carry(gone, new)),
        Just(Edit::Undo),
    ];
    prop::collection::vec(edit, 1..5)
}

/// The scene after each edit.
fn states(faces: &[AxialFace<3>], objects: &[Aabb<3>], edits: &[Edit]) -> Vec<State> {
    let mut sources = vec![(faces.to_vec(), vec![false], objects.to_vec())];
    let mut states = Vec::new();
    let state = |(faces, out, objects): &(Vec<AxialFace<3>>, Vec<bool>, Vec<Aabb<3>>),
                 closed: &[prop::sample::Index]| {
        let (mut graph, solid) = cut(faces, out);
        let n = graph.portals().len();
        if n > 0 && !closed.is_empty() {
            let mut portals = graph.portals().to_vec();
            let closed: Vec<usize> = closed.iter().map(|i| i.index(n)).collect();
            let mut number = 0..n;
            portals.retain(|_| number.next().is_some_and(|i| !closed.contains(&i)));
            graph = CellGraph::new(graph.cells().to_vec(), portals);
        }
        State { graph, solid, objects: objects.clone() }
    };
    states.push(state(&sources[0], &[]));
    for edit in edits {
        let mut next = sources[sources.len() - 1].clone();
        let mut closed: &[prop::sample::Index] = &[];
        match edit {
            Edit::Build(more) => next.0.extend(more.iter().copied()),
            Edit::TearDown(gone) => gone.iter().for_each(|i| {
                if !next.0.is_empty() {
                    next.0.remove(i.index(next.0.len()));
                }
            }),
            Edit::Move(face, by) => {
                if !next.0.is_empty() {
                    let i = face.index(next.0.len());
                    let AxialFace { axis, mut min, mut max, .. } = next.0[i];
                    (min[axis], max[axis]) = (min[axis] + by, max[axis] + by);
                    next.0[i] = AxialFace::new(axis, min, max);
                }
            }
            Edit::Close(portals) => closed = portals,
            Edit::LeaveOut(out) => next.1.clone_from(out),
            Edit::Furnish(objects) => next.2.clone_from(objects),
            Edit::Carry(gone, new) => {
                if !next.2.is_empty() {
                    next.2.remove(gone.index(next.2.len()));
                }
                next.2.extend(new.first());
            }
            Edit::Undo => next = sources[sources.len().saturating_sub(2)].clone(),
        }
        states.push(state(&next, closed));
        sources.push(next);
    }
    states
}

fn options(threads: usize) -> SearchOptions<'static> {
    SearchOptions { threads, ..SearchOptions::default() }
}

fn anew(state: &State) -> AxialVisibility {
    axial_visibility(&state.graph, &state.solid, &[], &state.objects, &options(1)).expect("nobody cancels")
}

fn same(a: &AxialVisibility, b: &AxialVisibility) -> bool {
    a.cells == b.cells && a.objects == b.objects && a.touching == b.touching && a.n_blockers == b.n_blockers
}

/// Invariant: after any edits, one after the other, the answer equals the one computed anew, bit for bit, with any
/// number of threads.
#[test]
fn updates_equal_answers_found_anew() {
    let [changed, kept, rebuilt] = [(); 3].map(|()| Cell::new(0u64));
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let strategy = (faces(20), objects(), edits(), 1..3usize);
    let result = runner.run(&strategy, |(faces, objects, edits, threads)| {
        let states = states(&faces, &objects, &edits);
        let first = states[0].clone();
        let mut live =
            LiveAxial::new(first.graph, &first.solid, first.objects, &options(threads)).expect("nobody cancels");
        prop_assert!(same(live.seen(), &anew(&states[0])), "before any edit");
        for (step, state) in states.iter().enumerate().skip(1) {
            let before = live.seen().clone();
            let State { graph, solid, objects } = state.clone();
            let update = live.update(graph, &solid, objects, &options(threads));
            let expected = anew(state);
            prop_assert_eq!(expected.n_assumed, 0);
            prop_assert_eq!(&live.seen().cells, &expected.cells, "step {}", step);
            prop_assert_eq!(&live.seen().objects, &expected.objects, "step {}", step);
            prop_assert!(same(live.seen(), &expected), "step {}", step);
            changed
                .set(changed.get() + u64::from(before.cells != expected.cells || before.objects != expected.objects));
            rebuilt.set(rebuilt.get() + u64::from(update.rebuilt));
            kept.set(kept.get() + u64::from(!update.rebuilt && update.n_lines > update.n_lines_cut));
        }
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("updates_equal_answers_found_anew: {e}"));
    let [changed, kept, rebuilt] = [changed, kept, rebuilt].map(Cell::into_inner);
    eprintln!("{changed} answers changed, {kept} with lines that were kept, {rebuilt} found anew");
    assert!(changed > cases && kept > cases / 2, "{changed} changed, {kept} with lines kept, of {cases} cases");
}

/// Three rooms in a row along x with doors at the given heights, and a mat in the last room.
fn rooms(doors: [Option<f64>; 2]) -> State {
    let mut faces = Vec::new();
    for (x, door) in [1.0, 3.0].into_iter().zip(doors) {
        let mut wall = |min: [f64; 2], max: [f64; 2]| {
            faces.push(AxialFace::new(0, [x, min[0], min[1]], [x, max[0], max[1]]));
        };
        match door {
            None => wall([0.0; 2], [4.0; 2]),
            Some(low) => {
                wall([0.0, 0.0], [1.0, 4.0]);
                wall([2.0, 0.0], [4.0, 4.0]);
                wall([1.0, 0.0], [2.0, low]);
                wall([1.0, low + 1.0], [2.0, 4.0]);
            }
        }
    }
    let (graph, solid) = cut(&faces, &[false]);
    State { graph, solid, objects: vec![Aabb { min: [3.5, 1.0, 0.0], max: [4.0, 2.0, 0.0] }] }
}

/// Comparisons that have to fail: updates that ignore cut lines, or opened walls, are detected. Both give the answer
/// for the old rooms as that for the new.
#[test]
fn what_an_update_forgets_is_noticed() {
    let [shut, open] = [rooms([Some(0.0), None]), rooms([Some(0.0), Some(0.0)])];
    for (before, after) in [(&open, &shut), (&shut, &open)] {
        let mut live = LiveAxial::new(before.graph.clone(), &before.solid, before.objects.clone(), &options(1))
            .expect("nobody cancels");
        let forgetful = transferred(before, live.seen(), after);
        let update = live.update(after.graph.clone(), &after.solid, after.objects.clone(), &options(1));
        let expected = anew(after);
        assert!(same(live.seen(), &expected), "{update:?}");
        assert!(forgetful != expected.cells, "{update:?}");
        assert!(update.n_closed > 0 || update.n_opened > 0);
    }
}

/// What cells with the same bounds saw before; all others are taken from the new answer.
fn transferred(before: &State, seen: &AxialVisibility, after: &State) -> BitMatrix {
    let mut cells = anew(after).cells;
    let old = |cell: usize| {
        let bounds = after.graph.cells()[cell].bounds;
        before.graph.cells().iter().position(|c| c.bounds == bounds)
    };
    for a in 0..after.graph.n_cells() {
        for b in 0..after.graph.n_cells() {
            if let (Some(x), Some(y)) = (old(a), old(b)) {
                cells.set(a, b, seen.cells.get(x, y));
            }
        }
    }
    cells
}

/// One door costs what depends on it: most lines are kept, and few pairs are decided again.
#[test]
fn a_door_leaves_most_as_it_is() {
    let open = rooms([Some(0.0), Some(2.0)]);
    let mut live =
        LiveAxial::new(open.graph.clone(), &open.solid, open.objects.clone(), &options(1)).expect("nobody cancels");
    let asked = live.seen().counters.n_asked;
    let same_again = live.update(open.graph.clone(), &open.solid, open.objects.clone(), &options(1));
    assert_eq!((same_again.n_lines_cut, same_again.counters.n_asked, same_again.n_cells_new), (0, 0, 0));
    let portals = open.graph.portals().iter().filter(|p| p.shape.axis != 0 || p.shape.at() != 3.0).cloned().collect();
    let closed = State { graph: CellGraph::new(open.graph.cells().to_vec(), portals), ..open.clone() };
    let update = live.update(closed.graph.clone(), &closed.solid, closed.objects.clone(), &options(1));
    assert!(same(live.seen(), &anew(&closed)));
    assert!(update.n_lines_cut > 0 && update.n_lines_cut < update.n_lines, "{update:?}");
    assert!(update.counters.n_asked < asked, "{update:?} {asked}");
    assert!(!live.seen().objects.get(0, 0));
    live.update(open.graph.clone(), &open.solid, open.objects.clone(), &options(1));
    assert!(same(live.seen(), &anew(&open)));
}
