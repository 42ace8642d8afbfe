//! Explanations in space, on small grids where lines meet edges of portals often, against the answer for
//! all cells.

use sightlines_cells::{Axial, BoxCell, CellGraph, CellId, Portal};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_kdtree::{AxialFace, AxialPortal, KdOptions, subdivide};
use sightlines_sightline::{BoxTarget, Verdict};
use sightlines_stabtree::{
    AxialPath, AxialProof, Barrier, SearchLimit, SearchOptions, Sight, axial_visibility, explain_axial,
};
use sightlines_testkit::draw;

use proptest::prelude::*;

/// Side of the cube that scenes are in.
const SIDE: i32 = 4;

fn faces() -> impl Strategy<Value = Vec<AxialFace<3>>> {
    let ends = || prop::array::uniform3(0..=SIDE);
    let face = (0..3usize, ends(), ends()).prop_map(|(axis, p, mut q)| {
        q[axis] = p[axis];
        let [min, max] = [i32::min, i32::max].map(|f: fn(i32, i32) -> i32| [0, 1, 2].map(|k| f64::from(f(p[k], q[k]))));
        AxialFace::new(axis, min, max)
    });
    prop::collection::vec(face, 1..24)
}

fn cut(faces: &[AxialFace<3>]) -> CellGraph<Axial> {
    let room = Aabb { min: [0.0; 3], max: [f64::from(SIDE); 3] };
    let tree = subdivide(faces, room, &KdOptions::default()).expect("the scene is good");
    let portal = |p: &AxialPortal<3>| {
        let axis = p.axis as u8;
        let shape = AxialDoor { extent: Aabb { min: p.min, max: p.max }, axis, forward: true };
        Portal { cells: p.cells, sides: [2 * u32::from(axis) + 1, 2 * u32::from(axis)], shape }
    };
    let cells = tree.cells().iter().map(|c| BoxCell { bounds: c.bounds }).collect();
    let graph = CellGraph::<Axial>::new(cells, tree.portals().iter().map(portal).collect());
    graph.assert_well_formed();
    graph
}

/// Invariant: every pair is explained in agreement with the search; doors lead from cell to cell along the line.
#[test]
fn every_pair_is_explained() {
    let (mut n_ends, mut n_edges, mut n_hidden, mut n_apart) = (0u32, 0u32, 0u32, 0u32);
    for faces in draw(&faces(), 150) {
        let graph = cut(&faces);
        let options = SearchOptions { threads: 1, ..SearchOptions::default() };
        let seen = axial_visibility(&graph, &[], &[], &[], &options).expect("nobody cancels").cells;
        for (a, b) in graph.cell_ids().flat_map(|a| graph.cell_ids().map(move |b| (a, b))) {
            let explanation = explain_axial(&graph, &[], a, b, 2_000);
            let visible = explanation.is_visible();
            assert_eq!(visible, seen.get(a.idx(), b.idx()), "{a} {b}: {explanation:?} in {faces:?}");
            match explanation {
                Verdict::Visible(Sight::SameCell) => assert_eq!(a, b),
                Verdict::Visible(Sight::Along(AxialPath { portals, cells, doors, witness, ends })) => {
                    let mut here = a;
                    assert!(portals.len() == cells.len() && cells.len() == doors.len());
                    for ((portal, cell), door) in portals.into_iter().zip(cells).zip(&doors) {
                        let exit = graph.exits(here).iter().find(|e| e.portal == portal && e.to == cell);
                        assert_eq!(exit.map(|exit| graph.door(exit)), Some(*door), "{a} {b} in {faces:?}");
                        assert!(witness.passes(door), "{a} {b} in {faces:?}");
                        here = cell;
                    }
                    assert_eq!(here, b);
                    let inside = |cell: CellId, p: [f64; 3]| graph.cell(cell).bounds.contains(p);
                    match ends {
                        Some([p, q]) => assert!(inside(a, p) && inside(b, q), "{a} {b} in {faces:?}"),
                        None => n_edges += 1,
                    }
                    n_ends += u32::from(ends.is_some());
                }
                Verdict::Hidden(Barrier::Blocked(AxialProof { proof, walls, .. })) => {
                    let [from, to] = [a, b].map(|cell| graph.cell(cell).bounds);
                    assert!(proof.holds(&from, &to, BoxTarget::Inside, &walls), "{a} {b} in {faces:?}");
                    n_hidden += 1;
                }
                Verdict::Hidden(Barrier::NotConnected) => n_apart += 1,
                Verdict::Undecided(_) => panic!("{a} {b} in {faces:?}"),
            }
        }
    }
    eprintln!("{n_ends} lines, {n_edges} past edges, {n_hidden} hidden, {n_apart} not connected");
    assert!(n_ends > 1000 && n_edges > 0 && n_hidden > 500 && n_apart > 0, "{n_ends} {n_edges} {n_hidden} {n_apart}");
}

/// Without a budget, the pair stays undecided.
#[test]
fn a_budget_is_kept_to() {
    let wall = AxialFace::new(0, [2.0, 0.0, 0.0], [2.0, 2.0, 4.0]);
    let graph = cut(&[wall]);
    let ids = [CellId(0), CellId(1)];
    let explain = |budget| explain_axial(&graph, &[], ids[0], ids[1], budget);
    assert_eq!(explain(0), Verdict::Undecided(SearchLimit(0)));
    assert!(explain(100).is_visible());
}
