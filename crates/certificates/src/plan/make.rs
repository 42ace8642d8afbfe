//! Makes proofs of plans.

use super::{PlanBlock, PlanNetwork, PlanProofs, PlanWalk};
use crate::walk::{ChainSolver, Maker};

/// Collects proofs of a plan.
pub type PlanMaker<'a> = Maker<'a, PlanNetwork>;

impl PlanMaker<'_> {
    /// Proves a cell hidden from all cells about which nothing is proven yet. Returns whether that was possible within
    /// `most_steps` gates.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn prove_hidden(
        &mut self,
        source: u32,
        solver: &mut impl ChainSolver<Block = PlanBlock>,
        most_steps: u64,
    ) -> bool {
        self.prove(source, &[], solver, most_steps, |decisions| PlanWalk { source, decisions })
    }

    /// The proofs.
    pub fn finish(self) -> PlanProofs {
        let (checksum, unproven) = (self.network.checksum(), self.unproven());
        PlanProofs { checksum, lines: self.lines, unproven, walks: self.walks }
    }
}
