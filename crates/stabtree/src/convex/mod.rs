//! Which convex cells see each other through convex portals.
//!
//! Four stages, from quick to exact:
//!
//! 1. **Bound** ([`bound`]): what may be seen through each gate, by the planes of portals alone.
//! 2. **Lines** ([`sampled`]): some lines through every gate; all cells on a line see each other.
//! 3. **Beams** ([`beams`]): for each gate, beams of lines search for what is still in doubt. Most of it is proven
//!    hidden; for most of the rest an exact line is found.
//! 4. **Pairs** ([`pairs`]): the pairs that beams leave in doubt are decided sequence by sequence.
//!
//! Where leafs of a map are merged, cells need not be convex, and a line may come back into one. Nothing is known of the
//! inside of a cell, so nothing hides there: a line that is in a cell twice may as well have stayed, and the portals that
//! it passes before the first time and after the last are a chain too. So chains that enter each cell at most once are
//! enough, whatever cells look like. In a convex cell a line enters before it leaves; in others its order is checked.
//!
//! Visibility is symmetric, and each answer counts for both sides. Every stage processes its gates or cells in batches
//! that do not depend on the number of threads: members of a batch use the results of earlier batches, and not those of
//! each other. So the answer, the lines tried and the operations counted are the same with any number of threads.
//!
//! Source: the question is Teller's (PhD thesis, 1992, chapter 5); planes between portals are those of Quake's vis.
//! Lines first, beams that depend on two portals only, exact sequences last: ours.

mod batch;
mod beams;
mod bound;
mod cell_set;
mod certify;
mod cut;
mod explain;
mod gates;
mod kept;
mod pairs;
mod sampled;
mod state;
mod vector;

pub use certify::{certify_convex, convex_network};
pub use explain::{
    BlockedConvex, Blocking, ConvexDoubt, ConvexExplainer, ConvexExplanation, ConvexGate, ConvexPath, ConvexProof,
    MOST_EXPLAINED, check_convex, explain_convex,
};
pub use state::{ConvexOptions, ConvexSearchCounters, ConvexState, ConvexVisibility, WorkChain};

pub(crate) use batch::Workers;
use beams::{BeamTracer, Traced};
pub(crate) use gates::Gates;
use pairs::{PairVerdict, SequenceTracer, cells_of};
use sightlines_cells::{CellGraph, Convex};
use sightlines_progress::{Cancelled, Observer, Progress};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{LimitReached, Verdict};
use std::ops::{ControlFlow, Range};

/// Number of stages, and the stage number of a finished search.
const N_STAGES: u32 = 4;
/// Lines followed through each portal before the other stages.
const LINES_EACH: u32 = 32;
/// Batch size of the stages with little work per gate.
const MANY: usize = 1024;
/// Batch size of the stage whose gates may take long.
const FEW: usize = 64;
/// Smallest number of pairs in a batch, except for the last.
const PAIRS: usize = 256;

/// A search that can be stopped between any two steps.
#[derive(Debug)]
pub struct ConvexSearch {
    gates: Gates,
    options: ConvexOptions,
    state: ConvexState,
    /// Gates in ascending order of how much lies behind them.
    order: Vec<u32>,
    /// The rank of each cell in a similar order.
    rank: Vec<u32>,
    /// All cells in an arbitrary order: neighbours, which take similar time, are far apart, so that the remaining work
    /// can be estimated from what is done.
    scattered: Vec<u32>,
    workers: Workers,
    chain: WorkChain,
}

impl ConvexSearch {
    /// A search that has not begun.
    pub fn new(graph: &CellGraph<Convex>, options: ConvexOptions) -> Self {
        let gates = Gates::new(graph);
        let n = gates.n_cells();
        let state = ConvexState {
            stage: 0,
            done: 0,
            visible: BitMatrix::identity(n),
            possible: BitMatrix::identity(n),
            through: BitMatrix::new(gates.len(), n),
            undecided: Vec::new(),
            counters: ConvexSearchCounters::default(),
        };
        let workers = Workers::new(options.threads);
        let mut scattered: Vec<u32> = (0..n as u32).collect();
        // Bits reversed: halves, then quarters, and so on.
        scattered.sort_by_key(|cell| cell.reverse_bits());
        Self {
            gates,
            options,
            state,
            order: Vec::new(),
            rank: Vec::new(),
            scattered,
            workers,
            chain: WorkChain::default(),
        }
    }

    /// The current state of the search.
    pub fn state(&self) -> &ConvexState {
        &self.state
    }

    /// The work of beams and of pairs since this search was made, where nearly all time goes, and the longest
    /// chain of it that no number of threads can shorten. Deterministic, with any number of threads.
    pub fn chain(&self) -> WorkChain {
        self.chain
    }

    /// The progress of the search. The share is an estimate of time.
    pub fn progress(&self) -> Progress {
        let ConvexState { stage, done, .. } = self.state;
        let (phase, total) = match stage {
            0 => ("bounds", self.gates.len()),
            1 => ("lines", self.gates.len() / 2),
            2 => ("beams", self.gates.len()),
            3 => ("sequences", self.gates.n_cells()),
            _ => ("done", 0),
        };
        let progress = Progress::new(phase, done, total as u64);
        let part = progress.share.min(1.0);
        progress.with_share(match stage {
            0 => 0.02 * part,
            1 => 0.02 + 0.03 * part,
            // Gates are in the order of what lies behind them; on maps, time grows with the square of their number.
            2 => 0.05 + 0.4 * part.powi(2),
            // Between half and twice the time of all earlier stages, on the maps that were measured.
            3 => 0.45 + 0.55 * part,
            _ => 1.0,
        })
    }

    /// Takes all remaining steps, with a report before the first and after each. Keeps nothing for a later run, as [`ConvexSearch::run_in_units`] can.
    ///
    /// # Errors
    /// [`Cancelled`] by the observer. The search can continue from its current state.
    pub fn run(&mut self, observer: Option<&dyn Observer>) -> Result<(), Cancelled> {
        let report = |search: &Self| match observer.map(|observer| observer.report(search.progress())) {
            Some(ControlFlow::Break(())) => Err(Cancelled),
            Some(ControlFlow::Continue(())) | None => Ok(()),
        };
        report(self)?;
        let mut more = true;
        while more {
            more = self.advance();
            report(self)?;
        }
        Ok(())
    }

    /// Whether no step is left.
    pub fn is_done(&self) -> bool {
        self.state.stage >= N_STAGES
    }

    /// Takes a step; returns whether more are left.
    pub fn advance(&mut self) -> bool {
        match self.state.stage {
            0 => self.bound(),
            1 => self.shoot(),
            2 => self.trace_beams(),
            3 => self.decide_pairs(),
            _ => {}
        }
        !self.is_done()
    }

    /// The answer.
    ///
    /// # Panics
    /// If [`ConvexSearch::advance`] has steps left.
    pub fn finish(self) -> ConvexVisibility {
        let ConvexState { stage, visible, possible, mut undecided, counters, .. } = self.state;
        assert!(stage == N_STAGES, "the search is not done");
        if self.options.fast {
            return ConvexVisibility { cells: possible, undecided, counters };
        }
        undecided.retain(|&[a, b]| !visible.get(a as usize, b as usize));
        undecided.sort_unstable();
        let mut cells = visible;
        for &[a, b] in &undecided {
            cells.set(a as usize, b as usize, true);
            cells.set(b as usize, a as usize, true);
        }
        ConvexVisibility { cells, undecided, counters }
    }

    fn next_stage(&mut self) {
        self.state.stage += 1;
        self.state.done = 0;
    }

    /// The units of the next batch, as a range; moves on.
    fn take(&mut self, all: usize, size: usize) -> Range<usize> {
        let start = self.state.done as usize;
        let end = (start + size).min(all);
        self.state.done = end as u64;
        start.min(end)..end
    }

    fn bound(&mut self) {
        let range = self.take(self.gates.len(), MANY);
        let gates = &self.gates;
        let rows = self.workers.map(range.clone(), || (), |(), gate| bound::seen_through(gates, gate as u32));
        for (gate, row) in range.zip(rows) {
            self.state.through.row_mut(gate).copy_from_slice(&row);
        }
        if self.state.done as usize == self.gates.len() {
            self.set_order();
            self.set_possible();
            self.next_stage();
            if self.options.fast {
                self.state.stage = N_STAGES;
            }
        }
    }

    fn set_order(&mut self) {
        let count = |gate: u32| self.state.through.count_row(gate as usize);
        let mut order: Vec<u32> = (0..self.gates.len() as u32).collect();
        order.sort_by_cached_key(|&gate| (count(gate), gate));
        let total = |cell: u32| self.gates.exits(cell).iter().map(|&gate| count(gate)).sum::<u64>();
        let mut cells: Vec<u32> = (0..self.gates.n_cells() as u32).collect();
        cells.sort_by_cached_key(|&cell| (total(cell), cell));
        let mut rank = vec![0; cells.len()];
        cells.iter().zip(0u32..).for_each(|(&cell, place)| rank[cell as usize] = place);
        (self.order, self.rank) = (order, rank);
    }

    /// Marks pairs of cells as possible if each may see the other through one of its gates, and removes the others from
    /// what may be seen through gates.
    fn set_possible(&mut self) {
        let n = self.gates.n_cells();
        let mut reach = BitMatrix::identity(n);
        for gate in 0..self.gates.len() {
            let from = self.gates.get(gate as u32).from as usize;
            let row = self.state.through.row(gate);
            reach.row_mut(from).iter_mut().zip(row).for_each(|(reach, row)| *reach |= row);
        }
        self.state.possible = BitMatrix::identity(n);
        for a in 0..n {
            for b in reach.iter_ones(a).filter(|&b| reach.get(b, a)) {
                self.state.possible.set(a, b, true);
            }
        }
        for gate in 0..self.gates.len() {
            let from = self.gates.get(gate as u32).from as usize;
            let possible = self.state.possible.row(from);
            self.state.through.row_mut(gate).iter_mut().zip(possible).for_each(|(row, possible)| *row &= possible);
        }
    }

    fn shoot(&mut self) {
        let n_portals = self.gates.len() / 2;
        let range = self.take(n_portals, MANY);
        let gates = &self.gates;
        let chains = self.workers.map(
            range.clone(),
            || (),
            |(), portal| {
                let mut chains: Vec<Vec<u32>> = Vec::new();
                sampled::shoot_through(gates, 2 * portal as u32, LINES_EACH, |chain| {
                    if chain.len() > 1 {
                        chains.push(chain.to_vec());
                    }
                });
                chains
            },
        );
        chains.iter().flatten().for_each(|chain| sampled::mark(gates, chain, &mut self.state.visible));
        self.state.counters.lines += range.len() as u64 * u64::from(LINES_EACH);
        if self.state.done as usize == n_portals {
            self.next_stage();
        }
    }

    fn trace_beams(&mut self) {
        let range = self.take(self.order.len(), FEW);
        let traced = self.beams_of(range.clone());
        self.chain.add(traced.iter().map(|(_, counters)| counters.work()));
        let done = self.state.done as usize;
        let mut is_done = vec![false; self.order.len()];
        self.order[..done].iter().for_each(|&gate| is_done[gate as usize] = true);
        let (traced, counters): (Vec<Traced>, Vec<ConvexSearchCounters>) = traced.into_iter().unzip();
        counters.into_iter().for_each(|counters| self.state.counters += counters);
        self.apply_beams(range, &traced, &is_done);
        if done == self.order.len() {
            self.set_possible();
            self.next_stage();
        }
    }

    /// Beams of the gates at some places of the order, by what is known now.
    fn beams_of(&self, places: Range<usize>) -> Vec<(Traced, ConvexSearchCounters)> {
        let (gates, state, order) = (&self.gates, &self.state, &self.order);
        self.workers.map(
            places,
            || BeamTracer::new(gates),
            |tracer, place| {
                let gate = order[place];
                let from = gates.get(gate).from as usize;
                let row = state.through.row(gate as usize).iter().zip(state.visible.row(from));
                let in_doubt = row.map(|(through, visible)| through & !visible).collect();
                let traced = tracer.trace(gates, gate, in_doubt, &state.through);
                (traced, tracer.take_counters())
            },
        )
    }

    /// Adds what beams of the gates at some places have found. `is_done`: the gates whose beams were added, these among them.
    fn apply_beams(&mut self, places: Range<usize>, traced: &[Traced], is_done: &[bool]) {
        let mut touched: Vec<u32> = Vec::new();
        for (place, traced) in places.zip(traced) {
            let gate = self.order[place];
            let row = self.state.through.row_mut(gate as usize);
            row.iter_mut().zip(&traced.hidden).for_each(|(row, hidden)| *row &= !hidden);
            traced.chains.iter().for_each(|chain| sampled::mark(&self.gates, chain, &mut self.state.visible));
            touched.push(self.gates.get(gate).from);
        }
        // A cell that cannot be seen from a cell with all gates done cannot see that cell either.
        touched.sort_unstable();
        touched.dedup();
        let all_done = |cell: u32| self.gates.exits(cell).iter().all(|&gate| is_done[gate as usize]);
        for cell in touched.into_iter().filter(|&cell| all_done(cell)) {
            let mut reach = vec![0u64; self.state.through.row(0).len()];
            for &gate in self.gates.exits(cell) {
                let row = self.state.through.row(gate as usize);
                reach.iter_mut().zip(row).for_each(|(reach, row)| *reach |= row);
            }
            let possible = self.state.possible.row(cell as usize);
            let hidden: Vec<u64> = possible.iter().zip(&reach).map(|(possible, reach)| possible & !reach).collect();
            for other in cells_of(&hidden).filter(|&other| other != cell) {
                for &gate in self.gates.exits(other) {
                    self.state.through.set(gate as usize, cell as usize, false);
                }
            }
        }
    }

    fn decide_pairs(&mut self) {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let mut done = self.state.done as usize;
        while let Some(&cell) = self.scattered.get(done).filter(|_| pairs.len() < PAIRS) {
            pairs.extend(self.pairs_in_doubt(cell));
            done += 1;
        }
        let decided = self.verdicts_on(&pairs);
        self.state.done = done as u64;
        self.chain.add(decided.iter().map(|(_, counters)| counters.work()));
        for (pair, (sight, counters)) in pairs.into_iter().zip(decided) {
            self.state.counters += counters;
            self.apply_verdict(pair, &sight);
        }
        if self.state.done as usize == self.gates.n_cells() {
            self.next_stage();
        }
    }

    /// The pairs that are in doubt and decided from a cell: each pair is decided from the cell that sees less.
    fn pairs_in_doubt(&self, cell: u32) -> Vec<[u32; 2]> {
        let (state, rank) = (&self.state, &self.rank);
        let row = state.possible.row(cell as usize).iter().zip(state.visible.row(cell as usize));
        let in_doubt: Vec<u64> = row.map(|(possible, visible)| possible & !visible).collect();
        let others = cells_of(&in_doubt).filter(|&other| rank[other as usize] > rank[cell as usize]);
        others.map(|other| [cell, other]).collect()
    }

    fn verdicts_on(&self, pairs: &[[u32; 2]]) -> Vec<(PairVerdict, ConvexSearchCounters)> {
        let (gates, through) = (&self.gates, &self.state.through);
        self.workers.map(
            0..pairs.len(),
            || SequenceTracer::new(gates),
            |tracer, k| (tracer.decide(gates, pairs[k], through), tracer.take_counters()),
        )
    }

    fn apply_verdict(&mut self, [a, b]: [u32; 2], sight: &PairVerdict) {
        match sight {
            Verdict::Visible(chain) => sampled::mark(&self.gates, chain, &mut self.state.visible),
            Verdict::Undecided(LimitReached) => self.state.undecided.push([a.min(b), a.max(b)]),
            Verdict::Hidden(()) => {
                for [from, to] in [[a, b], [b, a]] {
                    self.state.possible.set(from as usize, to as usize, false);
                    for &gate in self.gates.exits(from) {
                        self.state.through.set(gate as usize, to as usize, false);
                    }
                }
            }
        }
    }
}
