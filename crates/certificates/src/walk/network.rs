//! What walks need of the cells and gates that they are about.

use super::Fronts;
use crate::graph::Gates;
use crate::proven::Refusal;

/// Cells and gates about which lines and walks prove something: all that differs between plans and maps. Only this crate
/// implements it.
pub trait Network {
    /// A line that proves pairs visible.
    type Line;
    /// A reason why a chain of gates is blocked.
    type Block;
    /// A walk of a proof.
    type Walk;
    /// Which cells lie in front of gates.
    type Fronts<'a>: Fronts
    where
        Self: 'a;

    /// The graph of cells and gates.
    fn gates(&self) -> &Gates;

    /// The rows of cells in front of gates.
    fn fronts(&self) -> Self::Fronts<'_>;

    /// The cells that a line passes: an open set of lines joins any two of them. Empty if the line proves nothing.
    fn cells_along(&self, line: &Self::Line) -> Vec<u32>;

    /// The refusal of a line that proves nothing.
    fn line_refusal(index: usize, line: &Self::Line) -> Refusal;

    /// The gates of a chain that, together with `gate` behind it, no open set of lines passes, by a block. They are in the
    /// order of the chain where order counts ([`Fronts::IS_ORDERED`]), else ascending. `None` if the block proves nothing.
    fn blocked_gates(&self, block: &Self::Block, chain: &[u32], gate: u32) -> Option<Vec<u32>>;
}

/// The gate that a block names by its number: 0 is the gate that the chain comes to, `k` the `k`-th from the end of the
/// chain. `None` if the chain is too short.
pub(crate) fn gate_back(chain: &[u32], gate: u32, back: u32) -> Option<u32> {
    match back {
        0 => Some(gate),
        back => chain.len().checked_sub(back as usize).map(|k| chain[k]),
    }
}
