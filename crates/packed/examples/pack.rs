//! Packs a table, opens what was written, and follows a viewer through it.
//!
//! `pack IN.pvs OUT.pvz [MAX_BYTES]`; without arguments it packs a row of rooms and keeps it in memory.

use sightlines_packed::{ByteSource, PackOptions, Packed, pack_report};
use sightlines_pvs::{BitMatrix, CellId, CellRecord, Locator, Place, PlaceBuffer, Table, TableKind, TableParts};
use std::error::Error;

/// `n` rooms in a row, each of which sees up to `reach` rooms to both sides.
fn rooms(n: usize, reach: usize) -> Result<Table, Box<dyn Error>> {
    let mut parts = TableParts::empty(2, TableKind::Unspecified);
    for i in 0..n {
        let x = i as f64;
        parts.cells.push(CellRecord { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 0.0], group: None, polygon: vec![] });
    }
    parts.rows = BitMatrix::new(n, n);
    for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a.abs_diff(*b) <= reach) {
        parts.rows.set(a, b, true);
    }
    parts.locator = Locator::build(&parts.cell_bounds(), 2);
    parts.cell_objects = vec![vec![]; n];
    Ok(Table::new(parts)?)
}

/// Walks from cell to cell and looks up what each sees.
fn walk<S: ByteSource>(packed: &Packed<S>) -> Result<(), Box<dyn Error>> {
    let (mut buffer, mut seen, mut at_once) = (PlaceBuffer::new(), Vec::new(), Vec::new());
    let n = packed.n_cells();
    for cell in (0..n).step_by(1 + n / 8) {
        let (min, max) = packed.cell_box(CellId(cell as u32))?;
        let eye = std::array::from_fn(|k| f64::midpoint(min[k], max[k]));
        // Outside every cell nothing is known; the middle of a cell is inside.
        let Place::Inside(here) = packed.cells_at(eye, &mut buffer)? else { continue };
        for &cell in here {
            packed.coarse(cell, &mut at_once)?;
            packed.visible(cell, &mut seen)?;
            println!("in cell {cell}: {} cells are seen ({} by the coarse table)", seen.len(), at_once.len());
        }
    }
    println!("{} bytes of blocks kept, {:?}", packed.bytes_in_use(), packed.stats());
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let max_bytes = words.get(2).map(|n| n.parse()).transpose()?;
    let table = match words.first() {
        Some(path) => Table::from_bytes(&std::fs::read(path)?)?,
        None => rooms(1000, 20)?,
    };
    let (bytes, report) = pack_report(&table, &PackOptions { max_bytes, class: None })?;
    println!(
        "{} bytes as a plain table, {} packed, {} of them rows",
        table.to_bytes().len(),
        report.bytes,
        report.row_bytes
    );
    println!("{} different rows, {} merges", report.n_classes, report.n_merges);
    match words.get(1) {
        Some(path) => {
            std::fs::write(path, bytes)?;
            walk(&Packed::open(std::fs::File::open(path)?, 1 << 20)?)
        }
        None => walk(&Packed::open(bytes, 1 << 20)?),
    }
}
