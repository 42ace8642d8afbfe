//! A canonical order for equal trees.

use super::{Bits, StabTrees, count, ends};
use crate::records::PortalRecord;

/// A node that has no number yet.
struct Entry {
    /// The first sort key, before the children.
    into: u32,
    open: bool,
    /// Its children, by their new numbers, ascending: a range of the scratch.
    children: std::ops::Range<usize>,
    gate: u32,
    old: u32,
}

/// The same trees with each node once, without unreachable nodes, in the order that [`StabTrees`] describes.
///
/// Level by level, from the leaves: when a level is processed, its nodes' children already have their numbers, so equal
/// nodes have equal lists, and are adjacent when the level is sorted.
pub(super) fn ordered(given: &StabTrees, portals: &[PortalRecord]) -> StabTrees {
    let levels = levels(given);
    let mut number = vec![u32::MAX; given.n_nodes()];
    let mut out = StabTrees { first_child: vec![0], first_root: vec![0], ..StabTrees::default() };
    let mut scratch: Vec<u32> = Vec::new();
    for level in levels {
        scratch.clear();
        let entry = |old: u32| {
            let begin = scratch.len();
            scratch.extend(given.children(old).iter().map(|&c| number[c as usize]));
            scratch[begin..].sort_unstable();
            // Different nodes may have become equal.
            let mut end = begin;
            for i in begin..scratch.len() {
                if i == begin || scratch[i] != scratch[end - 1] {
                    scratch[end] = scratch[i];
                    end += 1;
                }
            }
            scratch.truncate(end);
            let gate = given.gates[old as usize];
            Entry { into: ends(portals, gate)[1].0, open: given.is_open(old), children: begin..end, gate, old }
        };
        let mut entries: Vec<Entry> = level.into_iter().map(entry).collect();
        entries.sort_unstable_by(|a, b| key(a, &scratch).cmp(&key(b, &scratch)));
        for (i, entry) in entries.iter().enumerate() {
            let (before, this) = (i.checked_sub(1).map(|i| key(&entries[i], &scratch)), key(entry, &scratch));
            if before.is_none_or(|before| before.0 != this.0) {
                out.children.extend_from_slice(this.0.2);
                out.first_child.push(count(out.children.len()));
                out.open.push(entry.open);
            }
            if before != Some(this) {
                out.gates.push(entry.gate);
                out.after.push(count(out.open.len() - 1));
            }
            number[entry.old as usize] = count(out.gates.len() - 1);
        }
    }
    let mut roots: Vec<u32> = Vec::new();
    for cell in 0..given.n_cells() {
        let (from, to) = (given.first_root[cell] as usize, given.first_root[cell + 1] as usize);
        roots.clear();
        roots.extend(given.roots[from..to].iter().map(|&root| number[root as usize]));
        roots.sort_unstable();
        roots.dedup();
        out.roots.extend_from_slice(&roots);
        out.first_root.push(count(out.roots.len()));
    }
    out.root_open = Bits::clone(&given.root_open);
    out
}

/// The key that determines whether nodes share a list, then the key that distinguishes them.
fn key<'a>(entry: &Entry, scratch: &'a [u32]) -> ((u32, bool, &'a [u32]), u32) {
    ((entry.into, entry.open, &scratch[entry.children.clone()]), entry.gate)
}

/// The reachable nodes, by their height: 0 for those without children.
fn levels(given: &StabTrees) -> Vec<Vec<u32>> {
    let n = given.n_nodes();
    let mut reached = vec![false; n];
    given.roots.iter().for_each(|&root| reached[root as usize] = true);
    for k in (0..n).rev() {
        if reached[k] {
            given.children(k as u32).iter().for_each(|&child| reached[child as usize] = true);
        }
    }
    let mut height = vec![0usize; n];
    let mut levels: Vec<Vec<u32>> = Vec::new();
    for k in (0..n).filter(|&k| reached[k]) {
        height[k] = given.children(k as u32).iter().map(|&c| height[c as usize] + 1).max().unwrap_or(0);
        if height[k] == levels.len() {
            levels.push(Vec::new());
        }
        levels[height[k]].push(k as u32);
    }
    levels
}
