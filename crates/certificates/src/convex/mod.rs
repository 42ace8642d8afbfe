//! Proofs of tables of maps: cells joined by convex polygons in space.
//!
//! *Visible* pairs are proven by lines, each followed exactly through the portals that it passes: all cells on it see
//! each other. *Hidden* pairs are proven by walks, one or more from each cell, through all chains of gates that could
//! lead from it to a cell that it does not see: where a chain ends, a plane that stands between three of its gates says
//! why, or sides of edges that cannot all be positive. Pairs that neither kind proves are left *open*, and reported.
//!
//! Of cells nothing is known but their portals, so that they are convex is not used: [`ConvexNetwork`] says what is.

mod block;
mod bytes;
mod front;
mod line;
mod make;
mod network;
mod vector;

pub use block::{ConvexBlock, ConvexCut, ConvexPlane, ConvexSums, ConvexTerm, ConvexTree};
pub use line::ConvexLine;
pub use make::{ConvexGuide, ConvexMaker, ConvexStep};
pub use network::{ConvexNetwork, ConvexNetworkError, ConvexPortal};
pub use vector::Point;

use crate::bits::Bits;
use crate::pairs::Pairs;
use crate::proven::{Proven, Refusal};
use crate::walk::{Crossing, Director, Ended, Walk};
use front::Front;

/// The walk from one cell to some or all cells that it does not see.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexWalk {
    /// The cell.
    pub source: u32,
    /// The cells that it is to be proven not to see, ascending; all of which nothing is proven yet if there are none.
    pub targets: Vec<u32>,
    /// For each gate that has to be decided about, in the order of the walk, whether the chain goes on behind it.
    pub(crate) open: Bits,
    /// For those where it does not, why.
    pub blocks: Vec<ConvexBlock>,
}

impl ConvexWalk {
    /// A walk from a cell: for each gate that has to be decided about whether the chain goes on, and for those where it does not,
    /// why.
    pub fn new(source: u32, targets: Vec<u32>, open: &[bool], blocks: Vec<ConvexBlock>) -> Self {
        let mut bits = Bits::default();
        open.iter().for_each(|&bit| bits.push(bit));
        Self { source, targets, open: bits, blocks }
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

/// Proofs of a table of a map.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexProofs {
    /// [`ConvexNetwork::checksum`] of the cells and portals.
    pub checksum: u32,
    /// Lines that prove pairs to be visible.
    pub lines: Vec<ConvexLine>,
    /// Pairs of different cells that no line proves to be visible, and no walk is to prove hidden; ascending, lower
    /// number first.
    pub unproven: Vec<[u32; 2]>,
    /// Walks that prove pairs to be hidden.
    pub walks: Vec<ConvexWalk>,
}

impl ConvexProofs {
    /// Checks every proof, and says what they prove together. Exact.
    ///
    /// Cost: some determinants for each gate of a line and each corner that a reason names, and the walks, which take as long as
    /// there are bits in them times the exits of a cell. Memory: a few bits for each pair of cells and of gates.
    ///
    /// # Errors
    /// [`Refusal`] for proofs of another network and for the first proof that does not hold.
    pub fn check(&self, network: &ConvexNetwork) -> Result<Proven, Refusal> {
        if self.checksum != network.checksum() {
            return Err(Refusal::OtherTable);
        }
        let n = network.n_cells();
        let mut visible = Pairs::none(n);
        for (index, line) in self.lines.iter().enumerate() {
            let cells = network.follow(line);
            if cells.is_empty() {
                return Err(Refusal::Gate { index, gate: line.gate });
            }
            visible.add_all(&cells);
        }
        let mut unproven = Pairs::none(n);
        for (index, &[a, b]) in self.unproven.iter().enumerate() {
            if a >= b || b as usize >= n {
                return Err(Refusal::Pair { index });
            }
            unproven.add(a, b);
        }
        let mut walk = Walk::new(&network.gates, Front::new(network));
        for (index, own) in self.walks.iter().enumerate() {
            let from = own.source;
            if [from].iter().chain(&own.targets).any(|&cell| cell as usize >= n) {
                return Err(Refusal::Source { walk: index, from });
            }
            let candidates = candidates(from, &own.targets, [&visible, &unproven, walk.hidden()]);
            let mut director = Reader { network, walk: own, n_read: 0, n_blocks: 0 };
            match walk.prove(from, &candidates, &mut director, u64::MAX) {
                Ok(()) if director.n_read == own.open.len() && director.n_blocks == own.blocks.len() => {}
                Ok(()) | Err(Ended::TooLong) => return Err(Refusal::Unused { walk: index, from }),
                Err(Ended::Stopped(block)) => return Err(Refusal::Block { walk: index, from, block }),
                Err(Ended::Entered(cell)) => return Err(Refusal::Entered { walk: index, from, cell }),
            }
        }
        Ok(Proven::new(visible, walk.into_hidden()))
    }
}

/// The cells of `targets`, or if there are none of all, that `source` is still to be proven not to see: neither seen, nor left unproven,
/// nor proven hidden.
fn candidates(source: u32, targets: &[u32], known: [&Pairs; 3]) -> Vec<u64> {
    let mut row = crate::plan::candidates(source, known);
    if !targets.is_empty() {
        let mut wanted = vec![0u64; row.len()];
        for &target in targets {
            wanted[target as usize / 64] |= 1 << (target % 64);
        }
        row.iter_mut().zip(wanted).for_each(|(word, wanted)| *word &= wanted);
    }
    row
}

/// Says at each gate what the proofs say, once that is checked. Stops with the number of the block that proves nothing.
struct Reader<'a> {
    network: &'a ConvexNetwork,
    walk: &'a ConvexWalk,
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
