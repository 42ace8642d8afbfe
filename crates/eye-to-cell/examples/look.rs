//! A viewer turns round in a house of four rooms: what each method shows, what a shut door changes, and what there is
//! in the mirror on the west wall.
//!
//! ```text
//! +---+---+---+---+
//! m 0 | 1   2 | 3 |     The doors alternate between the lower and the upper wall.
//! m   |   |   |   |
//! m     1 | 2     |
//! +---+---+---+---+
//! ```

use sightlines_eye_to_cell::{
    Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, MirrorId, MirrorRecord, PortalId, PortalRecord, Table, TableKind,
    TableParts,
};

fn room(i: u32) -> CellRecord {
    let (x0, x1) = (4.0 * f64::from(i), 4.0 * f64::from(i + 1));
    let polygon = vec![[x0, 0.0], [x1, 0.0], [x1, 4.0], [x0, 4.0]];
    CellRecord { min: [x0, 0.0, 0.0], max: [x1, 4.0, 0.0], group: None, polygon }
}

/// The door from room `i` to the next, from `y` to `y` + 1.
fn door(i: u32, y: f64) -> PortalRecord {
    let x = 4.0 * f64::from(i + 1);
    PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [1, 3], points: vec![[x, y + 1.0, 0.0], [x, y, 0.0]] }
}

fn house() -> TableParts {
    let cells: Vec<CellRecord> = (0..4).map(room).collect();
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    let mut rows = BitMatrix::identity(4);
    for (a, b) in [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)] {
        rows.set(a, b, true);
        rows.set(b, a, true);
    }
    TableParts {
        locator: Locator::build(&bounds, 2),
        cells,
        portals: vec![door(0, 0.0), door(1, 3.0), door(2, 0.0)],
        rows,
        cell_objects: vec![vec![]; 4],
        // Who looks west has the south at the left hand.
        mirrors: vec![MirrorRecord {
            cell: CellId(0),
            mirror: MirrorId(7),
            points: vec![[0.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
        }],
        ..TableParts::empty(2, TableKind::Unspecified)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = Table::new(house())?;
    let cells = TableCells::new(&table);
    let subgraphs = (0..4).map(|cell| VisibleSubgraph::prepare(&cells, CellId(cell))).collect::<Result<Vec<_>, _>>()?;
    let (mut seen, mut scratch, mut doors) = (VisibleSet::new(), Scratch::new(), Doors::all_open());
    let eye = [3.5, 0.5];
    for degrees in [0, 60, 90, 180] {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let view = View::planar(eye, [cos, sin], 60f64.to_radians())?;
        println!("at {eye:?}, towards {degrees} degrees:");
        for shut in [false, true] {
            if shut {
                doors.close(PortalId(1));
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
                let images = follow_reflections(method, &seen, 1, &doors, &mut scratch, [4, 0], subgraph);
                let images: Vec<u32> = images.iter().flat_map(|image| &image.cells).map(|cell| cell.0).collect();
                let state = if shut { "second door shut" } else { "all doors open" };
                println!("  {state:16}  {method:20} rooms {:?}, in the mirror {images:?}", seen.cells());
            }
        }
    }
    Ok(())
}
