//! The walk: it follows every chain of gates from a cell that could lead to a cell which is to be proven hidden.
//!
//! # What it shows
//! Cells are convex, so a line goes through a chain of cells, each once, and leaves none by the side through which it
//! entered. From a *source* the walk follows all such chains, each with the *candidates* that it may still reach. A chain
//! ends at a gate
//!
//! * if gates of the chain together with this one are **blocked**: a checked proof shows that no open set of lines passes
//!   all of them;
//! * if no candidate is left. A candidate is dropped when it has no part in front of a gate of the chain, and when the
//!   chain enters a cell from which it is **proven hidden already**: a line that reached it would join the two.
//!
//! If no chain enters a candidate, all candidates are hidden from the source, and count as proven from then on. Each
//! step rests on earlier ones only.
//!
//! Where cells are given by their portals alone ([`Fronts::IS_ORDERED`]), they need not be convex. There a chain may
//! re-enter a cell, but not reuse a gate; it ends at a gate that cannot follow one of its gates; and gates are blocked in
//! one order only.
//!
//! # Who decides
//! At a gate that neither rule ends, a [`Director`] decides whether the chain continues or is blocked, and by which gates.
//! The checker reads that from the proofs; the maker queries a solver. Blocked gates are remembered with the last of them,
//! at most [`MOST_KEPT`] lists, the most recently used first, so a reason need not be repeated.
//!
//! Plans and maps differ in their [`Network`]; the walk, the checker and the maker are the same.

mod check;
mod decisions;
mod make;
mod network;

pub use decisions::Decisions;
pub use make::{ChainSolver, ChainStep, Maker};

pub(crate) use check::{WalkProof, check};
pub(crate) use network::{Network, gate_back};

use crate::graph::{Gate, Gates};
use crate::pairs::{Pairs, ones};
use std::rc::Rc;

/// The most words, 64 MiB, that the rows of a network's [`Fronts`] may take. In a larger network every cell counts as in
/// front of every gate. It is part of the format: makers and the checker drop the same candidates.
pub(crate) const MOST_FRONT_WORDS: usize = 8 << 20;

/// Number of lists of blocked gates that are remembered for each last gate. It is part of the format.
const MOST_KEPT: usize = 64;

/// The decision at a gate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Crossing {
    /// The chain continues through it.
    Open,
    /// No open set of lines passes these gates of the chain and then the new gate, which is not among them. In the order of
    /// the chain where order counts, else ascending.
    Blocked(Vec<u32>),
}

/// Decides at gates. Called in the order of a stack: `start`, then `cross`, with a `back` for each open crossing.
pub(crate) trait Director {
    /// Why it stops the walk.
    type Stop;

    /// A chain starts with this gate.
    fn start(&mut self, gate: u32);

    /// Decides about the next gate of the chain.
    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, Self::Stop>;

    /// The last gate is removed from the chain.
    fn back(&mut self);
}

/// Which cells have a part in front of a gate.
pub trait Fronts {
    /// Whether chains may re-enter cells. If so, [`Self::may_follow`] is tested, and the order of blocked gates counts.
    const IS_ORDERED: bool = false;

    /// A bit for each cell: `false` only for cells that no line enters after it has passed the gate, such as those that lie
    /// wholly behind it, or beside it on its line or plane.
    fn row(&mut self, gate: u32) -> &[u64];

    /// Whether lines may pass a gate after those of a chain; `false` only if none does.
    fn may_follow(&mut self, _chain: &[u32], _gate: u32) -> bool {
        true
    }
}

/// Why a walk proves nothing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Ended<S> {
    /// The director stopped it.
    Stopped(S),
    /// A chain entered a candidate.
    Entered(u32),
    /// It took more steps than are allowed.
    TooLong,
}

/// A cell on the chain.
struct Frame {
    cell: u32,
    entry_side: u32,
    /// The next exit and the end of the exits.
    next: usize,
    end: usize,
    /// The range of its candidates in the arena.
    candidates: [usize; 2],
}

/// The pairs proven so far, the blocked gates that are remembered, and scratch memory.
pub(crate) struct Walk<'a, F> {
    gates: &'a Gates,
    fronts: F,
    /// Pairs that are proven to be hidden.
    hidden: Pairs,
    /// For each gate, lists of gates that are blocked together with it.
    blocked: Vec<Vec<Rc<[u32]>>>,
    /// The lists of `blocked` that this walk changed, as they were before.
    before: Vec<(u32, Vec<Rc<[u32]>>)>,
    is_changed: Vec<bool>,
    /// The place of each gate in the chain, counted from 1; 0 for gates that are not in it.
    places: Vec<u32>,
    is_met: Vec<bool>,
    chain: Vec<u32>,
    frames: Vec<Frame>,
    /// Candidates of all frames: the index of a word, and its bits.
    arena: Vec<(u32, u64)>,
}

impl<'a, F: Fronts> Walk<'a, F> {
    pub(crate) fn new(gates: &'a Gates, fronts: F) -> Self {
        Self {
            gates,
            fronts,
            hidden: Pairs::none(gates.n_cells()),
            blocked: vec![Vec::new(); gates.len()],
            before: Vec::new(),
            is_changed: vec![false; gates.len()],
            places: vec![0; gates.len()],
            is_met: vec![false; gates.n_cells()],
            chain: Vec::new(),
            frames: Vec::new(),
            arena: Vec::new(),
        }
    }

    pub(crate) fn hidden(&self) -> &Pairs {
        &self.hidden
    }

    pub(crate) fn into_hidden(self) -> Pairs {
        self.hidden
    }

    /// Proves that `source` sees none of the candidates in at most `most_steps` gates. The candidates are a row of bits: cells
    /// other than the source that are not proven yet. After an error everything is as it was before.
    pub(crate) fn prove<D: Director>(
        &mut self,
        source: u32,
        candidates: &[u64],
        director: &mut D,
        most_steps: u64,
    ) -> Result<(), Ended<D::Stop>> {
        let end = self.follow(source, candidates, director, most_steps);
        for gate in self.chain.drain(..) {
            self.places[gate as usize] = 0;
        }
        for frame in self.frames.drain(..) {
            self.is_met[frame.cell as usize] = false;
        }
        self.is_met[source as usize] = false;
        for (gate, lists) in self.before.drain(..) {
            self.is_changed[gate as usize] = false;
            if end.is_err() {
                self.blocked[gate as usize] = lists;
            }
        }
        if end.is_ok() {
            for other in ones(candidates) {
                self.hidden.add(source, other);
            }
        }
        end
    }

    fn follow<D: Director>(
        &mut self,
        source: u32,
        candidates: &[u64],
        director: &mut D,
        most_steps: u64,
    ) -> Result<(), Ended<D::Stop>> {
        self.arena.clear();
        self.arena.extend((0u32..).zip(candidates).filter(|(_, bits)| **bits != 0).map(|(i, &bits)| (i, bits)));
        if self.arena.is_empty() {
            return Ok(());
        }
        let all = [0, self.arena.len()];
        self.is_met[source as usize] = true;
        let mut n_steps = 0;
        for place in self.gates.exit_range(source) {
            let gate = self.gates.exit(place);
            if let Some(left) = self.left(gate, all) {
                director.start(gate);
                self.enter(gate, left)?;
            }
            while let Some(frame) = self.frames.last_mut() {
                if frame.next == frame.end {
                    self.leave(director);
                    continue;
                }
                n_steps += 1;
                if n_steps > most_steps {
                    return Err(Ended::TooLong);
                }
                let gate = self.gates.exit(frame.next);
                frame.next += 1;
                let (entry_side, own) = (frame.entry_side, frame.candidates);
                let Gate { cells: [_, to], sides: [side, _] } = self.gates.gate(gate);
                let is_again = if F::IS_ORDERED { self.places[gate as usize] > 0 } else { self.is_met[to as usize] };
                if side == entry_side || is_again || !self.fronts.may_follow(&self.chain, gate) || self.is_blocked(gate)
                {
                    continue;
                }
                let Some(left) = self.left(gate, own) else { continue };
                match director.cross(&self.chain, gate).map_err(Ended::Stopped)? {
                    Crossing::Open => self.enter(gate, left)?,
                    Crossing::Blocked(others) => {
                        self.arena.truncate(own[1]);
                        self.remember(gate, others.into());
                    }
                }
            }
        }
        Ok(())
    }

    /// The candidates that are left behind a gate, at the end of the arena; `None` if there are none.
    fn left(&mut self, gate: u32, [start, end]: [usize; 2]) -> Option<[usize; 2]> {
        let front = self.fronts.row(gate);
        let hidden = self.hidden.row(self.gates.gate(gate).cells[1]);
        let first = self.arena.len();
        for k in start..end {
            let (i, bits) = self.arena[k];
            let bits = bits & front[i as usize] & !hidden[i as usize];
            if bits != 0 {
                self.arena.push((i, bits));
            }
        }
        (self.arena.len() > first).then_some([first, self.arena.len()])
    }

    fn enter<S>(&mut self, gate: u32, candidates: [usize; 2]) -> Result<(), Ended<S>> {
        let Gate { cells: [_, cell], sides: [_, entry_side] } = self.gates.gate(gate);
        let own = &self.arena[candidates[0]..candidates[1]];
        let word = own.binary_search_by_key(&(cell / 64), |(i, _)| *i);
        self.chain.push(gate);
        self.places[gate as usize] = self.chain.len() as u32;
        self.is_met[cell as usize] = true;
        let exits = self.gates.exit_range(cell);
        self.frames.push(Frame { cell, entry_side, next: exits.start, end: exits.end, candidates });
        if word.is_ok_and(|k| own[k].1 >> (cell % 64) & 1 == 1) { Err(Ended::Entered(cell)) } else { Ok(()) }
    }

    fn leave<D: Director>(&mut self, director: &mut D) {
        if let Some(frame) = self.frames.pop() {
            self.is_met[frame.cell as usize] = false;
            self.arena.truncate(frame.candidates[0]);
        }
        if let Some(gate) = self.chain.pop() {
            self.places[gate as usize] = 0;
            // The director started the chain with its first gate, and gets no call for the end of it.
            if !self.chain.is_empty() {
                director.back();
            }
        }
    }

    /// Whether the chain with this gate is blocked by gates that are remembered.
    fn is_blocked(&mut self, gate: u32) -> bool {
        let places = &self.places;
        let is_on_chain = |list: &Rc<[u32]>| {
            let mut last = 0;
            list.iter().all(|&g| {
                let place = places[g as usize];
                place > if F::IS_ORDERED { std::mem::replace(&mut last, place) } else { 0 }
            })
        };
        let Some(k) = self.blocked[gate as usize].iter().position(is_on_chain) else { return false };
        if k > 0 {
            self.note_change(gate);
            self.blocked[gate as usize][..=k].rotate_right(1);
        }
        true
    }

    fn remember(&mut self, gate: u32, others: Rc<[u32]>) {
        self.note_change(gate);
        let lists = &mut self.blocked[gate as usize];
        lists.truncate(MOST_KEPT - 1);
        lists.insert(0, others);
    }

    fn note_change(&mut self, gate: u32) {
        if !std::mem::replace(&mut self.is_changed[gate as usize], true) {
            self.before.push((gate, self.blocked[gate as usize].clone()));
        }
    }
}
