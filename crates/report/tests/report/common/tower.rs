//! A small table in space: two storeys, of which only the lower one is divided. y is up.
//!
//! ```text
//! from above, lower storey       from the south (z towards the viewer)
//! +---0---+---1---+  z = 0       +-------2-------+  y = 5
//! |       |       |              +---0---+---1---+  y = 3
//! |       door    |              |       |       |
//! |       |       |              +-------+-------+  y = 0
//! +-------+-------+  z = 2       x = 0   4       6
//! ```

use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, PortalRecord, Table, TableKind, TableParts,
};

fn cell(min: [f64; 3], max: [f64; 3]) -> CellRecord {
    CellRecord { min, max, group: None, polygon: vec![] }
}

/// Rooms 0 and 1 see each other through a door, which ends at height 2; the attic above is closed. The
/// lamp is in room 0, the cat in the attic; room 1 does not see the lamp.
pub(crate) fn house() -> Table {
    let cells = vec![
        cell([0.0, 0.0, 0.0], [4.0, 3.0, 2.0]),
        cell([4.0, 0.0, 0.0], [6.0, 3.0, 2.0]),
        cell([0.0, 3.0, 0.0], [6.0, 5.0, 2.0]),
    ];
    let points = vec![[4.0, 0.0, 0.5], [4.0, 0.0, 1.5], [4.0, 2.0, 1.5], [4.0, 2.0, 0.5]];
    let door = PortalRecord { cells: [CellId(0), CellId(1)], sides: [1, 0], points };
    let object = |name: &str, p: [f64; 3]| ObjectRecord { name: name.into(), min: p, max: p };
    let mut rows = BitMatrix::identity(3);
    rows.set(0, 1, true);
    rows.set(1, 0, true);
    let mut objects_seen = BitMatrix::new(3, 2);
    objects_seen.set(0, 0, true);
    objects_seen.set(2, 1, true);
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    Table::new(TableParts {
        objects_seen: Some(objects_seen),
        locator: Locator::build(&bounds, 3),
        rows,
        cells,
        portals: vec![door],
        objects: vec![object("lamp", [1.0, 2.5, 0.2]), object("cat", [5.0, 3.0, 1.0])],
        cell_objects: vec![vec![ObjectId(0)], vec![], vec![ObjectId(1)]],
        ..TableParts::empty(3, TableKind::Unspecified)
    })
    .expect("a sound table")
}
