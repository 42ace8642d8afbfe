//! Writes a page of two rooms with a wall between them: `cargo run -p sightlines-viewer --example page > rooms.html`.

use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use sightlines_pvs::{BitMatrix, CellRecord, Locator, Table, TableKind, TableParts};
use sightlines_viewer::{Figure, Page};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let room = |x: f64| CellRecord { min: [x, 0.0, 0.0], max: [x + 4.0, 3.0, 0.0], group: None, polygon: vec![] };
    let cells = vec![room(0.0), room(4.0)];
    let bounds: Vec<_> = cells.iter().map(|cell| (cell.min, cell.max)).collect();
    let table = Table::new(TableParts {
        locator: Locator::build(&bounds, 2),
        rows: BitMatrix::identity(2),
        cells,
        cell_objects: vec![vec![]; 2],
        ..TableParts::empty(2, TableKind::Unspecified)
    })?;
    let corners = [[0.0, 0.0], [8.0, 0.0], [8.0, 3.0], [0.0, 3.0], [4.0, 0.0], [4.0, 3.0]];
    let corner = |k: usize| Point2::new(corners[k][0], corners[k][1]);
    let walls = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5]].map(|[a, b]| (corner(a), corner(b)));
    let figure = Figure::of_plan(&Plan::from_walls(walls)?);
    let page = Page { figure: Some(&figure), ..Page::new("Two rooms", "rooms.pvs", &table) }.html()?;
    print!("{}", page.html);
    Ok(())
}
