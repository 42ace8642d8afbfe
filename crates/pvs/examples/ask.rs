//! Makes the table of four rooms by hand, writes it, reads it again, and queries it.
//!
//! ```text
//! +---+---+---+---+
//! | 0 | 1   2 | 3 |     The doors alternate between the lower and the upper wall, so that no line
//! |   |   |   |   |     passes through all three: only the first room and the last are hidden from
//! |     1 | 2     |     each other.
//! +---+---+---+---+
//! ```

use sightlines_pvs::{
    BitMatrix, CellId, CellRecord, Locator, ObjectId, ObjectRecord, Place, PortalRecord, Table, TableKind, TableParts,
};

fn room(i: u32) -> CellRecord {
    let (x0, x1) = (4.0 * f64::from(i), 4.0 * f64::from(i + 1));
    let polygon = vec![[x0, 0.0], [x1, 0.0], [x1, 4.0], [x0, 4.0]];
    CellRecord { min: [x0, 0.0, 0.0], max: [x1, 4.0, 0.0], group: None, polygon }
}

/// The door from room `i` to the next, in its east wall (side 1), from `y` to `y` + 1.
fn door(i: u32, y: f64) -> PortalRecord {
    let x = 4.0 * f64::from(i + 1);
    let (left, right) = ([x, y + 1.0, 0.0], [x, y, 0.0]);
    PortalRecord { cells: [CellId(i), CellId(i + 1)], sides: [1, 3], points: vec![left, right] }
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
        objects: vec![ObjectRecord { name: "lamp".to_owned(), min: [14.0, 1.0, 0.0], max: [15.0, 2.0, 0.0] }],
        cell_objects: vec![vec![], vec![], vec![], vec![ObjectId(0)]],
        info: vec![("source".to_owned(), "by hand".to_owned())],
        ..TableParts::empty(2, TableKind::Unspecified)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let bytes = Table::new(house())?.to_bytes();
    let table = Table::from_bytes(&bytes)?;
    println!("{} bytes, {} without portals and polygons", bytes.len(), table.strip_geometry().to_bytes().len());
    let query = table.in_dimension::<2>()?;
    for eye in [[1.0, 2.0], [9.0, 2.0], [4.0, 0.5], [1.0, 5.0]] {
        match query.at(eye) {
            Place::Outside => println!("at {eye:?}: outside every room, so everything is drawn"),
            Place::Inside(here) => {
                let rooms: Vec<u32> = here.visible_cells().map(|cell| cell.0).collect();
                let names = here.visible_objects().into_iter().map(|o| table.objects()[o.idx()].name.as_str());
                println!("at {eye:?}: in {:?}, sees rooms {rooms:?}, {:?}", here.cells(), names.collect::<Vec<_>>());
            }
        }
    }
    println!("{:.0} % of the pairs of rooms may see each other", 100.0 * table.mean_visible_share());
    Ok(())
}
