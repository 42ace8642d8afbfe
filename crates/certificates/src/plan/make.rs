//! Makes proofs of plans with the help of a solver for single chains.

use super::front::Front;
use super::{PlanBlock, PlanLine, PlanNetwork, PlanProofs, PlanWalk, candidates};
use crate::pairs::Pairs;
use crate::walk::{Crossing, Director, Walk};

/// What a guide says at a gate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlanStep {
    /// Some open set of lines may pass the chain and the gate.
    Open,
    /// None does, and this is why.
    Blocked(PlanBlock),
    /// The walk has become too long, or the reason was not found: nothing is proven of this cell.
    GiveUp,
}

/// A solver that decides whether chains of gates are blocked. Its answers are checked, so it may be wrong.
pub trait PlanGuide {
    /// A chain begins with this gate.
    fn start(&mut self, gate: u32);

    /// The chain comes to a gate. After [`PlanStep::Open`] the gate is part of the chain.
    fn cross(&mut self, chain: &[u32], gate: u32) -> PlanStep;

    /// The last gate is taken off the chain.
    fn back(&mut self);
}

/// Collects proofs: lines first, then walks.
pub struct PlanMaker<'a> {
    network: &'a PlanNetwork,
    proofs: PlanProofs,
    visible: Pairs,
    unproven: Pairs,
    walk: Walk<'a, Front<'a>>,
}

impl std::fmt::Debug for PlanMaker<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PlanMaker").field("n_lines", &self.proofs.lines.len()).finish_non_exhaustive()
    }
}

impl<'a> PlanMaker<'a> {
    /// No proofs yet. Memory: a few bits for each pair of cells.
    pub fn new(network: &'a PlanNetwork) -> Self {
        let n = network.n_cells();
        Self {
            network,
            proofs: PlanProofs { checksum: network.checksum(), ..PlanProofs::default() },
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
    pub fn take_line(&mut self, line: PlanLine, at_least: usize) -> bool {
        let cells = self.network.follow(&line);
        let pairs = cells.iter().enumerate().flat_map(|(i, &a)| cells[..i].iter().map(move |&b| [a, b]));
        let n_new = pairs.filter(|&[a, b]| !self.visible.has(a, b)).count();
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

    /// Proves that a cell sees none of those of which nothing is proven yet; whether that was possible. `most_steps`:
    /// gates looked at after which it is given up.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn prove_hidden(&mut self, source: u32, guide: &mut impl PlanGuide, most_steps: u64) -> bool {
        let candidates = candidates(source, [&self.visible, &self.unproven, self.walk.hidden()]);
        if candidates.iter().all(|word| *word == 0) {
            return true;
        }
        let own = PlanWalk { source, ..PlanWalk::default() };
        let mut director = Guided { network: self.network, guide, walk: own };
        let is_proven = self.walk.prove(source, &candidates, &mut director, most_steps).is_ok();
        if is_proven {
            self.proofs.walks.push(director.walk);
        }
        is_proven
    }

    /// The proofs.
    pub fn finish(self) -> PlanProofs {
        PlanProofs { unproven: self.unproven.iter().collect(), ..self.proofs }
    }
}

/// Asks a guide, checks what it says, and writes it down.
struct Guided<'a, G> {
    network: &'a PlanNetwork,
    guide: &'a mut G,
    walk: PlanWalk,
}

impl<G: PlanGuide> Director for Guided<'_, G> {
    type Stop = ();

    fn start(&mut self, gate: u32) {
        self.guide.start(gate);
    }

    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, ()> {
        match self.guide.cross(chain, gate) {
            PlanStep::Open => {
                self.walk.open.push(true);
                Ok(Crossing::Open)
            }
            PlanStep::Blocked(block) => {
                let gates = block.gates(self.network, chain, gate).ok_or(())?;
                self.walk.open.push(false);
                self.walk.blocks.push(block);
                Ok(Crossing::Blocked(gates))
            }
            PlanStep::GiveUp => Err(()),
        }
    }

    fn back(&mut self) {
        self.guide.back();
    }
}
