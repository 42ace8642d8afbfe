//! Which gates may follow which.

use super::follow::gate_of;
use sightlines_cells::{CellGraph, CellId, Space};
use sightlines_pvs::BitMatrix;

/// The graph along which trees grow.
pub(super) struct GateGraph<'a> {
    rows: &'a BitMatrix,
    /// The cell that each gate leads into, and the side of that cell.
    heads: Vec<(CellId, u32)>,
    /// The exits of each cell, cell by cell: side and gate.
    exits: Vec<(u32, u32)>,
    first_exit: Vec<u32>,
}

impl<'a> GateGraph<'a> {
    pub(super) fn new<C: Space>(graph: &CellGraph<C>, rows: &'a BitMatrix) -> Self {
        let heads = |p: &sightlines_cells::Portal<C>| [(p.cells[1], p.sides[1]), (p.cells[0], p.sides[0])];
        let first = |cell| graph.exit_range(cell).start as u32;
        Self {
            rows,
            heads: graph.portals().iter().flat_map(heads).collect(),
            exits: graph.all_exits().iter().map(|exit| (exit.side, gate_of(exit))).collect(),
            first_exit: graph.cell_ids().map(first).chain([graph.all_exits().len() as u32]).collect(),
        }
    }

    /// The cell that a gate leads into.
    pub(super) fn head(&self, gate: u32) -> CellId {
        self.heads[gate as usize].0
    }

    /// The cells that a gate leads out of and into; `None` if there is no such gate.
    pub(super) fn ends(&self, gate: u32) -> Option<[CellId; 2]> {
        let of = |gate: u32| self.heads.get(gate as usize).map(|head| head.0);
        Some([of(gate ^ 1)?, of(gate)?])
    }

    /// Gates that may follow: `met` are the cells so far, at least one, `entry` the gate into the last of them.
    ///
    /// A line meets a convex cell once and does not leave it by the side through which it entered; and every point on
    /// it sees all the cells that it meets, so each pair of them is in the rows. Neither rule loses a sequence that
    /// lines pass, if rows lose no visible pair.
    pub(super) fn onward(&self, met: &[CellId], entry: Option<u32>) -> impl Iterator<Item = u32> {
        let here = met[met.len() - 1].idx();
        let side = entry.map(|gate| self.heads[gate as usize].1);
        let exits = &self.exits[self.first_exit[here] as usize..self.first_exit[here + 1] as usize];
        exits.iter().filter(move |exit| side != Some(exit.0)).map(|exit| exit.1).filter(move |&gate| {
            let next = self.head(gate);
            met.iter().all(|cell| *cell != next && self.rows.get(next.idx(), cell.idx()))
        })
    }
}
