//! The two ways of the exact method have the same answer, in blocks of boxes or squares with doors at random places.

use super::exact::by_sequences;
use super::missing::list_missing;
use super::query::Query;
use super::sweep::{keep_unfinished, sweep, sweep_within};
use crate::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use proptest::prelude::*;
use sightlines_pvs::{BitMatrix, CellId, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};
use std::f64::consts::TAU;

/// Boxes along each side of the block.
const N: usize = 4;

fn cell(x: usize, y: usize, z: usize) -> CellId {
    CellId((x + N * (y + N * z)) as u32)
}

/// A door in the wall that is the upper one, along `axis`, of the box at `at`: within it, in eighths.
fn door(axis: usize, at: [usize; 3], [low, high]: [[u8; 2]; 2]) -> PortalRecord {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |u: u8, v: u8| {
        let mut p = at.map(|i| i as f64);
        p[axis] += 1.0;
        p[b] += f64::from(u) / 8.0;
        p[c] += f64::from(v) / 8.0;
        p
    };
    // As seen from below along the axis, with b to c counter-clockwise about it: the other way round.
    let points =
        vec![corner(low[0], low[1]), corner(low[0], high[1]), corner(high[0], high[1]), corner(high[0], low[1])];
    let mut next = at;
    next[axis] += 1;
    let cells = [at, next].map(|[x, y, z]| cell(x, y, z));
    PortalRecord { cells, sides: [2 * axis as u32 + 1, 2 * axis as u32], points }
}

/// Every wall has a door from the first numbers to the second ones, wholly open for equal ones.
pub(super) fn block(doors: &[[u8; 4]]) -> Table {
    let mut cells = Vec::new();
    let mut portals = Vec::new();
    let mut chosen = doors.iter().cycle();
    for (z, y, x) in (0..N * N * N).map(|i| (i / N / N, i / N % N, i % N)) {
        let min = [x, y, z].map(|i| i as f64);
        cells.push(CellRecord { min, max: min.map(|m| m + 1.0), group: None, polygon: vec![] });
        for axis in 0..3 {
            let at = [x, y, z];
            if at[axis] + 1 < N {
                let &[a, b, c, d] = chosen.next().unwrap();
                let range = |a: u8, b: u8| if a == b { [0, 8] } else { [a.min(b), a.max(b)] };
                let ([b0, b1], [c0, c1]) = (range(a, b), range(c, d));
                portals.push(door(axis, at, [[b0, c0], [b1, c1]]));
            }
        }
    }
    all_see_all(3, cells, portals)
}

/// The same in the plane, with `side` squares along each side.
pub(super) fn plan(doors: &[[u8; 4]], side: usize) -> Table {
    let mut cells = Vec::new();
    let mut portals = Vec::new();
    let mut chosen = doors.iter().cycle();
    let id = |x: usize, y: usize| CellId((x + side * y) as u32);
    for (y, x) in (0..side * side).map(|i| (i / side, i % side)) {
        let (u, v) = (x as f64, y as f64);
        let (min, max) = ([u, v, 0.0], [u + 1.0, v + 1.0, 0.0]);
        cells.push(CellRecord { min, max, group: None, polygon: vec![] });
        let mut range = || {
            let &[a, b, ..] = chosen.next().unwrap();
            let [low, high] = if a == b { [0, 8] } else { [a.min(b), a.max(b)] };
            [f64::from(low) / 8.0, f64::from(high) / 8.0]
        };
        if x + 1 < side {
            let [low, high] = range();
            let points = vec![[u + 1.0, v + high, 0.0], [u + 1.0, v + low, 0.0]];
            portals.push(PortalRecord { cells: [id(x, y), id(x + 1, y)], sides: [1, 0], points });
        }
        if y + 1 < side {
            let [low, high] = range();
            let points = vec![[u + low, v + 1.0, 0.0], [u + high, v + 1.0, 0.0]];
            portals.push(PortalRecord { cells: [id(x, y), id(x, y + 1)], sides: [3, 2], points });
        }
    }
    all_see_all(2, cells, portals)
}

/// A table whose rows hide nothing.
fn all_see_all(dimension: u8, cells: Vec<CellRecord>, portals: Vec<PortalRecord>) -> Table {
    let n = cells.len();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    let mut rows = BitMatrix::new(n, n);
    (0..n * n).for_each(|k| rows.set(k / n, k % n, true));
    let parts = TableParts {
        rows,
        portals,
        cell_objects: vec![vec![]; n],
        locator: Locator::build(&bounds, dimension),
        cells,
        ..TableParts::empty(dimension, TableKind::Unspecified)
    };
    Table::new(parts).unwrap()
}

fn seen_by(subgraph: &VisibleSubgraph, view: &View, way: fn(&mut Query<'_>) -> bool) -> Vec<u32> {
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    seen.clear(1 << 10, 0);
    for part in view.parts() {
        let doors = Doors::all_open();
        let mut query = Query::new(subgraph, view, part, &doors, &mut scratch, &mut seen);
        list_missing(&mut query);
        assert!(way(&mut query), "boxes have an order from front to back");
    }
    seen.sort();
    seen.cells().iter().map(|cell| cell.0).collect()
}

fn compare(doors: &[[u8; 4]], eye: [f64; 3], dir: [f64; 3], fov: f64) -> Result<usize, TestCaseError> {
    compare_in(&block(doors), &View::perspective_horizontal(eye, dir, [0.0, 0.0, 1.0], fov, 1.25).unwrap())
}

fn compare_in(table: &Table, view: &View) -> Result<usize, TestCaseError> {
    let mut n_seen = 0;
    for root in table.place_at(view.eye()).cells().iter().copied() {
        let subgraph = VisibleSubgraph::prepare(&TableCells::new(table), root).unwrap_or_else(|never| match never {});
        let sequences = seen_by(&subgraph, view, |query| by_sequences(query, u64::MAX));
        let pieces = seen_by(&subgraph, view, sweep);
        prop_assert_eq!(&sequences, &pieces);
        n_seen += pieces.len();
    }
    Ok(n_seen)
}

proptest! {
    /// Invariant: front to back in pieces, and sequence by sequence: the same cells. Eyes off the walls, where nothing is
    /// seen by grazing alone but by chance.
    #[test]
    fn sweep_and_sequences_agree(
        doors in prop::collection::vec(prop::array::uniform4(0u8..9), 1..30),
        eye in prop::array::uniform3(0.03f64..3.97),
        dir in prop::array::uniform3(-1.0f64..1.0),
        fov in 0.1f64..TAU,
    ) {
        prop_assume!(dir.iter().any(|x| x.abs() > 0.01));
        prop_assert!(compare(&doors, eye, dir, fov)? > 0);
    }

    /// The same in the plane.
    #[test]
    fn sweep_and_sequences_agree_in_the_plane(
        doors in prop::collection::vec(prop::array::uniform4(0u8..9), 1..30),
        eye in prop::array::uniform2(0.03f64..5.97),
        turn in 0.0f64..TAU,
        fov in 0.01f64..TAU,
    ) {
        let view = View::planar(eye, [turn.cos(), turn.sin()], fov).unwrap();
        prop_assert!(compare_in(&plan(&doors, 6), &view)? > 0);
    }
}

/// Whatever the limit on pieces: who says that all was found has found all.
#[test]
fn limits_are_reported() {
    let table = plan(&[[0, 0, 0, 0], [2, 6, 1, 5], [0, 0, 0, 0], [3, 8, 0, 4]], 5);
    let view = View::all_round([2.3, 2.6, 0.0]).unwrap();
    let root = table.in_dimension().unwrap().at([2.3, 2.6]).cells()[0];
    let subgraph = VisibleSubgraph::prepare(&TableCells::new(&table), root).unwrap_or_else(|never| match never {});
    let all = seen_by(&subgraph, &view, |query| by_sequences(query, u64::MAX));
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    seen.clear(1 << 10, 0);
    Method::IncidentPortals.look(&subgraph, &view, &Doors::all_open(), &mut scratch, &mut seen);
    let n_coarser = seen.cells().len();
    let (mut n_done, mut n_dropped, mut n_between) = (0, 0, 0);
    for most in 0..100 {
        seen.clear(1 << 10, 0);
        let doors = Doors::all_open();
        let mut query = Query::new(&subgraph, &view, &view.parts()[0], &doors, &mut scratch, &mut seen);
        list_missing(&mut query);
        let done = sweep_within(&mut query, most);
        seen.sort();
        assert!(seen.cells().iter().all(|cell| all.contains(&cell.0)));
        assert!(!done || seen.cells().iter().map(|cell| cell.0).eq(all.iter().copied()), "{most}");
        n_done += usize::from(done);
        // What it has left, the rest has.
        let doors = Doors::all_open();
        let mut query = Query::new(&subgraph, &view, &view.parts()[0], &doors, &mut scratch, &mut seen);
        query.seen.clear(1 << 10, 0);
        list_missing(&mut query);
        if !sweep_within(&mut query, most) {
            let n_found = query.seen.cells().len();
            keep_unfinished(&mut query);
            assert!(all.iter().all(|&cell| seen.has_cell(CellId(cell))), "{most}");
            n_dropped += usize::from(n_found < all.len());
            n_between += usize::from(seen.cells().len() < n_coarser);
        }
    }
    // Impostor: what the sweep alone has found; and twin: the rest is not all that the incident portals lead to.
    assert!(n_dropped > 10 && n_between > 5, "{n_dropped} {n_between}");
    assert!((10..95).contains(&n_done), "{n_done}");
}

#[test]
fn open_squares_are_seen_whole() {
    let view = View::all_round([0.3, 0.4, 0.0]).unwrap();
    assert_eq!(compare_in(&plan(&[[0; 4]], 24), &view).unwrap(), 24 * 24);
}

#[test]
fn open_blocks_are_seen_whole() {
    let n = compare(&[[0, 0, 0, 0]], [0.3, 0.4, 0.55], [1.0, 0.0, 0.0], TAU).unwrap();
    assert_eq!(n, N * N * N);
}
