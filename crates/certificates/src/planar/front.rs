//! Which cells have a part in front of a gate.

use super::network::PlanarNetwork;
use crate::exact::turn;
use crate::walk::{Fronts, MOST_FRONT_WORDS};
use std::cmp::Ordering;

/// Rows of bits, each computed on first use.
pub struct Front<'a> {
    network: &'a PlanarNetwork,
    rows: Vec<Option<Box<[u64]>>>,
    /// The row of all gates of a network that is too large.
    all: Option<Box<[u64]>>,
}

impl<'a> Front<'a> {
    pub(super) fn new(network: &'a PlanarNetwork) -> Self {
        let width = network.n_cells().div_ceil(64);
        let n_gates = network.gates.len();
        let all = (n_gates.saturating_mul(width) > MOST_FRONT_WORDS).then(|| vec![u64::MAX; width].into_boxed_slice());
        Self { network, rows: vec![None; if all.is_some() { 0 } else { n_gates }], all }
    }
}

impl Fronts for Front<'_> {
    fn row(&mut self, gate: u32) -> &[u64] {
        let network = self.network;
        match &self.all {
            Some(all) => all,
            None => self.rows[gate as usize].get_or_insert_with(|| row(network, gate)),
        }
    }
}

/// A bit for each cell whose box has a corner strictly in front of a gate. Exact.
fn row(network: &PlanarNetwork, gate: u32) -> Box<[u64]> {
    let [left, right] = network.ends[gate as usize];
    // The corner of a box that is farthest ahead, that is, to the left of the line from the left end to the right end.
    let ahead = |[low, high]: [[f64; 2]; 2]| {
        let x = if right[1] < left[1] { high[0] } else { low[0] };
        let y = if right[0] > left[0] { high[1] } else { low[1] };
        [x, y]
    };
    let bit = |b: &[[f64; 2]; 2]| u64::from(turn(left, right, ahead(*b)) == Ordering::Greater);
    let word = |boxes: &[[[f64; 2]; 2]]| boxes.iter().enumerate().fold(0, |word, (i, b)| word | bit(b) << i);
    network.boxes.chunks(64).map(word).collect()
}
