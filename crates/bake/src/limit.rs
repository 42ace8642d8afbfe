//! What a bake has not decided because its budget was spent.

use crate::stated::TIME_LIMIT;
use sightlines_pvs::{BitMatrix, TableParts};
use sightlines_stabtree::PairMask;
use std::fmt;

/// What was not decided because the budget was spent. The table is right all the same, and looser: such pairs count as visible.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(description = "Pairs that were not decided in time."))]
pub struct LimitReport {
    /// Cells about which everything was decided.
    pub n_cells_decided: usize,
    /// Cells about which something was decided.
    pub n_cells_in_part: usize,
    /// Cells about which nothing was decided.
    pub n_cells_undecided: usize,
    // An upper bound, where a from-region method was stopped: it includes pairs that the method would have left visible.
    /// Pairs of cells that count as visible for that reason, at most.
    pub n_cell_pairs: u64,
    /// Pairs of a cell and an object, or a part of one, that count as visible for that reason, at most.
    pub n_object_pairs: u64,
}

/// What was not decided about one cell.
pub(crate) struct LeftOfCell {
    /// Other cells.
    pub(crate) n_cells: usize,
    pub(crate) n_objects: usize,
    /// Whether no object is hidden. Objects that no cell sees are not drawn, or out of reach, which needs no decision.
    pub(crate) sees_all: bool,
}

impl LimitReport {
    /// Counts what was left. `objects`: cells by objects, what is visible.
    pub(crate) fn of(left: &PairMask, objects: &BitMatrix) -> Self {
        let n = left.boxes.n_rows();
        let mut seen_anywhere = vec![0u64; objects.n_cols().div_ceil(64)];
        for cell in 0..n {
            seen_anywhere.iter_mut().zip(objects.row(cell)).for_each(|(all, word)| *all |= word);
        }
        let of_cell = |cell: usize| LeftOfCell {
            n_cells: left.boxes.iter_ones(cell).filter(|&other| other != cell).count(),
            n_objects: left.objects.iter_ones(cell).count(),
            sees_all: objects.row(cell).iter().zip(&seen_anywhere).all(|(word, all)| word == all),
        };
        Self::counted(n, (0..n).map(of_cell))
    }

    /// Counts what was left of each of `n` cells.
    pub(crate) fn counted(n: usize, cells: impl Iterator<Item = LeftOfCell>) -> Self {
        let mut report = Self::default();
        for LeftOfCell { n_cells, n_objects, sees_all } in cells {
            *if n_cells + n_objects == 0 {
                &mut report.n_cells_decided
            } else if n_cells + 1 == n && sees_all {
                &mut report.n_cells_undecided
            } else {
                &mut report.n_cells_in_part
            } += 1;
            report.n_cell_pairs += n_cells as u64;
            report.n_object_pairs += n_objects as u64;
        }
        report.n_cell_pairs /= 2;
        report
    }

    /// With so many pairs of a cell and a part of an object that were not decided, of all cells.
    pub(crate) fn with_parts(&mut self, n_cells: usize, n_pairs: u64) -> &Self {
        (self.n_cells_decided, self.n_cells_in_part) = (0, n_cells - self.n_cells_undecided);
        self.n_object_pairs += n_pairs;
        self
    }

    /// Whether the table is looser than it would be without a limit.
    pub(crate) const fn is_any(&self) -> bool {
        self.n_cells_in_part + self.n_cells_undecided > 0
    }
}

impl fmt::Display for LimitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let decided = count(self.n_cells_decided as u64, "cell");
        let cells = count(self.n_cell_pairs, "pair");
        let (part, none, objects) = (self.n_cells_in_part, self.n_cells_undecided, self.n_object_pairs);
        write!(f, "{decided} decided in full, {part} in part, {none} not at all; ")?;
        write!(f, "{cells} of cells and {objects} of a cell and an object assumed visible")
    }
}

/// A number with its noun, in the plural unless it is one.
fn count(n: u64, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// Lets the table state what was not decided.
pub(crate) fn state_limit(parts: &mut TableParts, limit: &LimitReport) {
    parts.info.push((TIME_LIMIT.to_owned(), limit.to_string()));
    parts.info.sort();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_no_plural() {
        let report = |n: u64| {
            let n_cells = n as usize;
            let left =
                LimitReport { n_cells_decided: n_cells, n_cell_pairs: n, n_object_pairs: n, ..Default::default() };
            left.to_string()
        };
        let text = "1 cell decided in full, 0 in part, 0 not at all; 1 pair of cells and 1 of a cell and an object assumed visible";
        assert_eq!(report(1), text);
        assert!(report(2).starts_with("2 cells decided") && report(2).contains("; 2 pairs of cells and 2 of"));
        assert!(report(0).contains("; 0 pairs of cells and 0 of"));
    }
}
