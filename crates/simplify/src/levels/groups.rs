//! Cells that share a level, merged one after the other.

use sightlines_pvs::{CellId, Table};
use std::collections::{BTreeMap, BTreeSet};

/// A set of faces.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Bits(Vec<u64>);

impl Bits {
    pub(super) fn new(n: usize) -> Self {
        Self(vec![0; n.div_ceil(64)])
    }

    pub(super) fn of(flags: &[bool]) -> Self {
        let mut bits = Self::new(flags.len());
        (0u32..).zip(flags).filter(|(_, flag)| **flag).for_each(|(face, _)| bits.set(face, true));
        bits
    }

    pub(super) fn flags(&self, n: usize) -> Vec<bool> {
        (0..n).map(|face| self.0[face / 64] >> (face % 64) & 1 == 1).collect()
    }

    pub(super) fn set(&mut self, face: u32, to: bool) {
        let (word, bit) = (&mut self.0[face as usize / 64], 1 << (face % 64));
        *word = if to { *word | bit } else { *word & !bit };
    }

    fn count(&self) -> u64 {
        self.0.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    fn count_with(&self, other: &Self) -> u64 {
        self.0.iter().zip(&other.0).map(|(a, b)| u64::from((a | b).count_ones())).sum()
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a |= b);
    }
}

/// Cells that share their remaining faces.
struct Group {
    cells: Vec<CellId>,
    kept: Bits,
    n_kept: u64,
    /// Groups with which it may be merged.
    near: BTreeSet<usize>,
}

/// A partition of the cells.
pub(super) struct Groups {
    /// `None` where one was merged into another.
    all: Vec<Option<Group>>,
    /// Pairs that may be merged, by the increase of stored triangles.
    pairs: BTreeSet<(i64, usize, usize)>,
    bytes_per_triangle: u64,
}

impl Groups {
    /// Each cell by itself. Two cells may be merged if a portal joins them, or if they are consecutive in the table.
    pub(super) fn new(table: &Table, kept: Vec<Bits>, bytes_per_triangle: u64) -> Self {
        let n = kept.len();
        let mut near = vec![BTreeSet::new(); n];
        let mut join = |a: usize, b: usize| {
            if a != b {
                near[a].insert(b);
                near[b].insert(a);
            }
        };
        (1..n).for_each(|cell| join(cell - 1, cell));
        table.portals().iter().for_each(|p| join(p.cells[0].idx(), p.cells[1].idx()));
        let group = |((cell, kept), near): ((u32, Bits), BTreeSet<usize>)| {
            Some(Group { cells: vec![CellId(cell)], n_kept: kept.count(), kept, near })
        };
        let all: Vec<Option<Group>> = (0..).zip(kept).zip(near).map(group).collect();
        let mut groups = Self { all, pairs: BTreeSet::new(), bytes_per_triangle };
        for a in 0..n {
            let later: Vec<usize> = groups.group(a).near.iter().copied().filter(|b| *b > a).collect();
            later.into_iter().for_each(|b| groups.offer(a, b));
        }
        groups
    }

    fn group(&self, id: usize) -> &Group {
        self.all[id].as_ref().expect("only existing groups are looked up")
    }

    /// The cost of a merge: triangles of the union, minus those of both.
    fn cost(&self, a: usize, b: usize) -> i64 {
        let (a, b) = (self.group(a), self.group(b));
        a.kept.count_with(&b.kept) as i64 - a.n_kept as i64 - b.n_kept as i64
    }

    fn offer(&mut self, a: usize, b: usize) {
        self.pairs.insert((self.cost(a, b), a.min(b), a.max(b)));
    }

    pub(super) fn n_bytes(&self) -> u64 {
        self.all.iter().flatten().map(|g| g.n_kept).sum::<u64>().saturating_mul(self.bytes_per_triangle)
    }

    pub(super) fn cells(&self) -> BTreeSet<Vec<CellId>> {
        self.all.iter().flatten().map(|g| g.cells.clone()).collect()
    }

    /// Merges all groups with equal faces.
    pub(super) fn merge_equal(&mut self) {
        let mut first: BTreeMap<Bits, usize> = BTreeMap::new();
        for id in 0..self.all.len() {
            let kept = self.group(id).kept.clone();
            match first.get(&kept) {
                Some(&other) => self.merge(other, id),
                None => drop(first.insert(kept, id)),
            }
        }
    }

    /// Merges the two that save most; returns whether there were two.
    pub(super) fn merge_cheapest(&mut self) -> bool {
        match self.pairs.first() {
            Some(&(_, a, b)) => {
                self.merge(a, b);
                true
            }
            None => false,
        }
    }

    fn merge(&mut self, a: usize, b: usize) {
        for id in [a, b] {
            let near: Vec<usize> = self.group(id).near.iter().copied().collect();
            for other in near {
                let pair = (self.cost(id, other), id.min(other), id.max(other));
                self.pairs.remove(&pair);
            }
        }
        let Some(gone) = self.all[b].take() else { return };
        let into = self.all[a].as_mut().expect("only groups that are there are merged");
        into.cells.extend(gone.cells);
        into.cells.sort_unstable();
        into.kept.add(&gone.kept);
        into.n_kept = into.kept.count();
        into.near.extend(&gone.near);
        into.near.retain(|&id| id != a && id != b);
        let near: Vec<usize> = into.near.iter().copied().collect();
        for other in near {
            if let Some(other) = self.all[other].as_mut() {
                other.near.remove(&b);
                other.near.insert(a);
            }
            self.offer(a, other);
        }
    }
}
