//! Proofs of tables of plans.
//!
//! *Visible* pairs are proven by lines, each followed exactly through the portals that it crosses: all cells on it see
//! each other. *Hidden* pairs are proven by walks, one from each cell, through all chains of gates that could lead from
//! it to a cell that it does not see: where a chain ends, four ends of gates that no line separates say why. Pairs that
//! neither kind proves are left *open*, and reported.

mod block;
mod bytes;
mod front;
mod line;
mod make;
mod network;

pub use block::PlanBlock;
pub use line::{LineForm, PlanLine, Point};
pub use make::{PlanGuide, PlanMaker, PlanStep};
pub use network::{NetworkError, PlanNetwork, PlanPortal};

pub(crate) use bytes::{read_pairs, write_pairs};

use crate::bits::Bits;
use crate::pairs::Pairs;
use crate::proven::{Proven, Refusal};
use crate::walk::{Crossing, Director, Ended, Walk};
use front::Front;

/// The walk from one cell.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanWalk {
    /// The cell.
    pub source: u32,
    /// For each gate that has to be decided about, in the order of the walk, whether the chain goes on behind it.
    pub(crate) open: Bits,
    /// For those where it does not, why.
    pub blocks: Vec<PlanBlock>,
}

impl PlanWalk {
    /// A walk from a cell: for each gate that has to be decided about whether the chain goes on, and for those where it does not,
    /// why.
    pub fn new(source: u32, open: &[bool], blocks: Vec<PlanBlock>) -> Self {
        let mut bits = Bits::default();
        open.iter().for_each(|&bit| bits.push(bit));
        Self { source, open: bits, blocks }
    }

    /// Number of gates that are decided about.
    pub fn n_decided(&self) -> usize {
        self.open.len()
    }

    /// Whether the chain goes on behind a gate that is decided about.
    pub fn is_open(&self, k: usize) -> Option<bool> {
        self.open.get(k)
    }
}

/// Proofs of a table of a plan.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanProofs {
    /// [`PlanNetwork::checksum`] of the cells and portals.
    pub checksum: u32,
    /// Lines that prove pairs to be visible.
    pub lines: Vec<PlanLine>,
    /// Pairs of different cells that no line proves to be visible, and no walk is to prove hidden; ascending, lower
    /// number first.
    pub unproven: Vec<[u32; 2]>,
    /// Walks that prove pairs to be hidden: of each source all that is not proven at that time.
    pub walks: Vec<PlanWalk>,
}

impl PlanProofs {
    /// Checks every proof, and says what they prove together. Exact.
    ///
    /// Cost: some orientations for each gate of a line and each end of a chain, and the walks, which take as long as
    /// there are bits in them times the exits of a cell. Memory: a few bits for each pair of cells.
    ///
    /// # Errors
    /// [`Refusal`] for proofs of another network and for the first proof that does not hold.
    pub fn check(&self, network: &PlanNetwork) -> Result<Proven, Refusal> {
        if self.checksum != network.checksum() {
            return Err(Refusal::OtherTable);
        }
        let visible = seen_along(&self.lines, network)?;
        let mut unproven = Pairs::none(network.n_cells());
        for (index, &[a, b]) in self.unproven.iter().enumerate() {
            if a >= b || b as usize >= network.n_cells() {
                return Err(Refusal::Pair { index });
            }
            unproven.add(a, b);
        }
        let mut walk = Walk::new(&network.gates, Front::new(network));
        for (index, own) in self.walks.iter().enumerate() {
            if own.source as usize >= network.n_cells() {
                return Err(Refusal::Source { walk: index, from: own.source });
            }
            let candidates = candidates(own.source, [&visible, &unproven, walk.hidden()]);
            let mut director = Reader { network, walk: own, n_read: 0, n_blocks: 0 };
            let end = walk.prove(own.source, &candidates, &mut director, u64::MAX);
            let from = own.source;
            match end {
                Ok(()) if director.n_read == own.open.len() && director.n_blocks == own.blocks.len() => {}
                Ok(()) => return Err(Refusal::Unused { walk: index, from }),
                Err(Ended::Stopped(block)) => return Err(Refusal::Block { walk: index, from, block }),
                Err(Ended::Entered(cell)) => return Err(Refusal::Entered { walk: index, from, cell }),
                Err(Ended::TooLong) => return Err(Refusal::Unused { walk: index, from }),
            }
        }
        Ok(Proven::new(visible, walk.into_hidden()))
    }
}

/// The pairs that lines prove to be visible.
fn seen_along(lines: &[PlanLine], network: &PlanNetwork) -> Result<Pairs, Refusal> {
    let mut visible = Pairs::none(network.n_cells());
    for (index, line) in lines.iter().enumerate() {
        let cells = network.follow(line);
        if cells.is_empty() {
            return Err(Refusal::Line { index, cell: line.cell });
        }
        visible.add_all(&cells);
    }
    Ok(visible)
}

/// The cells that `source` is still to be proven not to see: neither seen, nor left unproven, nor proven hidden.
pub(crate) fn candidates(source: u32, known: [&Pairs; 3]) -> Vec<u64> {
    let n = known[0].n_cells();
    let mut row = vec![u64::MAX; n.div_ceil(64)];
    if let Some(last) = row.last_mut().filter(|_| !n.is_multiple_of(64)) {
        *last = (1 << (n % 64)) - 1;
    }
    row[source as usize / 64] &= !(1 << (source % 64));
    for pairs in known {
        row.iter_mut().zip(pairs.row(source)).for_each(|(word, out)| *word &= !out);
    }
    row
}

/// Says at each gate what the proofs say, once that is checked. Stops with the number of the block that proves nothing.
struct Reader<'a> {
    network: &'a PlanNetwork,
    walk: &'a PlanWalk,
    n_read: usize,
    n_blocks: usize,
}

impl Director for Reader<'_> {
    type Stop = usize;

    fn start(&mut self, _gate: u32) {}

    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, usize> {
        let open = self.walk.open.get(self.n_read).ok_or(self.n_blocks)?;
        self.n_read += 1;
        if open {
            return Ok(Crossing::Open);
        }
        let block = self.walk.blocks.get(self.n_blocks).and_then(|block| block.gates(self.network, chain, gate));
        let gates = block.ok_or(self.n_blocks)?;
        self.n_blocks += 1;
        Ok(Crossing::Blocked(gates))
    }

    fn back(&mut self) {}
}
