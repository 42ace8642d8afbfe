//! A viewer turns around in the middle one of three rooms: what each method shows, what a shut door changes, and what
//! is in the mirror on the west wall.
//!
//! ```text
//! +---+---+---+
//! m 0 | 1   2 |
//! m   |   |   |
//! m     1 |   |
//! +---+---+---+
//! ```

use sightlines_eye_to_cell::{
    Doors, Method, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, DoorRecord, Locator, MirrorId, MirrorRecord, PortalId, PortalRecord, Table,
    TableError, TableKind, TableParts,
};

/// Three rooms of 4 by 4 units that all see each other; a baked table would be read from a file.
fn house() -> Result<Table, TableError> {
    let corners = [0.0, 4.0, 8.0].map(|x| ([x, 0.0, 0.0], [x + 4.0, 4.0, 0.0]));
    let door = |i: u32, x: f64, y: f64| PortalRecord {
        cells: [CellId(i), CellId(i + 1)],
        sides: [1, 3],
        points: vec![[x, y + 1.0, 0.0], [x, y, 0.0]],
    };
    let mut parts = TableParts::empty(2, TableKind::Unspecified);
    parts.locator = Locator::build(&corners, 2);
    parts.cells = corners.map(|(min, max)| CellRecord { min, max, group: None, polygon: vec![] }).to_vec();
    parts.portals = vec![door(0, 4.0, 0.0), door(1, 8.0, 3.0)];
    parts.doors = vec![DoorRecord { name: "second door".to_owned(), object: None, portals: vec![PortalId(1)] }];
    parts.rows = BitMatrix::identity(3);
    for (a, b) in [(0, 1), (1, 0), (1, 2), (2, 1), (0, 2), (2, 0)] {
        parts.rows.set(a, b, true);
    }
    parts.cell_objects = vec![vec![]; 3];
    // For a viewer who looks west, the south is on the left.
    let points = vec![[0.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    parts.mirrors = vec![MirrorRecord { cell: CellId(0), mirror: MirrorId(7), points }];
    Table::new(parts)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = house()?;
    let cells = TableCells::new(&table);
    let subgraphs = (0..3).map(|cell| VisibleSubgraph::prepare(&cells, CellId(cell))).collect::<Result<Vec<_>, _>>()?;
    let (mut seen, mut scratch, mut doors) = (VisibleSet::new(), Scratch::new(), Doors::all_open());
    // What a frame may spend: without it, the exact method takes as long as it needs.
    scratch.allow(StepBudget::FRAME);
    let eye = [4.5, 0.5];
    for degrees in [0, 60, 90, 180] {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let view = View::planar(eye, [cos, sin], 60f64.to_radians())?;
        println!("at {eye:?}, towards {degrees} degrees:");
        for shut in [false, true] {
            if shut {
                for door in table.door("second door") {
                    doors.close_door(table.doors(), door);
                }
            } else {
                doors.open_all();
            }
            for method in Method::ALL {
                seen.clear(table.n_cells(), 0);
                // On the border between rooms there would be more than one.
                for root in table.in_dimension().unwrap().at(eye).cells().iter().copied() {
                    method.look(&subgraphs[root.idx()], &view, &doors, &mut scratch, &mut seen);
                }
                seen.sort();
                let subgraph = |cell: CellId| subgraphs.get(cell.idx());
                let images = follow_reflections(method, &seen, 1, &doors, &mut scratch, [3, 0], subgraph);
                let images: Vec<u32> = images.iter().flat_map(|image| &image.cells).map(|cell| cell.0).collect();
                let state = if shut { "second door shut" } else { "all doors open" };
                println!("  {state:16}  {method:20} rooms {:?}, in the mirror {images:?}", seen.cells());
            }
        }
    }
    Ok(())
}
