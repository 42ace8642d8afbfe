//! A walkthrough that continues in another table.

use crate::moving::grid::{Grid, Kind, grid};
use sightlines_eye_to_cell::{Method, TableCells, View};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, PortalId, Table};
use sightlines_walkthrough::{AnswerKind, Motion, MoverOptions, Movers, WalkOptions, Walkthrough, same_portals};
use std::collections::BTreeSet;
use std::sync::Arc;

type Walk = Walkthrough<TableCells<Arc<Table>>, TableCells<Arc<Table>>>;

/// Seven positions in a row, some of them solid; those with an even number are two triangles.
fn squares(solid: impl Fn(usize) -> bool) -> Grid {
    grid(Kind::Plane, [7, 1, 1], solid, |_, _| true)
}

fn until_full(walk: &mut Walk, view: &View) -> BTreeSet<u32> {
    loop {
        let frame = walk.frame(view, Method::Exact);
        if frame.answer == AnswerKind::Full {
            return frame.seen.cells().iter().map(|cell| cell.0).collect();
        }
        std::thread::yield_now();
    }
}

/// `n` rooms in a row with doors between them except where `walled`, in the opposite order if `turned`.
fn rooms(n: u32, walled: &[u32], turned: bool) -> Arc<Table> {
    use sightlines_pvs::{BitMatrix, CellRecord, Locator, PortalRecord, TableKind, TableParts};
    let record = |i: u32| {
        let x = f64::from(i);
        CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] }
    };
    let cells: Vec<CellRecord> = (0..n).map(record).collect();
    let bounds: Vec<_> = cells.iter().map(|c| (c.min, c.max)).collect();
    let mut rows = BitMatrix::new(n as usize, n as usize);
    (0..n * n).for_each(|k| {
        let (a, b) = (k / n, k % n);
        rows.set(a as usize, b as usize, !(a.min(b)..a.max(b)).any(|door| walled.contains(&door)));
    });
    let door = |i: u32| {
        let x = f64::from(i) + 1.0;
        PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [0, 1], points: vec![[x, 0.75, 0.0], [x, 0.25, 0.0]] }
    };
    let mut portals: Vec<PortalRecord> = (0..n - 1).filter(|i| !walled.contains(i)).map(door).collect();
    if turned {
        portals.reverse();
    }
    let parts = TableParts {
        rows,
        portals,
        cell_objects: vec![vec![]; n as usize],
        locator: Locator::build(&bounds, 2),
        cells,
        ..TableParts::empty(2, TableKind::Unspecified)
    };
    Arc::new(Table::new(parts).unwrap())
}

#[test]
fn walks_go_on_in_another_table() {
    let view = View::planar([0.5, 0.5], [1.0, 0.0], 0.5).unwrap();
    let old = TableCells::new(rooms(8, &[], false));
    let mut walk: Walk = Walkthrough::new(old.clone(), old.clone(), WalkOptions::default());
    walk.close(PortalId(5));
    walk.close(PortalId(2));
    assert_eq!(until_full(&mut walk, &view), (0..3).collect());
    walk.open(PortalId(2));
    assert_eq!(until_full(&mut walk, &view), (0..6).collect());

    // The door between rooms 1 and 2 is walled up; the others have new numbers. Closed doors stay closed.
    let new = TableCells::new(rooms(8, &[1], true));
    let same = same_portals(&old, &new).unwrap();
    assert_eq!(same, [Some(5), None, Some(4), Some(3), Some(2), Some(1), Some(0)].map(|portal| portal.map(PortalId)));
    let frames = walk.counters().frames;
    walk.replace(new.clone(), new.clone(), |portal| same[portal.idx()]);
    assert_eq!(walk.doors().closed().collect::<Vec<_>>(), [PortalId(1)]);
    assert_eq!(walk.kept(), (0, 0));
    assert_eq!(until_full(&mut walk, &view), (0..2).collect());
    let behind = View::planar([2.5, 0.5], [1.0, 0.0], 0.5).unwrap();
    assert_eq!(until_full(&mut walk, &behind), (2..6).collect());
    assert!(walk.counters().frames > frames);

    // And back: doors that are not kept are open.
    walk.replace(old.clone(), old.clone(), |_| None);
    assert_eq!((walk.doors().n_closed(), until_full(&mut walk, &view)), (0, (0..8).collect()));
    // A table with fewer cells.
    let few = TableCells::new(rooms(3, &[], false));
    walk.replace(few.clone(), few, Some);
    assert_eq!(until_full(&mut walk, &view), (0..3).collect());
    assert_eq!(walk.frame(&behind, Method::Exact).ahead[0], CellId(2));
}

#[test]
fn movers_follow_into_another_table() {
    let open = squares(|_| false);
    let walled = squares(|i| i == 3);
    let mut movers = Movers::new(open.cells(), MoverOptions::default());
    let at = |x: f64| Aabb { min: [x, 0.25, 0.0], max: [x + 0.25, 0.75, 0.0] };
    // One that sleeps in position 5, and one that sleeps for a while in the position that becomes solid.
    let ids = [5.5, 3.5].map(|x| movers.add(at(x), Motion::speed(0.0).unwrap(), 0.0).unwrap());
    let mut seen = sightlines_eye_to_cell::VisibleSet::new();
    crate::moving::grid::see(&mut seen, open.n_cells(), [0]);
    let place = |id: sightlines_walkthrough::MoverId| if id == ids[0] { at(5.5) } else { at(3.5) };
    assert_eq!(
        movers.frame(0.0, &crate::moving::grid::frame(&seen, AnswerKind::Full), &mut |id| place(id)).unwrap(),
        []
    );
    assert_eq!((movers.n_awake(), movers.n_entries()), (0, 2));
    movers.replace(walled.cells());
    assert_eq!((movers.n_awake(), movers.n_entries(), movers.counters().asked), (0, 1, 2));
    // The cell of position 5 has a new number now.
    let cell = walled.table.in_dimension().unwrap().at([5.5, 0.5]).cells()[0];
    assert_ne!(open.table.in_dimension().unwrap().at([5.5, 0.5]).cells()[0], cell);
    crate::moving::grid::see(&mut seen, walled.n_cells(), [cell.0]);
    assert_eq!(
        movers.frame(0.01, &crate::moving::grid::frame(&seen, AnswerKind::Full), &mut |id| place(id)).unwrap(),
        [ids[0]]
    );
    // A table of another dimension wakes all.
    let space = grid(Kind::Space, [7, 1, 1], |_| false, |_, _| true);
    movers.replace(space.cells());
    assert_eq!((movers.n_awake(), movers.n_entries()), (2, 0));
}
