//! What the table shows, and what of that was confirmed.

use crate::counts::Confirmed;
use crate::findings::Findings;
use crate::sight::Target;
use sightlines_pvs::{BitMatrix, CellId, Table};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What the table shows, as bits.
#[derive(Debug)]
pub(super) struct Seen {
    cells: BitMatrix,
    objects: BitMatrix,
}

impl Seen {
    pub(super) fn of(table: &Table) -> Self {
        let mut objects = BitMatrix::new(table.n_cells(), table.objects().len());
        for cell in 0..table.n_cells() {
            for object in table.visible_objects(CellId(cell as u32)) {
                objects.set(cell, object.idx(), true);
            }
        }
        Self { cells: table.parts().rows.clone(), objects }
    }

    pub(super) fn n_cells(&self) -> usize {
        self.cells.n_rows()
    }

    pub(super) fn has(&self, from: CellId, target: Target) -> bool {
        match target {
            Target::Cell(to) => self.cells.get(from.idx(), to.idx()),
            Target::Object(object) => self.objects.get(from.idx(), object as usize),
        }
    }
}

/// Which pairs were confirmed. Threads set bits in any order, so the sum is always the same.
#[derive(Debug)]
pub(super) struct Tally {
    cells: Bits,
    objects: Bits,
}

#[derive(Debug)]
struct Bits {
    n_cols: usize,
    words: Vec<AtomicU64>,
}

impl Bits {
    fn new(n_rows: usize, n_cols: usize) -> Self {
        let n_words = (n_rows * n_cols).div_ceil(64);
        Self { n_cols, words: (0..n_words).map(|_| AtomicU64::new(0)).collect() }
    }

    fn place(&self, row: usize, col: usize) -> (usize, u64) {
        let bit = row * self.n_cols + col;
        (bit / 64, 1 << (bit % 64))
    }

    fn get(&self, row: usize, col: usize) -> bool {
        let (word, bit) = self.place(row, col);
        self.words[word].load(Relaxed) & bit != 0
    }

    fn set(&self, row: usize, col: usize) {
        let (word, bit) = self.place(row, col);
        self.words[word].fetch_or(bit, Relaxed);
    }

    fn count(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.load(Relaxed).count_ones())).sum()
    }
}

impl Tally {
    pub(super) fn new(table: &Table) -> Self {
        let n = table.n_cells();
        Self { cells: Bits::new(n, n), objects: Bits::new(n, table.objects().len()) }
    }

    pub(super) fn has(&self, from: CellId, target: Target) -> bool {
        match target {
            Target::Cell(to) => self.cells.get(from.idx(), to.idx()),
            Target::Object(object) => self.objects.get(from.idx(), object as usize),
        }
    }

    pub(super) fn confirm(&self, from: CellId, target: Target) {
        match target {
            Target::Cell(to) => self.cells.set(from.idx(), to.idx()),
            Target::Object(object) => self.objects.set(from.idx(), object as usize),
        }
    }

    /// Writes the counts.
    pub(super) fn write(&self, seen: &Seen, findings: &mut Findings) {
        let n = seen.cells.n_rows() as u64;
        let (pairs, visible) = (n * n.saturating_sub(1) / 2, (seen.cells.count_ones() - n) / 2);
        let aimed = findings.cells.aimed;
        findings.cells = Confirmed { visible, confirmed: self.cells.count(), hidden: pairs - visible, aimed };
        let (pairs, visible) = (n * seen.objects.n_cols() as u64, seen.objects.count_ones());
        let aimed = findings.objects.aimed;
        findings.objects = Confirmed { visible, confirmed: self.objects.count(), hidden: pairs - visible, aimed };
    }
}
