//! Makes proofs of plans.

use super::{PlanarBlock, PlanarNetwork, PlanarProofs, PlanarWalk};
use crate::walk::{ChainSolver, Maker};

/// Collects proofs of a plan.
pub type PlanarMaker<'a> = Maker<'a, PlanarNetwork>;

impl PlanarMaker<'_> {
    /// Proves a cell hidden from all cells about which nothing is proven yet. Returns whether that was possible within
    /// `most_steps` gates.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn prove_hidden(
        &mut self,
        source: u32,
        solver: &mut impl ChainSolver<Block = PlanarBlock>,
        most_steps: u64,
    ) -> bool {
        self.prove(source, &[], solver, most_steps, |decisions| PlanarWalk { source, decisions })
    }

    /// The lines and walks that were taken since there were so many ([`Maker::n_taken`]), as bytes for [`Self::take_again`].
    pub fn taken_since(&self, n_taken: [usize; 2]) -> Vec<u8> {
        self.bytes_since(n_taken)
    }

    /// Takes what another maker had taken, when this one has taken the same before it. Each line and walk is checked again. Returns
    /// whether all were taken; if not, some may be, and the maker is of no more use.
    pub fn take_again(&mut self, bytes: &[u8]) -> bool {
        self.take_bytes(bytes, PlanarWalk::proof)
    }

    /// The proofs.
    pub fn finish(self) -> PlanarProofs {
        let (checksum, unproven) = (self.network.checksum(), self.unproven());
        PlanarProofs { checksum, lines: self.lines, unproven, walks: self.walks }
    }
}
