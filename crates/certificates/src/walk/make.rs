//! Makes proofs by lines and walks with the help of a solver for single chains.

use super::check::{WalkProof, candidates};
use super::decisions::Replay;
use super::{Crossing, Decisions, Director, Network, Walk};
use crate::bytes::{Coded, Reader, Writer};
use crate::pairs::{Pairs, ones};

/// The answer of a [`ChainSolver`] at a gate; `B` is a reason why a chain is blocked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChainStep<B> {
    /// Some open set of lines may pass the chain and the gate.
    Open,
    /// No open set of lines does, for this reason.
    Blocked(B),
    /// The walk has become too long, or no reason was found. The walk proves nothing.
    GiveUp,
}

/// A solver that decides whether chains of gates are blocked. Its answers are checked, so an error leaves pairs open.
pub trait ChainSolver {
    /// A reason why a chain is blocked.
    type Block;

    /// Starts a chain with this gate.
    fn start(&mut self, gate: u32);

    /// Decides about the next gate of the chain. After [`ChainStep::Open`] the gate is part of the chain.
    fn cross(&mut self, chain: &[u32], gate: u32) -> ChainStep<Self::Block>;

    /// Removes the last gate from the chain.
    fn back(&mut self);
}

/// Collects proofs about a network: lines first, then walks. What does not hold is not taken.
pub struct Maker<'a, N: Network> {
    pub(crate) network: &'a N,
    pub(crate) lines: Vec<N::Line>,
    pub(crate) walks: Vec<N::Walk>,
    visible: Pairs,
    unproven: Pairs,
    walk: Walk<'a, N::Fronts<'a>>,
}

impl<N: Network> std::fmt::Debug for Maker<'_, N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (n_lines, n_walks) = (self.lines.len(), self.walks.len());
        f.debug_struct("Maker").field("n_lines", &n_lines).field("n_walks", &n_walks).finish_non_exhaustive()
    }
}

impl<'a, N: Network> Maker<'a, N> {
    /// A maker without proofs. Memory: a few bits for each pair of cells and, for maps, of gates.
    pub fn new(network: &'a N) -> Self {
        let n = network.gates().n_cells();
        Self {
            network,
            lines: Vec::new(),
            walks: Vec::new(),
            visible: Pairs::none(n),
            unproven: Pairs::none(n),
            walk: Walk::new(network.gates(), network.fronts()),
        }
    }

    /// The pairs that the lines taken so far prove visible.
    pub fn visible(&self) -> &Pairs {
        &self.visible
    }

    /// Takes a line if it proves at least `at_least` pairs, and at least one, that no other line does. Returns whether it
    /// was taken.
    pub fn take_line(&mut self, line: N::Line, at_least: usize) -> bool {
        let is_taken = self.visible.add_all_if_new(&self.network.cells_along(&line), at_least);
        if is_taken {
            self.lines.push(line);
        }
        is_taken
    }

    /// Leaves a pair of cells open unless a line proves it visible. To be called before any walk.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn leave_open(&mut self, a: u32, b: u32) {
        if a != b && !self.visible.has(a, b) {
            self.unproven.add(a, b);
        }
    }

    /// The cells that remain to be proven hidden from `source`: neither visible, nor left open, nor proven hidden.
    /// Ascending.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn left(&self, source: u32) -> Vec<u32> {
        ones(&self.candidates(source, &[])).collect()
    }

    /// How many lines and walks were taken.
    pub fn n_taken(&self) -> [usize; 2] {
        [self.lines.len(), self.walks.len()]
    }

    /// The lines and walks that were taken since there were so many of each, as bytes.
    pub(crate) fn bytes_since(&self, [n_lines, n_walks]: [usize; 2]) -> Vec<u8>
    where
        N::Line: Coded,
        N::Walk: Coded,
    {
        let mut writer = Writer::default();
        writer.list(self.lines.get(n_lines..).unwrap_or_default());
        writer.list(self.walks.get(n_walks..).unwrap_or_default());
        writer.into_bytes()
    }

    /// Takes the lines and walks of such bytes, each of which has to hold and to prove something new. Returns whether all were taken; if
    /// not, some may be.
    pub(crate) fn take_bytes(&mut self, bytes: &[u8], proof_of: impl Fn(&N::Walk) -> WalkProof<'_, N::Block>) -> bool
    where
        N::Line: Coded,
        N::Walk: Coded,
    {
        let mut reader = Reader::of(bytes);
        let Ok(lines) = reader.list::<N::Line>() else { return false };
        let Ok(walks) = reader.list::<N::Walk>() else { return false };
        reader.end().is_ok()
            && lines.into_iter().all(|line| self.take_line(line, 1))
            && walks.into_iter().all(|walk| {
                let holds = self.repeat(proof_of(&walk));
                self.walks.extend(holds.then_some(walk));
                holds
            })
    }

    /// Whether a walk proves something new; then it counts as proven.
    fn repeat(&mut self, WalkProof { source, targets, decisions }: WalkProof<'_, N::Block>) -> bool {
        let n = self.network.gates().n_cells();
        if [source].iter().chain(targets).any(|&cell| cell as usize >= n) {
            return false;
        }
        let candidates = self.candidates(source, targets);
        let mut replay = Replay::new(self.network, decisions);
        candidates.iter().any(|word| *word != 0)
            && self.walk.prove(source, &candidates, &mut replay, u64::MAX).is_ok()
            && replay.is_complete()
    }

    /// The pairs that are left open.
    pub(crate) fn unproven(&self) -> Vec<[u32; 2]> {
        self.unproven.iter().collect()
    }

    fn candidates(&self, source: u32, targets: &[u32]) -> Vec<u64> {
        candidates(source, targets, [&self.visible, &self.unproven, self.walk.hidden()])
    }

    /// Proves cells hidden from `source`, those of `targets` or all that are left. Returns whether that was possible within
    /// `most_steps` gates; then `walk` makes the walk from its decisions.
    pub(crate) fn prove(
        &mut self,
        source: u32,
        targets: &[u32],
        solver: &mut impl ChainSolver<Block = N::Block>,
        most_steps: u64,
        walk: impl FnOnce(Decisions<N::Block>) -> N::Walk,
    ) -> bool {
        let candidates = self.candidates(source, targets);
        if candidates.iter().all(|word| *word == 0) {
            return true;
        }
        let mut director = Record { network: self.network, solver, decisions: Decisions::default() };
        let is_proven = self.walk.prove(source, &candidates, &mut director, most_steps).is_ok();
        if is_proven {
            self.walks.push(walk(director.decisions));
        }
        is_proven
    }
}

/// Takes the answers of a solver, checks them, and records them.
struct Record<'a, N: Network, S> {
    network: &'a N,
    solver: &'a mut S,
    decisions: Decisions<N::Block>,
}

impl<N: Network, S: ChainSolver<Block = N::Block>> Director for Record<'_, N, S> {
    type Stop = ();

    fn start(&mut self, gate: u32) {
        self.solver.start(gate);
    }

    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, ()> {
        match self.solver.cross(chain, gate) {
            ChainStep::Open => {
                self.decisions.continue_chain();
                Ok(Crossing::Open)
            }
            ChainStep::Blocked(block) => {
                let gates = self.network.blocked_gates(&block, chain, gate).ok_or(())?;
                self.decisions.end_chain(block);
                Ok(Crossing::Blocked(gates))
            }
            ChainStep::GiveUp => Err(()),
        }
    }

    fn back(&mut self) {
        self.solver.back();
    }
}
