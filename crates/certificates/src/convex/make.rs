//! Makes proofs of maps.

use super::{ConvexBlock, ConvexNetwork, ConvexProofs, ConvexWalk};
use crate::walk::{ChainSolver, Maker};

/// Collects proofs of a map.
pub type ConvexMaker<'a> = Maker<'a, ConvexNetwork>;

impl ConvexMaker<'_> {
    /// Proves the cells `targets` (ascending) hidden from `source` or, if there are none, all about which nothing is proven
    /// yet. Returns whether that was possible within `most_steps` gates.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn prove_hidden(
        &mut self,
        source: u32,
        targets: &[u32],
        solver: &mut impl ChainSolver<Block = ConvexBlock>,
        most_steps: u64,
    ) -> bool {
        let walk = |decisions| ConvexWalk { source, targets: targets.to_vec(), decisions };
        self.prove(source, targets, solver, most_steps, walk)
    }

    /// The lines and walks that were taken since there were so many ([`Maker::n_taken`]), as bytes for [`Self::take_again`].
    pub fn taken_since(&self, n_taken: [usize; 2]) -> Vec<u8> {
        self.bytes_since(n_taken)
    }

    /// Takes what another maker had taken, when this one has taken the same before it. Each line and walk is checked again. Returns
    /// whether all were taken; if not, some may be, and the maker is of no more use.
    pub fn take_again(&mut self, bytes: &[u8]) -> bool {
        self.take_bytes(bytes, ConvexWalk::proof)
    }

    /// The proofs.
    pub fn finish(self) -> ConvexProofs {
        let (checksum, unproven) = (self.network.checksum(), self.unproven());
        ConvexProofs { checksum, lines: self.lines, unproven, walks: self.walks }
    }
}
