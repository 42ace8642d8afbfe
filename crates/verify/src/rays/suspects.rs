//! Which hidden pairs are the most suspicious: those with visible pairs next to them.

use super::seen::Seen;
use crate::oracle::RayOracle;
use crate::sight::Target;
use sightlines_geometry::Random;
use sightlines_pvs::{CellId, Table};
use std::cmp::Reverse;

/// A hidden pair to aim at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Suspect {
    pub(super) from: CellId,
    pub(super) target: Target,
    /// What the random numbers of its rays begin with, and its place among equally suspicious ones.
    pub(super) hash: u64,
    /// Whether all around both is visible.
    pub(super) is_surrounded: bool,
    /// How suspicious it is, in 2^-16.
    score: u32,
}

impl Suspect {
    fn new(from: u32, target: Target, score: f64) -> Self {
        Self {
            from: CellId(from),
            target,
            hash: hash_of(from, target),
            is_surrounded: score >= 2.0,
            score: (score * 65536.0) as u32,
        }
    }
}

/// A number for a pair, as good as random.
pub(super) fn hash_of(from: u32, target: Target) -> u64 {
    let other = match target {
        Target::Cell(to) => u64::from(to.0),
        Target::Object(object) => (1 << 31) | u64::from(object),
    };
    Random::new((u64::from(from) << 32) | other).bits()
}

/// Up to `n` hidden pairs, the most suspicious first; all of them if there are no more. Half of them are pairs of a cell and an object, if
/// there are so many of both kinds.
///
/// The share of the neighbours of the one that the other sees, and the other way round, summed.
pub(super) fn most<R: RayOracle>(world: &R, table: &Table, seen: &Seen, n: u64) -> Vec<Suspect> {
    let n_cells = table.n_cells();
    let n_objects = if table.parts().objects_seen.is_some() { table.objects().len() } else { 0 };
    let n_most = usize::try_from(n).unwrap_or(usize::MAX);
    let [mut best, mut best_objects] = [(); 2].map(|()| Best { list: Vec::new(), n: n_most });
    let next = world.neighbours();
    // With few pairs all are looked at; with many those next to visible ones.
    let pairs = (n_cells as u64) * (n_cells as u64 + n_objects as u64);
    let all = pairs <= 4_000_000;
    let share = |list: &[u32], sees: &dyn Fn(u32) -> bool| {
        let n_seen = list.iter().filter(|&&c| sees(c)).count();
        if list.is_empty() { 0.0 } else { n_seen as f64 / list.len() as f64 }
    };
    for a in 0..n_cells as u32 {
        let sees = |c: u32| table.sees(CellId(a), CellId(c));
        // Each pair once, unless the one may see the other that does not see it.
        let counts = |b: &u32| *b > a || *b < a && world.has_one_way();
        let mut candidates: Vec<u32> = if all {
            (0..n_cells as u32).filter(counts).collect()
        } else {
            table.visible(CellId(a)).flat_map(|c| next[c.idx()].iter().copied()).filter(counts).collect()
        };
        candidates.sort_unstable();
        candidates.dedup();
        candidates.retain(|&b| !sees(b));
        for b in candidates {
            let back = |c: u32| table.sees(CellId(b), CellId(c));
            let score = share(&next[b as usize], &sees) + share(&next[a as usize], &back);
            best.add(Suspect::new(a, Target::Cell(CellId(b)), score));
        }
    }
    if n_objects > 0 {
        let mut touched: Vec<Vec<u32>> = vec![Vec::new(); n_objects];
        for cell in 0..n_cells as u32 {
            table.objects_of(CellId(cell)).iter().for_each(|&o| touched[o.idx()].push(cell));
        }
        for a in 0..n_cells as u32 {
            let sees = |c: u32| table.sees(CellId(a), CellId(c));
            for o in (0..n_objects as u32).filter(|&o| !seen.has(CellId(a), Target::Object(o))) {
                let target = Target::Object(o);
                let by_neighbours = share(&next[a as usize], &|c| seen.has(CellId(c), target));
                let score = share(&touched[o as usize], &sees) + by_neighbours;
                if all || score > 0.0 {
                    best_objects.add(Suspect::new(a, target, score));
                }
            }
        }
    }
    let (mut cells, mut objects) = (best.done(), best_objects.done());
    let half = n_most / 2;
    objects.truncate(half.max(n_most.saturating_sub(cells.len())));
    cells.truncate(n_most - objects.len().min(n_most));
    // Which comes first changes nothing but the time; both kinds are in the order of suspicion.
    cells.append(&mut objects);
    cells
}

/// The best so far, and more until it is tidied up.
struct Best {
    list: Vec<Suspect>,
    n: usize,
}

impl Best {
    fn add(&mut self, suspect: Suspect) {
        self.list.push(suspect);
        if self.list.len() >= self.n.saturating_mul(4).max(1 << 16) {
            self.cut();
        }
    }

    fn cut(&mut self) {
        self.list.sort_unstable_by_key(|s| (Reverse(s.score), s.hash, s.from, s.target));
        self.list.truncate(self.n);
    }

    fn done(mut self) -> Vec<Suspect> {
        self.cut();
        self.list
    }
}
