//! Smaller tables that show more: classes of cells are merged, cheapest first.
//!
//! A merged class sees what either class saw, and is seen from where either was seen; so rows and columns only gain
//! bits, the matrix stays symmetric, and a cell still sees itself.

use sightlines_pvs::BitMatrix;
use sightlines_pvs::bits::or_words;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How many following classes, in the order of cells, are tried as partners of a class.
const WINDOW: usize = 6;
/// The cost of a row besides its changes, in changed bits: its share of maps and of the block index.
const ROW_COST: u64 = 16;

/// The visibility of classes of cells, and its weight when drawn.
pub(crate) struct Sight<'a> {
    /// Class by class: symmetric, ones on the diagonal.
    pub(crate) cells: &'a BitMatrix,
    /// Classes by objects.
    pub(crate) objects: Option<&'a BitMatrix>,
    /// Number of cells of each class.
    pub(crate) n_members: &'a [u64],
    /// Weight of each class: polygons of the objects in its cells.
    pub(crate) weights: &'a [u64],
    /// Weight of each object.
    pub(crate) object_weights: &'a [u64],
}

/// The order in which to merge, down to one class: the class that remains, and the one merged into it.
///
/// The next merge is the one that adds the least weight for each changed bit saved, among classes that are neighbours
/// in the order of cells; ties go to the first. A price is recomputed only when it reaches the front of the queue, so a
/// price that fell meanwhile may be overlooked: the order is good, not optimal. O(classes * (window * words + ones of a
/// row)), and O(log) for each price.
pub(crate) fn merge_order(sight: &Sight<'_>) -> Vec<(u32, u32)> {
    let mut state = State::new(sight);
    let mut order = Vec::new();
    while state.n_alive > 1 {
        // The queue is used up; at least neighbours can still be merged.
        state.queue_all();
        while let Some(Reverse((price, a, b))) = state.queue.pop() {
            let (p, q) = (a as usize, b as usize);
            if !(state.alive[p] && state.alive[q]) {
                continue;
            }
            let now = state.price(p, q);
            if now > price {
                state.queue.push(Reverse((now, a, b)));
                continue;
            }
            state.merge(p, q);
            order.push((a, b));
            state.queue_around(p);
        }
    }
    order
}

/// The class of each after the first `n` merges, and the number of classes; numbered by first members.
pub(crate) fn after(order: &[(u32, u32)], n: usize, n_classes: usize) -> (Vec<u32>, usize) {
    let mut into: Vec<u32> = (0..n_classes as u32).collect();
    order[..n].iter().for_each(|&(stays, goes)| into[goes as usize] = stays);
    let mut number = vec![u32::MAX; n_classes];
    let mut n_left = 0u32;
    let mut of = Vec::with_capacity(n_classes);
    for class in 0..n_classes {
        let mut root = class;
        while into[root] as usize != root {
            root = into[root] as usize;
        }
        into[class] = root as u32;
        if number[root] == u32::MAX {
            number[root] = n_left;
            n_left += 1;
        }
        of.push(number[root]);
    }
    (of, n_left as usize)
}

/// The rows of merged classes: `of` gives the new class of each. Merges columns too if `square`.
pub(crate) fn merged(bits: &BitMatrix, of: &[u32], n_left: usize, square: bool) -> BitMatrix {
    let mut rows = BitMatrix::new(n_left, bits.n_cols());
    for (class, &into) in of.iter().enumerate() {
        or_words(rows.row_mut(into as usize), bits.row(class));
    }
    if !square {
        return rows;
    }
    let mut out = BitMatrix::new(n_left, n_left);
    for p in 0..n_left {
        rows.iter_ones(p).for_each(|q| out.set(p, of[q] as usize, true));
        // Merged cells see each other, even if none did.
        out.set(p, p, true);
    }
    out
}

/// A price, ordered; all prices are non-negative.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Price(f64);

impl Eq for Price {}

impl PartialOrd for Price {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Price {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

struct State<'a> {
    sight: &'a Sight<'a>,
    cells: BitMatrix,
    objects: Option<BitMatrix>,
    n_members: Vec<u64>,
    weights: Vec<u64>,
    alive: Vec<bool>,
    n_alive: usize,
    /// The remaining class before and after each, or `usize::MAX`.
    before: Vec<usize>,
    after: Vec<usize>,
    queue: BinaryHeap<Reverse<(Price, u32, u32)>>,
}

impl<'a> State<'a> {
    fn new(sight: &'a Sight<'a>) -> Self {
        let n = sight.cells.n_rows();
        Self {
            sight,
            cells: sight.cells.clone(),
            objects: sight.objects.cloned(),
            n_members: sight.n_members.to_vec(),
            weights: sight.weights.to_vec(),
            alive: vec![true; n],
            n_alive: n,
            before: (0..n).map(|i| i.wrapping_sub(1)).collect(),
            after: (0..n).map(|i| if i + 1 < n { i + 1 } else { usize::MAX }).collect(),
            queue: BinaryHeap::new(),
        }
    }

    fn push(&mut self, p: usize, q: usize) {
        let price = self.price(p, q);
        self.queue.push(Reverse((price, p as u32, q as u32)));
    }

    fn queue_all(&mut self) {
        for p in 0..self.alive.len() {
            if self.alive[p] {
                self.queue_after(p);
            }
        }
    }

    fn queue_after(&mut self, p: usize) {
        let mut q = p;
        for _ in 0..WINDOW {
            q = self.after[q];
            if q == usize::MAX {
                return;
            }
            self.push(p, q);
        }
    }

    fn queue_around(&mut self, p: usize) {
        self.queue_after(p);
        let mut q = p;
        for _ in 0..WINDOW {
            q = self.before[q];
            if q == usize::MAX {
                return;
            }
            self.push(q, p);
        }
    }

    /// Weight added for each changed bit saved by merging `q` into `p`, which comes before it.
    fn price(&self, p: usize, q: usize) -> Price {
        // The additional objects and cells times their viewers, from both ends of the new sight lines.
        let sums = |from: &[u64], without: &[u64]| {
            let (mut weight, mut n) = (0u64, 0u64);
            for (k, (a, b)) in from.iter().zip(without).enumerate() {
                for r in ones_of(a & !b) {
                    weight = weight.saturating_add(self.weights[64 * k + r]);
                    n = n.saturating_add(self.n_members[64 * k + r]);
                }
            }
            (weight as f64, n as f64)
        };
        let (row_p, row_q) = (self.cells.row(p), self.cells.row(q));
        let gain = |class: usize, (weight, n): (f64, f64)| {
            self.n_members[class] as f64 * weight + self.weights[class] as f64 * n
        };
        let mut cost = gain(q, sums(row_p, row_q)) + gain(p, sums(row_q, row_p));
        let prior = self.before[q];
        let changes = |bits: &BitMatrix| {
            let other = if prior == usize::MAX { None } else { Some(bits.row(prior)) };
            let row = bits.row(q);
            let bits = |k: usize| (row[k] ^ other.map_or(0, |other| other[k])).count_ones();
            (0..row.len()).map(|k| u64::from(bits(k))).sum::<u64>()
        };
        let mut saved = ROW_COST + changes(&self.cells);
        if let Some(objects) = &self.objects {
            let weight = |from: usize, without: usize| {
                let pairs = objects.row(from).iter().zip(objects.row(without)).enumerate();
                let seen = pairs.flat_map(|(k, (a, b))| ones_of(a & !b).map(move |r| 64 * k + r));
                seen.map(|o| self.sight.object_weights[o] as f64).sum::<f64>()
            };
            cost += self.n_members[q] as f64 * weight(p, q) + self.n_members[p] as f64 * weight(q, p);
            saved += changes(objects);
        }
        Price(cost / saved as f64)
    }

    fn merge(&mut self, p: usize, q: usize) {
        self.cells.or_into(p, q);
        self.cells.set(p, p, true);
        self.cells.set(p, q, false);
        let seers: Vec<usize> = self.cells.iter_ones(p).collect();
        for r in seers {
            self.cells.set(r, p, true);
            self.cells.set(r, q, false);
        }
        if let Some(objects) = &mut self.objects {
            objects.or_into(p, q);
        }
        self.n_members[p] += self.n_members[q];
        self.weights[p] = self.weights[p].saturating_add(self.weights[q]);
        self.alive[q] = false;
        self.n_alive -= 1;
        let (before, after) = (self.before[q], self.after[q]);
        if before != usize::MAX {
            self.after[before] = after;
        }
        if after != usize::MAX {
            self.before[after] = before;
        }
    }
}

/// The places of the ones of a word.
fn ones_of(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros() as usize;
        (word != 0).then(|| word &= word - 1)?;
        Some(bit)
    })
}

#[cfg(test)]
mod tests;
