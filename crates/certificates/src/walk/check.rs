//! The checker of proofs by lines and walks.

use super::decisions::{Decisions, Replay};
use super::{Ended, Network, Walk};
use crate::pairs::Pairs;
use crate::proven::{Proven, Refusal, joined_along};

/// One walk of a proof.
pub(crate) struct WalkProof<'a, B> {
    /// The cell that the walk starts from.
    pub(crate) source: u32,
    /// The cells to prove hidden from it; all that are neither visible, nor unproven, nor proven, if there are none.
    pub(crate) targets: &'a [u32],
    pub(crate) decisions: &'a Decisions<B>,
}

/// Checks lines, pairs that are left open, and walks, in this order. Exact.
pub(crate) fn check<'a, N: Network>(
    network: &N,
    lines: &[N::Line],
    unproven: &[[u32; 2]],
    walks: impl Iterator<Item = WalkProof<'a, N::Block>>,
) -> Result<Proven, Refusal>
where
    N::Block: 'a,
{
    let n = network.gates().n_cells();
    let visible = joined_along(n, lines, |line| network.cells_along(line), N::line_refusal)?;
    let mut open = Pairs::none(n);
    for (index, &[a, b]) in unproven.iter().enumerate() {
        if a >= b || b as usize >= n {
            return Err(Refusal::Pair { index });
        }
        open.add(a, b);
    }
    let mut walk = Walk::new(network.gates(), network.fronts());
    for (index, own) in walks.enumerate() {
        let from = own.source;
        if [from].iter().chain(own.targets).any(|&cell| cell as usize >= n) {
            return Err(Refusal::Source { walk: index, from });
        }
        let candidates = candidates(from, own.targets, [&visible, &open, walk.hidden()]);
        let mut replay = Replay::new(network, own.decisions);
        match walk.prove(from, &candidates, &mut replay, u64::MAX) {
            Ok(()) if replay.is_complete() => {}
            Ok(()) | Err(Ended::TooLong) => return Err(Refusal::Unused { walk: index, from }),
            Err(Ended::Stopped(block)) => return Err(Refusal::Block { walk: index, from, block }),
            Err(Ended::Entered(cell)) => return Err(Refusal::Entered { walk: index, from, cell }),
        }
    }
    Ok(Proven::new(visible, walk.into_hidden()))
}

/// The cells that remain to be proven hidden from `source`: those of `targets`, or all if there are none, without pairs
/// that are visible, left open, or proven hidden already (`settled`).
pub(super) fn candidates(source: u32, targets: &[u32], settled: [&Pairs; 3]) -> Vec<u64> {
    let n = settled[0].n_cells();
    let mut row = vec![if targets.is_empty() { u64::MAX } else { 0 }; n.div_ceil(64)];
    for &target in targets {
        row[target as usize / 64] |= 1 << (target % 64);
    }
    if let Some(last) = row.last_mut().filter(|_| !n.is_multiple_of(64)) {
        *last &= (1 << (n % 64)) - 1;
    }
    row[source as usize / 64] &= !(1 << (source % 64));
    for pairs in settled {
        row.iter_mut().zip(pairs.row(source)).for_each(|(word, out)| *word &= !out);
    }
    row
}
