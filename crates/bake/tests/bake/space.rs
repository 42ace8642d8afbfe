//! The graph that the table of a scene in space stores, and explanations from it.

use sightlines_bake::from_table::{axial_graph, planar_graph};
use sightlines_bake::{PortalMode, SceneBakeOptions, bake_scene};
use sightlines_cells::{Axial, CellGraph, CellId};
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};
use sightlines_scenes::{TowerOptions, tower};
use sightlines_sightline::{BoxTarget, Verdict};
use sightlines_stabtree::{AxialPath, AxialProof, Barrier, Sight, explain_axial};
use std::collections::BTreeSet;

const MODES: [PortalMode; 2] = [PortalMode::Exact, PortalMode::Bounding];

fn baked(portals: PortalMode) -> Table {
    let scene = tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, ..TowerOptions::default() }).expect("a tower");
    let options = SceneBakeOptions { portals, threads: 1, ..SceneBakeOptions::default() };
    bake_scene(&scene, &options).expect("a table").table
}

fn graph(table: &Table) -> CellGraph<Axial> {
    axial_graph(table).expect("the table has its geometry")
}

/// With bounding portals there is one portal for each pair of cells that has any, the smallest rectangle around the
/// exact ones.
#[test]
fn bounding_portals_are_around_the_exact_ones() {
    let [exact, bounding] = MODES.map(|mode| graph(&baked(mode)));
    let pairs = |graph: &CellGraph<Axial>| graph.portals().iter().map(|p| p.cells).collect::<BTreeSet<_>>();
    assert_eq!(pairs(&exact), pairs(&bounding));
    assert_eq!(pairs(&bounding).len(), bounding.portals().len());
    assert!(bounding.portals().len() < exact.portals().len(), "some openings have several pieces");
    for portal in bounding.portals() {
        let pieces = exact.portals().iter().filter(|p| p.cells == portal.cells);
        let around = Aabb::around(pieces.flat_map(|p| [p.shape.extent.min, p.shape.extent.max]));
        assert_eq!(portal.shape.extent, around);
    }
}

/// The same table with other portals and rows.
fn with(table: &Table, portals: Vec<PortalRecord>, rows: BitMatrix) -> Table {
    let cells: Vec<CellRecord> = table.cells().to_vec();
    let bounds: Vec<([f64; 3], [f64; 3])> = cells.iter().map(|c| (c.min, c.max)).collect();
    Table::new(TableParts {
        portals,
        rows,
        cell_objects: vec![Vec::new(); cells.len()],
        locator: Locator::build(&bounds, 3),
        cells,
        ..TableParts::empty(3, TableKind::Unspecified)
    })
    .expect("the parts fit together")
}

/// Invariant: explanations agree with the table, for portals of both kinds; a line begins and ends in the two cells, and
/// a proof holds for the walls that it comes with.
#[test]
fn explanations_agree_with_tables() {
    for mode in MODES {
        let table = baked(mode);
        let graph = graph(&table);
        let (mut n_seen, mut n_hidden, mut n_ends, mut most_nodes) = (0, 0, 0, 0);
        let ids = || (0..table.n_cells() as u32).step_by(5).map(CellId);
        for (a, b) in ids().flat_map(|a| ids().map(move |b| (a, b))) {
            let [from, to] = [a, b].map(|cell| graph.cell(cell).bounds);
            match explain_axial(&graph, &[], a, b, 20_000) {
                Verdict::Visible(Sight::SameCell) => assert_eq!(a, b),
                Verdict::Visible(Sight::Along(AxialPath { portals, cells, doors, witness, ends })) => {
                    assert!(table.sees(a, b), "{a} {b}");
                    n_seen += 1;
                    n_ends += u32::from(ends.is_some());
                    let mut here = a;
                    for ((portal, &cell), door) in portals.iter().zip(&cells).zip(&doors) {
                        let exits = graph.exits(here).iter();
                        let exit = exits.clone().find(|e| e.portal == *portal && e.to == cell).expect("a way out");
                        assert!(graph.door(exit) == *door && witness.passes(door), "{a} {b}");
                        here = cell;
                    }
                    assert_eq!(here, b);
                    for (end, cell) in ends.into_iter().flatten().zip([from, to]) {
                        assert!(cell.contains(end), "{a} {b} {end:?}");
                    }
                }
                Verdict::Hidden(Barrier::Blocked(AxialProof { proof, walls, n_blockers })) => {
                    assert!(!table.sees(a, b), "{a} {b}");
                    n_hidden += 1;
                    assert!(proof.holds(&from, &to, BoxTarget::Inside, &walls) && walls.len() <= n_blockers);
                    assert!(!proof.holds(&from, &to, BoxTarget::Inside, &walls[1..]), "{a} {b}");
                    most_nodes = most_nodes.max(proof.size().n_nodes);
                }
                Verdict::Hidden(Barrier::NotConnected) => assert!(!table.sees(a, b), "{a} {b}"),
                Verdict::Undecided(_) => panic!("{a} {b}: undecided"),
            }
        }
        eprintln!("{mode:?}: {n_seen} seen, {n_ends} with ends, {n_hidden} hidden by at most {most_nodes} nodes");
        assert!(n_seen > 100 && n_hidden > 50 && n_ends > 100, "{n_seen} {n_hidden} {n_ends}");
    }
}

/// A comparison that has to fail: with a portal closed, some cell is not seen that the table says is.
#[test]
fn a_closed_portal_is_explained() {
    let table = baked(PortalMode::Exact);
    let closed = (0..table.portals().len()).filter(|closed| {
        let mut portals = table.portals().to_vec();
        let [a, b] = portals.remove(*closed).cells;
        let graph = graph(&with(&table, portals, BitMatrix::identity(table.n_cells())));
        explain_axial(&graph, &[], a, b, 20_000).is_hidden()
    });
    assert!(closed.take(3).count() == 3);
}

#[test]
fn graphs_come_back_from_tables_that_have_them() {
    for mode in MODES {
        let table = baked(mode);
        let graph = graph(&table);
        assert_eq!((graph.n_cells(), graph.portals().len()), (table.n_cells(), table.portals().len()));
        assert!(graph.portals().iter().zip(table.portals()).all(|(p, q)| p.cells == q.cells && p.sides == q.sides));
        assert!(planar_graph(&table).is_none() && axial_graph(&table.strip_geometry()).is_none());
    }
    let table = baked(PortalMode::Exact);
    let changed = |change: &dyn Fn(&mut PortalRecord)| {
        let mut portals = table.portals().to_vec();
        change(&mut portals[0]);
        axial_graph(&with(&table, portals, BitMatrix::identity(table.n_cells())))
    };
    assert!(changed(&|_| {}).is_some());
    assert!(changed(&|p| p.sides = [6, 7]).is_none());
    assert!(changed(&|p| p.sides.swap(0, 1)).is_none());
    assert!(changed(&|p| p.points[0][0] += 0.5).is_none());
    assert!(changed(&|p| p.points.truncate(3)).is_none());
    // Cells that nothing joins are no stripped table.
    let apart = with(&table, Vec::new(), BitMatrix::identity(table.n_cells()));
    let explained = explain_axial(&graph(&apart), &[], CellId(0), CellId(1), 1);
    assert_eq!(explained, Verdict::Hidden(Barrier::NotConnected));
}
