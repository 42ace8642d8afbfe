//! Cells from which a picture of what is seen tells something.

use sightlines_pvs::{CellId, Table};

/// The larger half of the cells of a plan's table, by the floor that they see, ascending. O(pairs of cells that see each other).
pub fn cells_by_seen_floor(table: &Table) -> Vec<CellId> {
    let area = |cell: &CellId| {
        let record = &table.cells()[cell.idx()];
        (record.max[0] - record.min[0]) * (record.max[1] - record.min[1])
    };
    let mut cells: Vec<CellId> = (0u32..).take(table.n_cells()).map(CellId).collect();
    cells.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
    cells.truncate(cells.len().div_ceil(2));
    let mut ranked: Vec<(f64, CellId)> =
        cells.into_iter().map(|cell| (table.visible(cell).map(|seen| area(&seen)).sum(), cell)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, cell)| cell).collect()
}

/// The largest cell of a table in space that sees less than half of all cells, or else the largest; `None` in a table without cells. O(pairs of
/// cells that see each other).
pub fn secluded_cell(table: &Table) -> Option<CellId> {
    let volume = |cell: CellId| {
        let record = &table.cells()[cell.idx()];
        (0..3).map(|k| record.max[k] - record.min[k]).product::<f64>()
    };
    let sees_little = |cell: &CellId| 2 * table.visible(*cell).count() < table.n_cells();
    let larger = |a: &CellId, b: &CellId| volume(*a).total_cmp(&volume(*b)).then(b.cmp(a));
    let cells = || (0u32..).take(table.n_cells()).map(CellId);
    cells().filter(sees_little).max_by(larger).or_else(|| cells().max_by(larger))
}
