//! Cells and gates as numbers: which gate leads where. No shapes.

/// A portal and the direction in which it is crossed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Gate {
    /// The cell before it, and the one behind.
    pub(crate) cells: [u32; 2],
    /// The side by which the first cell is left, and the one by which the second is entered.
    pub(crate) sides: [u32; 2],
}

/// All gates. Portal `p` has the gates `2p` (from its first cell into its second) and `2p + 1`.
#[derive(Debug, Clone)]
pub struct Gates {
    gates: Vec<Gate>,
    first_exit: Vec<u32>,
    exits: Vec<u32>,
}

impl Gates {
    /// The gates of portals, given by their cells and sides; all cells are below `n_cells`, and numbers of gates below 2^31.
    pub(crate) fn new(n_cells: usize, portals: impl Iterator<Item = ([u32; 2], [u32; 2])>) -> Self {
        let mut gates = Vec::new();
        for ([a, b], [s, t]) in portals {
            gates.push(Gate { cells: [a, b], sides: [s, t] });
            gates.push(Gate { cells: [b, a], sides: [t, s] });
        }
        let mut exits: Vec<u32> = (0..gates.len() as u32).collect();
        exits.sort_by_key(|&g| (gates[g as usize].cells[0], gates[g as usize].sides[0], g));
        let mut first_exit = vec![0u32; n_cells + 1];
        gates.iter().for_each(|gate| first_exit[gate.cells[0] as usize + 1] += 1);
        for cell in 0..n_cells {
            first_exit[cell + 1] += first_exit[cell];
        }
        Self { gates, first_exit, exits }
    }

    pub(crate) fn len(&self) -> usize {
        self.gates.len()
    }

    pub(crate) fn n_cells(&self) -> usize {
        self.first_exit.len() - 1
    }

    pub(crate) fn gate(&self, gate: u32) -> Gate {
        self.gates[gate as usize]
    }

    /// The gates out of a cell, by side, then by number.
    pub(crate) fn exits(&self, cell: u32) -> &[u32] {
        &self.exits[self.exit_range(cell)]
    }

    /// The range of a cell's exits among all exits.
    pub(crate) fn exit_range(&self, cell: u32) -> std::ops::Range<usize> {
        self.first_exit[cell as usize] as usize..self.first_exit[cell as usize + 1] as usize
    }

    /// An exit by its place among all exits.
    pub(crate) fn exit(&self, place: usize) -> u32 {
        self.exits[place]
    }

    /// The cells that a line passes, in order, followed both ways from one of them; empty if the line crosses no gate of that
    /// cell. For convex cells only. `crosses` decides whether the line crosses a gate, followed backwards or not.
    pub(crate) fn follow(&self, cell: u32, crosses: impl Fn(u32, bool) -> bool) -> Vec<u32> {
        let mut cells = Vec::new();
        self.follow_one_way(cell, |gate| crosses(gate, true), &mut cells);
        cells.reverse();
        cells.push(cell);
        self.follow_one_way(cell, |gate| crosses(gate, false), &mut cells);
        if cells.len() > 1 { cells } else { Vec::new() }
    }

    fn follow_one_way(&self, from: u32, crosses: impl Fn(u32) -> bool, cells: &mut Vec<u32>) {
        let (mut cell, mut entry_side) = (from, None);
        // A line passes each convex cell once.
        for _ in 0..self.n_cells() {
            let leaves = |gate: &&u32| Some(self.gate(**gate).sides[0]) != entry_side && crosses(**gate);
            let Some(&gate) = self.exits(cell).iter().find(leaves) else { return };
            let gate = self.gate(gate);
            (cell, entry_side) = (gate.cells[1], Some(gate.sides[1]));
            cells.push(cell);
        }
    }
}
