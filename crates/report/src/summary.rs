//! What a table holds, in a few numbers.

use crate::outline::corners;
use crate::words::{count, percent};
use serde::Serialize;
use sightlines_geometry::signed_area;
use sightlines_pvs::{CellId, CellRecord, Table};
use std::fmt;

/// The numbers of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Summary {
    /// 2 for a plane, 3 for space.
    pub dimension: u8,
    /// Number of cells.
    pub n_cells: usize,
    /// Whether the cells have names.
    pub has_cell_names: bool,
    /// Number of portals.
    pub n_portals: usize,
    /// Number of objects.
    pub n_objects: usize,
    /// Number of parts of objects that were cut, if any was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub n_parts: Option<usize>,
    /// Number of different groups (Doom sectors) that cells belong to.
    pub n_groups: usize,
    /// Unordered pairs of different cells that may see each other.
    pub n_visible_pairs: u64,
    /// The most cells that one cell sees, itself included.
    pub most_visible: u64,
    /// `n_visible_pairs` as a share of all unordered pairs of different cells, from 0 to 1.
    pub visible_share: f64,
    /// The share of the floor (in space: of the volume) that a viewer has to draw, averaged over the
    /// places where a viewer may stand, from 0 to 1: each cell counts by its size, as viewer and as viewed.
    #[cfg_attr(feature = "schemars", schemars(with = "Option<f64>"))]
    pub mean_floor_share: f64,
    /// The floor in square scene units (in space: the volume of all cells).
    pub floor: f64,
    /// Bytes of the table as a file.
    pub n_bytes: usize,
}

impl Summary {
    /// Counts. O(pairs of cells that see each other), and the table is written to memory once.
    pub fn of(table: &Table) -> Self {
        let n_cells = table.n_cells();
        let ids = || (0u32..).take(n_cells).map(CellId);
        let ones = |cell: CellId| table.row(cell).iter().map(|w| u64::from(w.count_ones())).sum::<u64>();
        let sizes: Vec<f64> = table.cells().iter().map(|cell| size(cell, table.dimension())).collect();
        let floor: f64 = sizes.iter().sum();
        // Shares instead of sizes, so that no product of large floors overflows.
        let share = |cell: CellId| if floor > 0.0 { sizes[cell.idx()] / floor } else { 0.0 };
        let drawn = |cell: CellId| table.visible(cell).map(share).sum::<f64>();
        let mut groups: Vec<u32> = table.cells().iter().filter_map(|cell| cell.group).collect();
        groups.sort_unstable();
        groups.dedup();
        Self {
            dimension: table.dimension(),
            n_cells,
            has_cell_names: table.has_cell_names(),
            n_portals: table.portals().len(),
            n_objects: table.objects().len(),
            n_parts: Some(table.object_parts().len()).filter(|&n| n > 0),
            n_groups: groups.len(),
            n_visible_pairs: (ids().map(ones).sum::<u64>() - n_cells as u64) / 2,
            most_visible: ids().map(ones).max().unwrap_or(0),
            visible_share: table.mean_visible_share(),
            mean_floor_share: ids().map(|cell| share(cell) * drawn(cell)).sum(),
            floor,
            n_bytes: table.to_bytes().len(),
        }
    }
}

/// Cells, portals, visible pairs, and what has to be drawn, unless the share of the floor is not known, and so no number.
impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let groups =
            if self.n_groups > 0 { format!(", in {}", count(self.n_groups as u64, "group")) } else { String::new() };
        let names = if self.has_cell_names { ", with names" } else { "" };
        writeln!(f, "cells          {}{groups}{names}", self.n_cells)?;
        writeln!(f, "portals        {}", self.n_portals)?;
        if self.n_objects > 0 {
            let parts = self.n_parts.map_or(String::new(), |n| format!(", the large ones in {n} parts"));
            writeln!(f, "objects        {}{parts}", self.n_objects)?;
        }
        let all = self.n_cells as u64 * (self.n_cells as u64).saturating_sub(1) / 2;
        writeln!(f, "visible pairs  {} of {all}, {}", self.n_visible_pairs, percent(self.visible_share))?;
        if self.mean_floor_share.is_nan() {
            return Ok(());
        }
        let what = if self.dimension == 2 { "floor" } else { "volume" };
        writeln!(f, "to draw        {} of the {what} on average", percent(self.mean_floor_share))
    }
}

/// Area of a planar cell, volume of one in space; rounded.
pub(crate) fn size(cell: &CellRecord, dimension: u8) -> f64 {
    if dimension == 2 {
        return signed_area(&corners(cell));
    }
    (0..3).map(|k| cell.max[k] - cell.min[k]).product()
}
