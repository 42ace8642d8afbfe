//! Rooms: sets of cells that portals join, directly or by way of others.

use crate::tree::AxialTree;
use crate::union_find::UnionFind;

/// The rooms of a tree: its cells, grouped by the portals that join them.
#[derive(Debug)]
pub(crate) struct Rooms {
    /// The room of each cell.
    pub(crate) of_cell: Vec<u32>,
    /// The cells of each room, ascending.
    pub(crate) cells: Vec<Vec<u32>>,
}

impl Rooms {
    pub(crate) fn of(tree: &AxialTree<3>) -> Self {
        let mut union = UnionFind::new(tree.cells().len());
        for portal in tree.portals() {
            let [a, b] = portal.cells;
            union.join(a.0, b.0);
        }
        let (mut of_cell, mut cells) = (Vec::new(), Vec::<Vec<u32>>::new());
        for cell in 0..tree.cells().len() as u32 {
            // The least cell of a room represents it, so its number exists before the other cells look it up.
            let root = union.root(cell);
            let room = if root == cell { cells.len() as u32 } else { of_cell[root as usize] };
            if root == cell {
                cells.push(Vec::new());
            }
            of_cell.push(room);
            cells[room as usize].push(cell);
        }
        Self { of_cell, cells }
    }

    /// Whether the room of each index has a cell that fulfils `holds`.
    pub(crate) fn any(&self, mut holds: impl FnMut(u32) -> bool) -> Vec<bool> {
        self.cells.iter().map(|cells| cells.iter().any(|&c| holds(c))).collect()
    }
}
