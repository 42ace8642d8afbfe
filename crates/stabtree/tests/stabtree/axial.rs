//! Pairs of boxes in space against the search that follows every sequence of portals, which shares only
//! the linear programs with them.

use crate::boxes::{SIDE, cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, BoxCell, CellGraph, CellId, Portal};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_kdtree::AxialFace;
use sightlines_pvs::BitMatrix;
use sightlines_sightline::AxialStabber;
use sightlines_stabtree::{AxialVisibility, Network, SearchOptions, Zones, axial_visibility, visible_zones};
use std::cell::Cell;

fn by_pairs(graph: &CellGraph<Axial>, solid: &[Aabb<3>], objects: &[Aabb<3>], threads: usize) -> AxialVisibility {
    let options = SearchOptions { threads, ..SearchOptions::default() };
    axial_visibility(graph, solid, &[], objects, &options).expect("nobody cancels")
}

fn by_sequences(graph: &CellGraph<Axial>, objects: &[Aabb<3>]) -> (BitMatrix, BitMatrix) {
    let network = Network::axial(graph, &Zones::cells(graph), objects);
    let options = SearchOptions { threads: 1, ..SearchOptions::default() };
    let seen = visible_zones(&network, &AxialStabber::new(), &BitMatrix::identity(graph.n_cells()), &options)
        .expect("nobody cancels");
    (seen.zones, seen.objects)
}

/// Invariant: pairs of boxes and sequences of portals give the same answer, for cells and for objects; solid boxes and
/// the number of threads change nothing.
#[test]
fn pairs_and_sequences_agree() {
    let (seen, hidden) = (Cell::new(0u64), Cell::new(0u64));
    let out = || prop::collection::vec(prop::bool::weighted(0.2), 1..9);
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let strategy = (faces(24), out(), objects());
    let result = runner.run(&strategy, |(faces, out, objects)| {
        let (graph, solid) = cut(&faces, &out);
        if graph.n_cells() == 0 {
            return Ok(());
        }
        let (cells, things) = by_sequences(&graph, &objects);
        let pairs = by_pairs(&graph, &solid, &objects, 1);
        prop_assert_eq!(&pairs.cells, &cells);
        prop_assert_eq!(&pairs.objects, &things);
        prop_assert_eq!(pairs.n_assumed, 0);
        let without = by_pairs(&graph, &[], &objects, 2);
        prop_assert_eq!(&without.cells, &cells);
        prop_assert_eq!(&without.objects, &things);
        let ones = cells.count_ones() + things.count_ones();
        let all = (graph.n_cells() * (graph.n_cells() + objects.len())) as u64;
        seen.set(seen.get() + ones);
        hidden.set(hidden.get() + all - ones);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("pairs_and_sequences_agree: {e}"));
    assert!(seen.get() > cases && hidden.get() > cases, "{} seen, {} hidden", seen.get(), hidden.get());
}

/// Every box and portal elsewhere.
fn placed(graph: &CellGraph<Axial>, place: impl Fn(f64) -> f64) -> CellGraph<Axial> {
    let moved = |b: &Aabb<3>| Aabb { min: b.min.map(&place), max: b.max.map(&place) };
    let cells = graph.cells().iter().map(|cell| BoxCell { bounds: moved(&cell.bounds) }).collect();
    let portals = graph.portals().iter();
    let door = |door: &AxialDoor| AxialDoor { extent: moved(&door.extent), ..*door };
    CellGraph::new(cells, portals.map(|p| Portal { shape: door(&p.shape), ..p.clone() }).collect())
}

/// Invariant: both give the same answer where rounding has moved corners that were in line, and left slits of about a unit in
/// the last place between them, or closed them; next to no pair is left to an assumption.
#[test]
fn pairs_and_sequences_agree_on_slits_of_a_unit() {
    let (seen, assumed, changed) = (Cell::new(0u64), Cell::new(0u64), Cell::new(0u64));
    let config = ProptestConfig::with_source_file(file!());
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let scale = prop::sample::select(vec![0.1, 0.3, 0.7]);
    let by = prop::sample::select(vec![0.0, 0.1, 1e3]);
    let result = runner.run(&(faces(24), objects(), scale, by), |(faces, objects, scale, by)| {
        let (graph, _) = cut(&faces, &[false]);
        if graph.n_cells() == 0 {
            return Ok(());
        }
        let place = |x: f64| x * scale + by;
        let moved = placed(&graph, place);
        let things: Vec<_> = objects.iter().map(|b| Aabb { min: b.min.map(place), max: b.max.map(place) }).collect();
        let (cells, objects) = by_sequences(&moved, &things);
        let pairs = by_pairs(&moved, &[], &things, 1);
        if pairs.n_assumed == 0 {
            prop_assert_eq!(&pairs.cells, &cells);
            prop_assert_eq!(&pairs.objects, &objects);
        }
        for row in 0..moved.n_cells() {
            prop_assert!(cells.iter_ones(row).all(|col| pairs.cells.get(row, col)), "cells from {}", row);
            prop_assert!(objects.iter_ones(row).all(|col| pairs.objects.get(row, col)), "objects from {}", row);
        }
        assumed.set(assumed.get() + pairs.n_assumed);
        seen.set(seen.get() + cells.count_ones());
        changed.set(changed.get() + u64::from(by_pairs(&graph, &[], &[], 1).cells != cells));
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("pairs_and_sequences_agree_on_slits_of_a_unit: {e}"));
    eprintln!("{} seen, {} assumed, {} changed by rounding", seen.get(), assumed.get(), changed.get());
    assert!(seen.get() > 100 && 100 * assumed.get() <= seen.get(), "{} seen, {} assumed", seen.get(), assumed.get());
}

/// Invariant: where coordinates that were meant to be equal differ slightly, nothing that sequences prove visible is
/// hidden; more may be visible.
#[test]
fn nothing_is_hidden_by_slivers() {
    let (seen, slivers) = (Cell::new(0u64), Cell::new(0u64));
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let nudges = || prop::collection::vec(-1i8..=1, 1..13);
    let strategy = (faces(6), objects(), nudges(), nudges());
    let result = runner.run(&strategy, |(mut faces, mut objects, nudges, more)| {
        let thin = 2f64.powi(-40);
        let mut nudges = nudges.into_iter().cycle();
        // Each face comes twice, once moved slightly.
        faces.extend(faces.clone());
        let n_faces = faces.len();
        for face in &mut faces[n_faces / 2..] {
            let by = f64::from(nudges.next().unwrap_or(0)) * thin;
            // Inside the cube, whichever way.
            let moved = |x: f64| if x > 0.0 && x < f64::from(SIDE) { x + by } else { x };
            *face = AxialFace::new(face.axis, face.min.map(moved), face.max.map(moved));
        }
        let mut more = more.into_iter().cycle();
        for object in &mut objects {
            let by = f64::from(more.next().unwrap_or(0)) * thin;
            *object = Aabb { min: object.min.map(|x| x + by), max: object.max.map(|x| x + by) };
        }
        let (graph, _) = cut(&faces, &[false]);
        if graph.n_cells() > 60 {
            return Ok(());
        }
        let (cells, things) = by_sequences(&graph, &objects);
        let pairs = by_pairs(&graph, &[], &objects, 1);
        let is_thin = |b: &Aabb<3>| (0..3).any(|k| b.max[k] - b.min[k] < 4.0 * thin);
        for row in 0..graph.n_cells() {
            prop_assert!(cells.iter_ones(row).all(|col| pairs.cells.get(row, col)), "cells from {}", row);
            prop_assert!(things.iter_ones(row).all(|col| pairs.objects.get(row, col)), "objects from {}", row);
            slivers.set(slivers.get() + u64::from(is_thin(&graph.cells()[row].bounds)));
        }
        seen.set(seen.get() + things.count_ones());
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("nothing_is_hidden_by_slivers: {e}"));
    assert!(seen.get() > cases && slivers.get() > cases / 4, "{} seen, {} slivers", seen.get(), slivers.get());
}

/// A comparison that has to fail: the same graph with one portal closed sees less.
#[test]
fn a_closed_portal_is_noticed() {
    let wall = AxialFace::new(0, [2.0, 0.0, 0.0], [2.0, 2.0, 4.0]);
    let (graph, _) = cut(&[wall], &[false]);
    assert_eq!((graph.n_cells(), graph.portals().len()), (2, 1));
    let open = by_pairs(&graph, &[], &[], 1);
    let closed = CellGraph::<Axial>::new(graph.cells().to_vec(), Vec::new());
    let closed = by_pairs(&closed, &[], &[], 1);
    assert!(open.cells.get(0, 1) && !closed.cells.get(0, 1));
}

/// Boxes in a row along one axis, with the whole of each border open.
fn row_of_boxes(ends: &[f64]) -> CellGraph<Axial> {
    let cell = |w: &[f64]| BoxCell { bounds: Aabb { min: [w[0], 0.0, 0.0], max: [w[1], 1.0, 1.0] } };
    let portal = |(i, x): (u32, &f64)| {
        let extent = Aabb { min: [*x, 0.0, 0.0], max: [*x, 1.0, 1.0] };
        let shape = AxialDoor { extent, axis: 0, forward: true };
        Portal { cells: [CellId(i), CellId(i + 1)], sides: [1, 0], shape }
    };
    let portals = (0u32..).zip(&ends[1..ends.len() - 1]).map(portal).collect();
    CellGraph::<Axial>::new(ends.windows(2).map(cell).collect(), portals)
}

/// An object that touches only slivers is seen from the cells in front of them, and from slivers beside them.
#[test]
fn objects_behind_slivers_are_seen() {
    let thin = 2f64.powi(-40);
    for n_slivers in 1..5u32 {
        let ends: Vec<f64> = [0.0].into_iter().chain((0..=n_slivers).map(|i| 1.0 + f64::from(i) * thin)).collect();
        let graph = row_of_boxes(&ends);
        let end = ends[ends.len() - 1];
        let object = Aabb { min: [end, 0.25, 0.25], max: [end + 1.0, 0.75, 0.75] };
        for objects in [vec![object], vec![object, object]] {
            let seen = by_pairs(&graph, &[], &objects, 1);
            let (_, exact) = by_sequences(&graph, &objects);
            for cell in 0..graph.n_cells() {
                assert!((0..objects.len()).all(|o| exact.get(cell, o)), "{n_slivers} {cell}");
                assert!((0..objects.len()).all(|o| seen.objects.get(cell, o)), "{n_slivers} {cell}");
            }
        }
    }
    // Nothing but slivers.
    let graph = row_of_boxes(&[0.0, thin, 2.0 * thin, 3.0 * thin]);
    let object = Aabb { min: [3.0 * thin, 0.25, 0.25], max: [1.0, 0.75, 0.75] };
    let seen = by_pairs(&graph, &[], &[object], 1);
    assert!((0..3).all(|cell| seen.objects.get(cell, 0) && (0..3).all(|other| seen.cells.get(cell, other))));
}

/// Cells too thin for doubles inherit their neighbours' visibility.
#[test]
fn slivers_take_after_their_neighbours() {
    let ulp = f64::EPSILON;
    let wall = |x: f64| AxialFace::new(0, [x, 0.0, 0.0], [x, 1.0, 4.0]);
    let (graph, _) = cut(&[wall(1.0), wall(1.0 + ulp), wall(3.0)], &[false]);
    let thin = (0..graph.n_cells()).find(|&c| {
        let b = &graph.cells()[c].bounds;
        b.max[0] - b.min[0] == ulp
    });
    let thin = thin.expect("the sliver is a cell");
    let seen = by_pairs(&graph, &[], &[], 1);
    let (exact, _) = by_sequences(&graph, &[]);
    assert!((0..graph.n_cells()).all(|c| seen.cells.get(thin, c) && seen.cells.get(c, thin)));
    for row in 0..graph.n_cells() {
        assert!(exact.iter_ones(row).all(|col| seen.cells.get(row, col)), "{row}");
    }
}
