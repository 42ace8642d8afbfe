//! Boxes that are not cells against the search that follows every sequence of portals, in a graph whose cells are cut
//! along the boxes: a box sees what the cells in it see.

use crate::boxes::{SIDE, cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, BoxCell, CellGraph, CellId, Portal};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_kdtree::AxialFace;
use sightlines_pvs::BitMatrix;
use sightlines_sightline::AxialStabber;
use sightlines_stabtree::{BoxVisibility, Network, PairMask, SearchOptions, Zones, box_visibility, visible_zones};
use std::cell::Cell;

fn all(n_rows: usize, n_cols: usize) -> BitMatrix {
    let mut all = BitMatrix::new(n_rows, n_cols);
    (0..n_rows).for_each(|row| (0..n_cols).for_each(|col| all.set(row, col, true)));
    all
}

fn seen(graph: &CellGraph<Axial>, solid: &[Aabb<3>], eyes: &[Aabb<3>], things: &[Aabb<3>]) -> BoxVisibility {
    let asked = PairMask { boxes: all(eyes.len(), eyes.len()), objects: all(eyes.len(), things.len()) };
    let [one, three] = [1, 3].map(|threads| {
        let options = SearchOptions { threads, ..SearchOptions::default() };
        box_visibility(graph, solid, &[], eyes, things, &asked, &options).expect("nobody cancels")
    });
    assert_eq!((&one.boxes, &one.objects), (&three.boxes, &three.objects));
    one
}

/// Cuts off what of a piece is beyond each face of a box that it overlaps; what is left is inside of the box.
fn cut_off(piece: Aabb<3>, along: &Aabb<3>) -> Vec<Aabb<3>> {
    if (0..3).any(|k| piece.max[k] <= along.min[k] || along.max[k] <= piece.min[k]) {
        return vec![piece];
    }
    let (mut pieces, mut rest) = (Vec::new(), piece);
    for k in 0..3 {
        if rest.min[k] < along.min[k] {
            let mut below = rest;
            (below.max[k], rest.min[k]) = (along.min[k], along.min[k]);
            pieces.push(below);
        }
        if along.max[k] < rest.max[k] {
            let mut above = rest;
            (above.min[k], rest.max[k]) = (along.max[k], along.max[k]);
            pieces.push(above);
        }
    }
    pieces.push(rest);
    pieces
}

/// The same space and walls, with cells cut along boxes: each piece is inside or outside of each box.
fn cut_along(graph: &CellGraph<Axial>, boxes: &[Aabb<3>]) -> CellGraph<Axial> {
    let mut pieces: Vec<(usize, Aabb<3>)> = Vec::new();
    for (cell, own) in graph.cells().iter().enumerate() {
        let whole = vec![Aabb { min: own.bounds.min, max: own.bounds.max }];
        let cut = |pieces: Vec<Aabb<3>>, b| pieces.into_iter().flat_map(|piece| cut_off(piece, b)).collect();
        pieces.extend(boxes.iter().fold(whole, cut).into_iter().map(|piece| (cell, piece)));
    }
    let mut portals = Vec::new();
    for (i, (cell, own)) in pieces.iter().enumerate() {
        for (j, (other, next)) in pieces.iter().enumerate() {
            for axis in 0..3 {
                if own.max[axis] != next.min[axis] {
                    continue;
                }
                let whole = Aabb { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
                let here = |p: &&Portal<Axial>| {
                    usize::from(p.shape.axis) == axis
                        && p.shape.at() == own.max[axis]
                        && p.cells.contains(&CellId(*cell as u32))
                        && p.cells.contains(&CellId(*other as u32))
                };
                let through: Vec<Aabb<3>> = if cell == other {
                    vec![whole]
                } else {
                    graph.portals().iter().filter(here).map(|p| p.shape.extent).collect()
                };
                for door in through {
                    let mut extent = Aabb { min: own.min, max: own.max };
                    for k in (0..3).filter(|&k| k != axis) {
                        extent.min[k] = own.min[k].max(next.min[k]).max(door.min[k]);
                        extent.max[k] = own.max[k].min(next.max[k]).min(door.max[k]);
                    }
                    (extent.min[axis], extent.max[axis]) = (own.max[axis], own.max[axis]);
                    if (0..3).all(|k| k == axis || extent.min[k] < extent.max[k]) {
                        let shape = AxialDoor { extent, axis: axis as u8, forward: true };
                        let sides = [2 * axis as u32 + 1, 2 * axis as u32];
                        portals.push(Portal { cells: [CellId(i as u32), CellId(j as u32)], sides, shape });
                    }
                }
            }
        }
    }
    let cells = pieces.into_iter().map(|(_, bounds)| BoxCell { bounds }).collect();
    let graph = CellGraph::<Axial>::new(cells, portals);
    graph.assert_well_formed();
    graph
}

fn touch(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// What boxes see of each other and of objects, by the cells in them; touching counts as seeing.
fn by_cells(graph: &CellGraph<Axial>, eyes: &[Aabb<3>], things: &[Aabb<3>]) -> [BitMatrix; 2] {
    let fine = cut_along(graph, eyes);
    let network = Network::axial(&fine, &Zones::cells(&fine), things);
    let options = SearchOptions { threads: 1, ..SearchOptions::default() };
    let found = visible_zones(&network, &AxialStabber::new(), &BitMatrix::identity(fine.n_cells()), &options)
        .expect("nobody cancels");
    let within: Vec<Vec<usize>> = eyes
        .iter()
        .map(|eye| {
            let is_in = |c: &usize| {
                let b = &fine.cells()[*c].bounds;
                eye.contains(b.min) && eye.contains(b.max)
            };
            (0..fine.n_cells()).filter(is_in).collect()
        })
        .collect();
    let (mut boxes, mut objects) = (BitMatrix::new(eyes.len(), eyes.len()), BitMatrix::new(eyes.len(), things.len()));
    for a in 0..eyes.len() {
        for b in 0..eyes.len() {
            let sees = within[a].iter().any(|&c| within[b].iter().any(|&d| found.zones.get(c, d)));
            boxes.set(a, b, sees || touch(&eyes[a], &eyes[b]));
        }
        for (o, thing) in things.iter().enumerate() {
            let sees = within[a].iter().any(|&c| found.objects.get(c, o));
            objects.set(a, o, sees || touch(&eyes[a], thing));
        }
    }
    [boxes, objects]
}

/// Boxes in the cube with corners at halves of the grid, not flat.
fn eyes() -> impl Strategy<Value = Vec<Aabb<3>>> {
    let side = || {
        (0..2 * SIDE, 1..3i32)
            .prop_map(|(from, size): (i32, i32)| [from, (from + size).min(2 * SIDE)].map(|x| f64::from(x) / 2.0))
    };
    let one = prop::array::uniform3(side()).prop_map(|s| Aabb { min: s.map(|s| s[0]), max: s.map(|s| s[1]) });
    prop::collection::vec(one, 1..4)
}

/// Invariant: boxes see exactly what the cells in them see and what they touch; solid boxes reveal nothing hidden.
#[test]
fn boxes_see_what_the_cells_in_them_see() {
    let (shown, hidden, in_solid) = (Cell::new(0u64), Cell::new(0u64), Cell::new(0u64));
    let config = ProptestConfig::with_source_file(file!());
    let cases = u64::from(config.cases);
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let out = || prop::collection::vec(prop::bool::weighted(0.04), 1..9);
    let result = runner.run(&(faces(24), out(), eyes(), objects()), |(faces, out, eyes, objects)| {
        // Objects are in the cube; beyond it nothing is known.
        let is_in = |b: &Aabb<3>| (0..3).all(|k| b.min[k] >= 0.0 && b.max[k] <= f64::from(SIDE));
        let objects: Vec<Aabb<3>> = objects.into_iter().filter(is_in).collect();
        let (graph, solid) = cut(&faces, &out);
        let whole = Aabb::<3>::around(graph.cells().iter().flat_map(|c| [c.bounds.min, c.bounds.max]));
        if whole != (Aabb { min: [0.0; 3], max: [f64::from(SIDE); 3] }) {
            return Ok(());
        }
        let found = seen(&graph, &solid, &eyes, &objects);
        let [boxes, things] = by_cells(&graph, &eyes, &objects);
        prop_assert_eq!(found.n_assumed, 0);
        prop_assert!(found.boxes.is_symmetric());
        for a in 0..eyes.len() {
            prop_assert!(boxes.iter_ones(a).all(|b| found.boxes.get(a, b)), "boxes from {}", a);
            prop_assert!(things.iter_ones(a).all(|o| found.objects.get(a, o)), "objects from {}", a);
        }
        if solid.is_empty() {
            prop_assert_eq!(&found.boxes, &boxes);
            prop_assert_eq!(&found.objects, &things);
            let ones = boxes.count_ones() + things.count_ones();
            shown.set(shown.get() + ones);
            hidden.set(hidden.get() + (eyes.len() * (eyes.len() + objects.len())) as u64 - ones);
        } else {
            in_solid.set(in_solid.get() + 1);
        }
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("boxes_see_what_the_cells_in_them_see: {e}"));
    assert!(shown.get() > cases / 2 && hidden.get() > cases / 4, "{} {}", shown.get(), hidden.get());
    assert!(in_solid.get() > cases / 32, "{}", in_solid.get());
}

/// A wall across the cube with a door of 1 by 1 at its lower corner.
fn door() -> CellGraph<Axial> {
    let wall = [([2.0, 1.0, 0.0], [2.0, 4.0, 4.0]), ([2.0, 0.0, 1.0], [2.0, 1.0, 4.0])];
    cut(&wall.map(|(min, max)| AxialFace::new(0, min, max)), &[false]).0
}

fn cube(at: [f64; 3], size: f64) -> Aabb<3> {
    Aabb { min: at, max: at.map(|x| x + size) }
}

/// Only requested pairs are answered; a box that extends beyond the cells sees everything requested.
#[test]
fn only_what_is_asked_is_answered() {
    let graph = door();
    // The first sees the second through the door, and not the third.
    let eyes = [cube([0.25; 3], 0.5), cube([3.25, 0.25, 0.25], 0.5), cube([3.25, 3.25, 3.25], 0.5)];
    let things = [cube([3.0, 0.5, 0.5], 0.25), cube([2.25, 3.5, 3.5], 0.25)];
    let found = seen(&graph, &[], &eyes, &things);
    assert_eq!([0, 1, 2].map(|b| found.boxes.get(0, b)), [true, true, false]);
    assert_eq!([0, 1].map(|o| found.objects.get(0, o)), [true, false]);
    let mut asked = PairMask { boxes: BitMatrix::new(3, 3), objects: BitMatrix::new(3, 2) };
    asked.objects.set(0, 1, true);
    asked.objects.set(1, 0, true);
    let some =
        box_visibility(&graph, &[], &[], &eyes, &things, &asked, &SearchOptions::default()).expect("nobody cancels");
    assert_eq!((some.boxes.count_ones(), some.objects.count_ones()), (0, 1));
    assert!(some.objects.get(1, 0) && some.counters.n_asked < found.counters.n_asked);
    let beyond = [Aabb { min: [-1.0, 0.25, 0.25], max: [0.5, 0.5, 0.5] }, eyes[2]];
    let found = seen(&graph, &[], &beyond, &things);
    assert!(found.boxes.get(0, 1) && found.objects.get(0, 1));
    let found = seen(&graph, &[], &eyes, &[Aabb { min: [3.5; 3], max: [4.5; 3] }]);
    assert!(found.objects.get(0, 0), "nothing is known of what is beyond the cells");
}

/// A flat box, or a point, sees what a thin box around it sees.
#[test]
fn flat_boxes_see_what_is_around_them() {
    let graph = door();
    let things = [cube([3.0, 0.5, 0.5], 0.25), cube([2.5, 3.5, 3.5], 0.25), cube([1.0, 3.0, 3.0], 0.5)];
    let point = Aabb { min: [0.5; 3], max: [0.5; 3] };
    let flat = Aabb { min: [0.5, 0.25, 0.25], max: [0.5, 0.75, 0.75] };
    for eye in [point, flat] {
        let found = seen(&graph, &[], &[eye, cube([3.25, 0.25, 0.25], 0.25), cube([3.0; 3], 0.5)], &things);
        assert_eq!([0, 1, 2].map(|o| found.objects.get(0, o)), [true, false, true], "{eye:?}");
        assert_eq!([0, 1, 2].map(|b| found.boxes.get(0, b)), [true, true, false], "{eye:?}");
    }
}

/// The impostor: with the door walled up, nothing behind it is seen, and with no wall everything is.
#[test]
fn a_door_makes_the_difference() {
    let eyes = [cube([0.25; 3], 0.5), cube([3.25, 0.25, 0.25], 0.5), cube([3.25, 3.25, 3.25], 0.5)];
    let walled = cut(&[AxialFace::new(0, [2.0, 0.0, 0.0], [2.0, 4.0, 4.0])], &[false]).0;
    let n_seen = |graph: &CellGraph<Axial>| seen(graph, &[], &eyes, &[]).boxes.count_row(0);
    assert_eq!([n_seen(&walled), n_seen(&door()), n_seen(&cut(&[], &[false]).0)], [1, 2, 3]);
}
