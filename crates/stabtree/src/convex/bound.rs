//! The first bound: what may be seen through a gate, by the planes of portals alone.

use super::gates::Gates;

/// The cells reached from behind the gate through gates that a line may pass after it, judging by the two planes alone
/// ([`Gates::may_follow`]); a row of bits. O(gates reached).
///
/// Source: the first step of Quake's vis.
pub(super) fn seen_through(gates: &Gates, gate: u32) -> Vec<u64> {
    let mut row = vec![0u64; gates.n_cells().div_ceil(64)];
    let home = gates.get(gate).from;
    let mut waiting = vec![gates.get(gate).to];
    let has = |row: &[u64], cell: u32| row[cell as usize / 64] >> (cell % 64) & 1 == 1;
    while let Some(cell) = waiting.pop() {
        if has(&row, cell) {
            continue;
        }
        row[cell as usize / 64] |= 1 << (cell % 64);
        for &exit in gates.exits(cell) {
            let to = gates.get(exit).to;
            if to != home && !has(&row, to) && gates.may_follow(gate, exit) {
                waiting.push(to);
            }
        }
    }
    row
}
