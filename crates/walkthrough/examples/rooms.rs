//! A viewer walks along a corridor of ten rooms; one of the doors is closed in between.

use sightlines_eye_to_cell::{Method, TableCells, View};
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, DoorRecord, Locator, PortalId, PortalRecord, Table, TableKind, TableParts,
};
use sightlines_walkthrough::{WalkOptions, Walkthrough};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let room = |i: u32| {
        let x = f64::from(i);
        CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] }
    };
    let door = |i: u32| {
        let x = f64::from(i) + 1.0;
        PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [0, 1], points: vec![[x, 0.6, 0.0], [x, 0.4, 0.0]] }
    };
    let cells: Vec<CellRecord> = (0..10).map(room).collect();
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    let mut rows = BitMatrix::new(10, 10);
    (0..100).for_each(|k| rows.set(k / 10, k % 10, true));
    let table = Table::new(TableParts {
        cells,
        rows,
        portals: (0..9).map(door).collect(),
        doors: vec![DoorRecord { name: "last but one".to_owned(), object: None, portals: vec![PortalId(7)] }],
        cell_objects: vec![vec![]; 10],
        locator: Locator::build(&bounds, 2),
        ..TableParts::empty(2, TableKind::Unspecified)
    })?;

    let table = Arc::new(table);
    let cells = TableCells::new(Arc::clone(&table));
    let mut walk = Walkthrough::new(cells.clone(), cells, WalkOptions::default());
    for k in 0..20 {
        if k == 10 {
            for door in table.door("last but one") {
                walk.close_door(table.doors(), door);
            }
        }
        let view = View::planar([0.25 + 0.5 * f64::from(k), 0.5], [1.0, 0.0], 0.3)?;
        walk.frame(&view, Method::Exact);
        // A game would draw the superset now; this example waits for its requests.
        while !walk.is_idle() {
            std::thread::yield_now();
        }
        let frame = walk.frame(&view, Method::Exact);
        println!("in {:?} ({:?}): sees {:?}", frame.at, frame.answer, frame.seen.cells());
    }
    Ok(())
}
