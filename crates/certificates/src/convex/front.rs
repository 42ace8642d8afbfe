//! Which cells lines may reach behind a gate, by the planes of gates alone.

use super::network::ConvexNetwork;
use crate::walk::{Fronts, MOST_FRONT_WORDS};

/// Rows of bits, each computed on first use.
pub struct Front<'a> {
    network: &'a ConvexNetwork,
    /// For each gate, the gates that may follow it.
    after: Vec<Option<Box<[u64]>>>,
    /// For each gate, the cells that are reached behind it through gates that may follow it.
    rows: Vec<Option<Box<[u64]>>>,
    /// The row of all gates of a network that is too large.
    all: Option<Box<[u64]>>,
}

impl<'a> Front<'a> {
    pub(super) fn new(network: &'a ConvexNetwork) -> Self {
        let (n_gates, n_cells) = (network.gates.len(), network.n_cells());
        let n_words = n_gates.saturating_mul(n_cells.div_ceil(64) + n_gates.div_ceil(64));
        let all = (n_words > MOST_FRONT_WORDS).then(|| vec![u64::MAX; n_cells.div_ceil(64)].into_boxed_slice());
        let n = if all.is_some() { 0 } else { n_gates };
        Self { network, after: vec![None; n], rows: vec![None; n], all }
    }

    fn after(&mut self, gate: u32) -> &[u64] {
        let network = self.network;
        self.after[gate as usize].get_or_insert_with(|| {
            let n = network.gates.len() as u32;
            let bit = |k: u32| u64::from(network.may_follow(gate, k));
            (0..n.div_ceil(64))
                .map(|i| (0..(n - 64 * i).min(64)).fold(0, |word, k| word | bit(64 * i + k) << k))
                .collect()
        })
    }
}

impl Fronts for Front<'_> {
    const IS_ORDERED: bool = true;

    fn row(&mut self, gate: u32) -> &[u64] {
        if self.all.is_none() && self.rows[gate as usize].is_none() {
            let network = self.network;
            let row = reached(network, gate, self.after(gate));
            self.rows[gate as usize] = Some(row);
        }
        let kept = self.rows.get(gate as usize).and_then(Option::as_deref);
        kept.or(self.all.as_deref()).unwrap_or_default()
    }

    fn may_follow(&mut self, chain: &[u32], gate: u32) -> bool {
        if self.all.is_some() {
            return chain.iter().all(|&before| self.network.may_follow(before, gate));
        }
        chain.iter().all(|&before| self.after(before)[gate as usize / 64] >> (gate % 64) & 1 == 1)
    }
}

/// The cell behind a gate, and the cells reached from it through gates that may follow the gate.
fn reached(network: &ConvexNetwork, gate: u32, after: &[u64]) -> Box<[u64]> {
    let mut row = vec![0u64; network.n_cells().div_ceil(64)];
    let mut waiting = vec![network.cells(gate)[1]];
    while let Some(cell) = waiting.pop() {
        let (word, bit) = (&mut row[cell as usize / 64], 1 << (cell % 64));
        if *word & bit == 0 {
            *word |= bit;
            let exits = network.gates.exits(cell).iter();
            waiting.extend(
                exits
                    .filter(|&&exit| after[exit as usize / 64] >> (exit % 64) & 1 == 1)
                    .map(|&exit| network.cells(exit)[1]),
            );
        }
    }
    row.into()
}
