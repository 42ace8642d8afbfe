//! Cells and gates as numbers: who leads where. No shapes.

/// A portal and the direction in which it is crossed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Gate {
    /// The cell before it, and the one behind.
    pub(crate) cells: [u32; 2],
    /// The side by which the first cell is left, and the one by which the second is entered.
    pub(crate) sides: [u32; 2],
}

/// All gates: of portal `p` those with the numbers `2p` (from its first cell into its second) and `2p + 1`.
#[derive(Debug, Clone)]
pub(crate) struct Gates {
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

    /// Where a cell's exits are among all.
    pub(crate) fn exit_range(&self, cell: u32) -> std::ops::Range<usize> {
        self.first_exit[cell as usize] as usize..self.first_exit[cell as usize + 1] as usize
    }

    /// An exit by its place among all.
    pub(crate) fn exit(&self, place: usize) -> u32 {
        self.exits[place]
    }
}
