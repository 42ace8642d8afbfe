//! A small table: two rooms of different sizes above one long room.
//!
//! ```text
//! +---1---+--2--+
//! |       |     |
//! +--door-+-----+
//! |      0      |
//! +-------------+
//! ```

pub(crate) mod svg;
pub(crate) mod tower;

use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, PortalRecord, Table, TableKind, TableParts,
};

fn cell(min: [f64; 2], max: [f64; 2], group: Option<u32>) -> CellRecord {
    let ([x0, y0], [x1, y1]) = (min, max);
    let polygon = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    CellRecord { min: [x0, y0, 0.0], max: [x1, y1, 0.0], group, polygon }
}

/// Rooms 0 and 1 see each other through a door; room 2 is closed, or sees room 0 if `leak` says so.
pub(crate) fn rooms(leak: bool) -> Table {
    let cells = vec![
        cell([-3.0, 0.0], [5.0, 2.0], Some(7)),
        cell([-3.0, 2.0], [2.0, 4.0], None),
        cell([2.0, 2.0], [5.0, 4.0], Some(3)),
    ];
    let door =
        PortalRecord { cells: [CellId(0), CellId(1)], sides: [2, 0], points: vec![[-1.0, 2.0, 0.0], [0.1, 2.0, 0.0]] };
    let desk = ObjectRecord { name: "de\"sk".into(), min: [-2.0, 0.5, 0.0], max: [-1.0, 1.0, 0.0] };
    let safe = ObjectRecord { name: "safe".into(), min: [4.5, 3.5, 0.0], max: [4.5, 3.5, 0.0] };
    let mut rows = BitMatrix::identity(3);
    for (a, b) in [(0, 1), (0, 2)].into_iter().take(1 + usize::from(leak)) {
        rows.set(a, b, true);
        rows.set(b, a, true);
    }
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    Table::new(TableParts {
        locator: Locator::build(&bounds, 2),
        rows,
        cells,
        portals: vec![door],
        objects: vec![desk, safe],
        cell_objects: vec![vec![ObjectId(0)], vec![], vec![ObjectId(1)]],
        ..TableParts::empty(2, TableKind::Unspecified)
    })
    .expect("a sound table")
}

/// A table without cells.
pub(crate) fn nothing() -> Table {
    Table::new(TableParts {
        locator: Locator::build(&[], 2),
        rows: BitMatrix::identity(0),
        cells: vec![],
        cell_objects: vec![],
        ..TableParts::empty(2, TableKind::Unspecified)
    })
    .expect("an empty table is sound")
}
