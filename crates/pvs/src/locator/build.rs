//! Builds a locator over boxes.

use super::{Locator, Node, goes_high, goes_low};
use crate::CellId;

/// A node with no more boxes than this is a leaf.
const LEAF: usize = 8;

impl Locator {
    /// Builds a complete locator over boxes `(min, max)`, box `i` for cell `i`, in the first
    /// `dimension` coordinates. Deterministic.
    ///
    /// Splits at the median of the boxes' faces, on the axis with the smaller larger half, as long as that divides
    /// anything. Boxes on both sides of a split are listed on both; this adds at most three times as many entries as
    /// boxes. O(n log n) time, depth O(log n).
    ///
    /// # Panics
    /// If there are more than 2^29 boxes: no table has so many cells.
    pub fn build(bounds: &[([f64; 3], [f64; 3])], dimension: u8) -> Self {
        assert!(bounds.len() <= 1 << 29, "{} boxes are more than a locator can hold", bounds.len());
        let all = (0..bounds.len() as u32).collect();
        let depth = 2 * (usize::BITS - bounds.len().leading_zeros()) + 4;
        let n_axes = usize::from(dimension).min(3);
        let mut builder = Builder { bounds, n_axes, out: Self { nodes: Vec::new(), cells: Vec::new() } };
        let region = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        builder.node(all, region, depth, 3 * bounds.len());
        builder.out
    }
}

struct Builder<'a> {
    bounds: &'a [([f64; 3], [f64; 3])],
    n_axes: usize,
    out: Locator,
}

/// A division of some boxes.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    at: f64,
    n_low: usize,
    n_high: usize,
}

impl Builder<'_> {
    /// Writes the subtree over `ids` (ascending), whose region is the box `region`, no deeper than
    /// `depth` and with no more than `spare` entries besides one for each id.
    fn node(&mut self, ids: Vec<u32>, region: ([f64; 3], [f64; 3]), depth: u32, spare: usize) {
        let split = if ids.len() <= LEAF || depth == 0 { None } else { self.best_split(&ids, &region, spare) };
        let Some(Split { axis, at, n_low, n_high }) = split else {
            let start = self.out.cells.len() as u32;
            self.out.cells.extend(ids.into_iter().map(CellId));
            self.out.nodes.push(Node::Leaf { start, end: self.out.cells.len() as u32 });
            return;
        };
        let spare = spare - (n_low + n_high - ids.len());
        // 2^29 boxes give at most 2^31 entries, so the product fits 64 bits.
        let spare_low = (spare as u64 * n_low as u64 / (n_low + n_high) as u64) as usize;
        let (low, high) = self.divide(&ids, axis, at);
        drop(ids);
        let here = self.out.nodes.len();
        self.out.nodes.push(Node::Inner { axis: axis as u8, split: at, high: 0 });
        let (mut below, mut above) = (region, region);
        below.1[axis] = at;
        above.0[axis] = at;
        self.node(low, below, depth - 1, spare_low);
        let next = self.out.nodes.len() as u32;
        if let Node::Inner { high, .. } = &mut self.out.nodes[here] {
            *high = next;
        }
        self.node(high, above, depth - 1, spare - spare_low);
    }

    fn best_split(&self, ids: &[u32], region: &([f64; 3], [f64; 3]), spare: usize) -> Option<Split> {
        let n = ids.len();
        let useful = |s: &Split| {
            let added = s.n_low + s.n_high - n;
            s.n_low < n && s.n_high < n && added <= spare && added <= n / 2
        };
        let splits = (0..self.n_axes).filter_map(|axis| self.median_split(ids, region, axis));
        splits.filter(useful).min_by_key(|s| (s.n_low.max(s.n_high), s.n_low + s.n_high, s.axis))
    }

    /// Splits at the median of the faces strictly inside the region.
    fn median_split(&self, ids: &[u32], region: &([f64; 3], [f64; 3]), axis: usize) -> Option<Split> {
        let bounds = |&id: &u32| (self.bounds[id as usize].0[axis], self.bounds[id as usize].1[axis]);
        let inside = |x: &f64| region.0[axis] < *x && *x < region.1[axis];
        let mut faces: Vec<f64> = ids.iter().map(bounds).flat_map(|(min, max)| [min, max]).filter(inside).collect();
        if faces.is_empty() {
            return None;
        }
        let middle = faces.len() / 2;
        let at = *faces.select_nth_unstable_by(middle, f64::total_cmp).1;
        let n_low = ids.iter().map(bounds).filter(|&(min, max)| goes_low(min, max, at)).count();
        let n_high = ids.iter().map(bounds).filter(|&(_, max)| goes_high(max, at)).count();
        Some(Split { axis, at, n_low, n_high })
    }

    fn divide(&self, ids: &[u32], axis: usize, at: f64) -> (Vec<u32>, Vec<u32>) {
        let bounds = |id: u32| (self.bounds[id as usize].0[axis], self.bounds[id as usize].1[axis]);
        let low = ids.iter().copied().filter(|&id| goes_low(bounds(id).0, bounds(id).1, at)).collect();
        let high = ids.iter().copied().filter(|&id| goes_high(bounds(id).1, at)).collect();
        (low, high)
    }
}
