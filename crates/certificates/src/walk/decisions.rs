//! The decisions of a walk, as proofs hold them, and the director that checks them.

use super::{Crossing, Director, Network};
use crate::bits::Bits;
use crate::bytes::{Coded, ReadError, ReadErrorKind, Reader, Writer};

/// The decisions of a walk, one for each gate that the rules of walks leave open, in the order of the walk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decisions<B> {
    /// Whether the chain continues through the gate.
    pub(crate) open: Bits,
    /// For each gate that ends its chain, why the chain is blocked.
    pub blocks: Vec<B>,
}

impl<B> Decisions<B> {
    /// Decisions from whether the chain continues through each gate, and the reasons for the gates that end it.
    pub fn new(open: &[bool], blocks: Vec<B>) -> Self {
        let mut bits = Bits::default();
        open.iter().for_each(|&bit| bits.push(bit));
        Self { open: bits, blocks }
    }

    /// Number of gates decided.
    pub fn n_gates(&self) -> usize {
        self.open.len()
    }

    /// Whether the chain continues through the `k`-th gate; `None` if there is no such gate.
    pub fn is_open(&self, k: usize) -> Option<bool> {
        self.open.get(k)
    }

    pub(super) fn continue_chain(&mut self) {
        self.open.push(true);
    }

    pub(super) fn end_chain(&mut self, block: B) {
        self.open.push(false);
        self.blocks.push(block);
    }
}

impl<B> Default for Decisions<B> {
    fn default() -> Self {
        Self { open: Bits::default(), blocks: Vec::new() }
    }
}

/// The number of bits and the bits, eight to a byte; then the blocks.
impl<B: Coded> Coded for Decisions<B> {
    const LEAST: usize = 2;

    fn write(&self, writer: &mut Writer) {
        writer.size(self.open.len());
        writer.bytes(self.open.bytes());
        writer.list(&self.blocks);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let n_bits = reader.number()? as usize;
        let bytes = reader.bytes(n_bits.div_ceil(8))?;
        let Some(open) = Bits::of(bytes, n_bits) else { return reader.fail(bytes.len(), ReadErrorKind::Number) };
        Ok(Self { open, blocks: reader.list()? })
    }
}

/// Repeats the decisions of a proof and checks each block. Stops with the index of the block that proves nothing.
pub(super) struct Replay<'a, N: Network> {
    network: &'a N,
    decisions: &'a Decisions<N::Block>,
    n_gates: usize,
    n_blocks: usize,
}

impl<'a, N: Network> Replay<'a, N> {
    pub(super) fn new(network: &'a N, decisions: &'a Decisions<N::Block>) -> Self {
        Self { network, decisions, n_gates: 0, n_blocks: 0 }
    }

    /// Whether every decision was used.
    pub(super) fn is_complete(&self) -> bool {
        self.n_gates == self.decisions.open.len() && self.n_blocks == self.decisions.blocks.len()
    }
}

impl<N: Network> Director for Replay<'_, N> {
    type Stop = usize;

    fn start(&mut self, _gate: u32) {}

    fn cross(&mut self, chain: &[u32], gate: u32) -> Result<Crossing, usize> {
        let open = self.decisions.open.get(self.n_gates).ok_or(self.n_blocks)?;
        self.n_gates += 1;
        if open {
            return Ok(Crossing::Open);
        }
        let block = self.decisions.blocks.get(self.n_blocks).ok_or(self.n_blocks)?;
        let gates = self.network.blocked_gates(block, chain, gate).ok_or(self.n_blocks)?;
        self.n_blocks += 1;
        Ok(Crossing::Blocked(gates))
    }

    fn back(&mut self) {}
}
