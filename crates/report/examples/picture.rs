//! Draws three rooms in a row and what the middle one sees.
//!
//! Run as `cargo run -p sightlines-report --example picture > picture.svg`.

use sightlines_pvs::{BitMatrix, CellId, CellRecord, Locator, PortalRecord, Table, TableKind, TableParts};
use sightlines_report::{DrawOptions, PictureSubject, plan_svg};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let room = |x: f64| CellRecord { min: [x, 0.0, 0.0], max: [x + 4.0, 3.0, 0.0], group: None, polygon: vec![] };
    let door = |i: u32, x: f64, y: f64| PortalRecord {
        cells: [CellId(i), CellId(i + 1)],
        sides: [1, 3],
        points: vec![[x, y + 1.0, 0.0], [x, y, 0.0]],
    };
    let cells = vec![room(0.0), room(4.0), room(8.0)];
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    // From one door to the other a line passes, so every room sees every other.
    let mut rows = BitMatrix::identity(3);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        rows.set(a, b, true);
        rows.set(b, a, true);
    }
    let table = Table::new(TableParts {
        locator: Locator::build(&bounds, 2),
        rows,
        cells,
        portals: vec![door(0, 4.0, 0.5), door(1, 8.0, 1.5)],
        cell_objects: vec![vec![]; 3],
        ..TableParts::empty(2, TableKind::Unspecified)
    })?;
    print!("{}", plan_svg(&table, &DrawOptions { view: PictureSubject::Cell(CellId(1)), ..DrawOptions::default() })?);
    Ok(())
}
