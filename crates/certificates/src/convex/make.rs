//! Makes proofs of maps with the help of a solver for single chains.

use super::front::Front;
use super::{ConvexBlock, ConvexLine, ConvexNetwork, ConvexProofs, ConvexWalk, candidates};
use crate::pairs::{Pairs, ones};
use crate::walk::{Crossing, Director, Walk};

/// What a guide says at a gate.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvexStep {
    /// Some open set of lines may pass the chain and the gate, or it is not known.
    Open,
    /// None does, and this is why.
    Blocked(ConvexBlock),
    /// The walk has become too long: nothing is proven by it.
    GiveUp,
}

/// A solver that decides whether chains of gates are blocked. Its answers are checked, so it may be wrong.
pub trait ConvexGuide {
    /// A chain begins with this gate.
    fn start(&mut self, gate: u32);

    /// The chain comes to a gate. After [`ConvexStep::Open`] the gate is part of the chain.
    fn cross(&mut self, chain: &[u32], gate: u32) -> ConvexStep;

    /// The last gate is taken off the chain.
    fn back(&mut self);
}

/// Collects proofs: lines first, then walks.
pub struct ConvexMaker<'a> {
    network: &'a ConvexNetwork,
    proofs: ConvexProofs,
    visible: Pairs,
    unproven: Pairs,
    walk: Walk<'a, Front<'a>>,
}

impl std::fmt::Debug for ConvexMaker<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ConvexMaker").field("n_lines", &self.proofs.lines.len()).finish_non_exhaustive()
    }
}

impl<'a> ConvexMaker<'a> {
    /// No proofs yet. Memory: a few bits for each pair of cells and of gates, as walks need them.
    pub fn new(network: &'a ConvexNetwork) -> Self {
        let n = network.n_cells();
        Self {
            network,
            proofs: ConvexProofs { checksum: network.checksum(), ..ConvexProofs::default() },
            visible: Pairs::none(n),
            unproven: Pairs::none(n),
            walk: Walk::new(&network.gates, Front::new(network)),
        }
    }

    /// The pairs that the lines taken so far prove to be visible.
    pub fn visible(&self) -> &Pairs {
        &self.visible
    }

    /// Takes a line if it proves at least so many pairs, one or more, that no other did; whether it does.
    pub fn take_line(&mut self, line: ConvexLine, at_least: usize) -> bool {
        let cells = self.network.follow(&line);
        let pairs = cells.iter().enumerate().flat_map(|(i, &a)| cells[..i].iter().map(move |&b| [a, b]));
        let n_new = pairs.filter(|&[a, b]| a != b && !self.visible.has(a, b)).count();
        let is_new = n_new >= at_least.max(1);
        if is_new {
            self.visible.add_all(&cells);
            self.proofs.lines.push(line);
        }
        is_new
    }

    /// Says of two cells that nothing is to be proven about them, unless lines did. To be called before any walk.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn leave_open(&mut self, a: u32, b: u32) {
        if a != b && !self.visible.has(a, b) {
            self.unproven.add(a, b);
        }
    }

    /// The cells that a cell is still to be proven not to see: neither seen, nor left open, nor proven hidden. Ascending.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn left(&self, source: u32) -> Vec<u32> {
        ones(&candidates(source, &[], [&self.visible, &self.unproven, self.walk.hidden()])).collect()
    }

    /// Proves that a cell sees none of some cells (ascending), or if these are none, none of those of which nothing is proven yet;
    /// whether that was possible. `most_steps`: gates looked at after which it is given up.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn prove_hidden(
        &mut self,
        source: u32,
        targets: &[u32],
        guide: &mut impl ConvexGuide,
        most_steps: u64,
    ) -> bool {
        let candidates = candidates(source, targets, [&self.visible, &self.unproven, self.walk.hidden()]);
        if candidates.iter().all(|word| *word == 0) {
            return true;
        }
        let own = ConvexWalk { source, targets: targets.to_vec(), ..ConvexWalk::default() };
        let mut director = Guided { network: self.network, guide, walk: own };
        let is_proven = self.walk.prove(source, &candidates, &mut director, most_steps).is_ok();
        if is_proven {
            self.proofs.walks.push(director.walk);
        }
        is_proven
    }

    /// The proofs.
    pub fn finish(self) -> ConvexProofs {
        ConvexProofs { unproven: self.unproven.iter().collect(), ..self.proofs }
    }
}

/// Asks a guide, checks what it says, and writes it down.
struct Guided<'a, G> {
    network: &'a ConvexNetwork,
    guide: &'a mut G,
    walk: ConvexWalk,
}

impl<G: ConvexGuide> Director for Guided<'_, G> {
    type Stop = ();

    fn start(&mut self, gate: u32) {
        self.guide.start(gate);
    }

    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, ()> {
        match self.guide.cross(chain, gate) {
            ConvexStep::Open => {
                self.walk.open.push(true);
                Ok(Crossing::Open)
            }
            ConvexStep::Blocked(block) => {
                let gates = block.gates(self.network, chain, gate).ok_or(())?;
                self.walk.open.push(false);
                self.walk.blocks.push(block);
                Ok(Crossing::Blocked(gates))
            }
            ConvexStep::GiveUp => Err(()),
        }
    }

    fn back(&mut self) {
        self.guide.back();
    }
}
