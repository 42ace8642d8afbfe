//! Cells that are searched for together.

use sightlines_cells::{CellGraph, CellId, Planar, Space};
use std::collections::BTreeMap;

/// A partition of some of the cells of a graph into zones, numbered from 0.
///
/// A zone is a single cell in a search for every cell, or all cells with the same groups in a search for groups (Doom
/// sectors). Lines pass through cells without a zone, which are neither source nor target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Zones {
    of_cell: Vec<u32>,
    n_zones: usize,
}

impl Zones {
    /// Marks a cell without a zone.
    const NONE: u32 = u32::MAX;

    /// Every cell is a zone, with its own number.
    pub fn cells<S: Space>(graph: &CellGraph<S>) -> Self {
        Self { of_cell: graph.cell_ids().map(|c| c.0).collect(), n_zones: graph.n_cells() }
    }

    /// Cells with the same set of groups make a zone. Also returns the groups of each zone; zones are numbered in the
    /// order of their groups.
    pub fn by_groups(graph: &CellGraph<Planar>) -> (Self, Vec<Vec<u32>>) {
        let mut numbers: BTreeMap<&[u32], u32> = BTreeMap::new();
        for cell in graph.cells().iter().filter(|c| !c.groups.is_empty()) {
            numbers.entry(&cell.groups).or_default();
        }
        for (number, zone) in (0u32..).zip(numbers.values_mut()) {
            *zone = number;
        }
        let of_cell = graph.cells().iter().map(|c| numbers.get(&c.groups[..]).copied().unwrap_or(Self::NONE));
        let zones = Self { of_cell: of_cell.collect(), n_zones: numbers.len() };
        (zones, numbers.into_keys().map(<[u32]>::to_vec).collect())
    }

    /// Number of zones.
    pub fn n_zones(&self) -> usize {
        self.n_zones
    }

    /// The zone of a cell, if it has one.
    pub fn of(&self, cell: CellId) -> Option<u32> {
        Some(self.of_cell[cell.idx()]).filter(|&z| z != Self::NONE)
    }
}
