//! Proofs of tables of plans.
//!
//! *Visible* pairs are proven by lines, each followed exactly through the portals that it crosses: all cells on it see
//! each other. *Hidden* pairs are proven by walks, one from each cell, through all chains of gates that could lead from
//! it to a cell that it does not see. Where a chain ends, at most four ends of gates that no line separates are the
//! reason. Pairs that neither kind proves are left *open*, and reported.

mod block;
mod bytes;
mod front;
mod line;
mod make;
mod network;

pub use block::PlanarBlock;
pub use line::{LineForm, PlanLine, Point};
pub use make::PlanarMaker;
pub use network::{NetworkError, PlanarNetwork, PlanarPortal};

use crate::graph::Gates;
use crate::proven::{Proven, Refusal};
use crate::walk::{Decisions, Network, WalkProof, check};
use front::Front;

/// The walk from one cell to all cells that it does not see.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanarWalk {
    /// The cell.
    pub source: u32,
    /// Which chains end, and why.
    pub decisions: Decisions<PlanarBlock>,
}

impl PlanarWalk {
    /// A walk from a cell, with its [`Decisions::new`].
    pub fn new(source: u32, open: &[bool], blocks: Vec<PlanarBlock>) -> Self {
        Self { source, decisions: Decisions::new(open, blocks) }
    }

    fn proof(&self) -> WalkProof<'_, PlanarBlock> {
        WalkProof { source: self.source, targets: &[], decisions: &self.decisions }
    }
}

/// Proofs of a table of a plan.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanarProofs {
    /// [`PlanarNetwork::checksum`] of the cells and portals.
    pub checksum: u32,
    /// Lines that prove pairs visible.
    pub lines: Vec<PlanLine>,
    /// Pairs of different cells that no line proves visible and no walk has to prove hidden; ascending, lower number
    /// first.
    pub unproven: Vec<[u32; 2]>,
    /// Walks that prove pairs hidden: of each source, all that are not proven before.
    pub walks: Vec<PlanarWalk>,
}

impl PlanarProofs {
    /// Checks every proof, and returns what they prove together. Exact.
    ///
    /// Cost: some orientations for each gate of a line and each end of a chain, and the walks, which take time in proportion
    /// to their decisions times the exits of a cell. Memory: a few bits for each pair of cells.
    ///
    /// # Errors
    /// [`Refusal`] for proofs of another network, and for the first proof that does not hold.
    pub fn check(&self, network: &PlanarNetwork) -> Result<Proven, Refusal> {
        if self.checksum != network.checksum() {
            return Err(Refusal::OtherTable);
        }
        check(network, &self.lines, &self.unproven, self.walks.iter().map(PlanarWalk::proof))
    }
}

impl Network for PlanarNetwork {
    type Line = PlanLine;
    type Block = PlanarBlock;
    type Walk = PlanarWalk;
    type Fronts<'a> = Front<'a>;

    fn gates(&self) -> &Gates {
        &self.gates
    }

    fn fronts(&self) -> Front<'_> {
        Front::new(self)
    }

    fn cells_along(&self, line: &PlanLine) -> Vec<u32> {
        self.follow(line)
    }

    fn line_refusal(index: usize, line: &PlanLine) -> Refusal {
        Refusal::Line { index, cell: line.cell }
    }

    fn blocked_gates(&self, block: &PlanarBlock, chain: &[u32], gate: u32) -> Option<Vec<u32>> {
        block.gates(self, chain, gate)
    }
}
