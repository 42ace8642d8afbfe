//! Proofs of tables of maps: cells joined by convex polygons in space.
//!
//! *Visible* pairs are proven by lines, each followed exactly through the portals that it passes: all cells on it see
//! each other. *Hidden* pairs are proven by walks, one or more from each cell, through all chains of gates that could
//! lead from it to a cell that it does not see. Where a chain ends, a plane that separates three of its gates is the
//! reason, or sides of edges that cannot all be positive. Pairs that neither kind proves are left *open*, and reported.
//!
//! Cells are given by their portals alone, so proofs do not assume that cells are convex. [`ConvexNetwork`] lists what they
//! do assume.

mod block;
mod bytes;
mod front;
mod line;
mod make;
mod network;
mod vector;

pub use block::{ConvexBlock, ConvexCut, ConvexPlane, ConvexSums, ConvexTerm, ConvexTree};
pub use line::ConvexLine;
pub use make::ConvexMaker;
pub use network::{ConvexNetwork, ConvexNetworkError, ConvexPortal};
pub use vector::Point;

use crate::graph::Gates;
use crate::proven::{Proven, Refusal};
use crate::walk::{Decisions, Network, WalkProof, check};
use front::Front;

/// A walk from one cell to some or all cells that it does not see.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexWalk {
    /// The cell.
    pub source: u32,
    /// The cells to prove hidden from it, ascending; if there are none, all about which nothing is proven yet.
    pub targets: Vec<u32>,
    /// Which chains end, and why.
    pub decisions: Decisions<ConvexBlock>,
}

impl ConvexWalk {
    /// A walk from a cell, with its [`Decisions::new`].
    pub fn new(source: u32, targets: Vec<u32>, open: &[bool], blocks: Vec<ConvexBlock>) -> Self {
        Self { source, targets, decisions: Decisions::new(open, blocks) }
    }

    fn proof(&self) -> WalkProof<'_, ConvexBlock> {
        WalkProof { source: self.source, targets: &self.targets, decisions: &self.decisions }
    }
}

/// Proofs of a table of a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexProofs {
    /// [`ConvexNetwork::checksum`] of the cells and portals.
    pub checksum: u32,
    /// Lines that prove pairs visible.
    pub lines: Vec<ConvexLine>,
    /// Pairs of different cells that no line proves visible and no walk has to prove hidden; ascending, lower number
    /// first.
    pub unproven: Vec<[u32; 2]>,
    /// Walks that prove pairs hidden.
    pub walks: Vec<ConvexWalk>,
}

impl ConvexProofs {
    /// Checks every proof, and returns what they prove together. Exact.
    ///
    /// Cost: some determinants for each gate of a line and each corner that a reason names, and the walks, which take time in
    /// proportion to their decisions times the exits of a cell. Memory: a few bits for each pair of cells and of gates.
    ///
    /// # Errors
    /// [`Refusal`] for proofs of another network, and for the first proof that does not hold.
    pub fn check(&self, network: &ConvexNetwork) -> Result<Proven, Refusal> {
        if self.checksum != network.checksum() {
            return Err(Refusal::OtherTable);
        }
        check(network, &self.lines, &self.unproven, self.walks.iter().map(ConvexWalk::proof))
    }
}

impl Network for ConvexNetwork {
    type Line = ConvexLine;
    type Block = ConvexBlock;
    type Walk = ConvexWalk;
    type Fronts<'a> = Front<'a>;

    fn gates(&self) -> &Gates {
        &self.gates
    }

    fn fronts(&self) -> Front<'_> {
        Front::new(self)
    }

    fn cells_along(&self, line: &ConvexLine) -> Vec<u32> {
        self.follow(line)
    }

    fn line_refusal(index: usize, line: &ConvexLine) -> Refusal {
        Refusal::Gate { index, gate: line.gate }
    }

    fn blocked_gates(&self, block: &ConvexBlock, chain: &[u32], gate: u32) -> Option<Vec<u32>> {
        block.gates(self, chain, gate)
    }
}
