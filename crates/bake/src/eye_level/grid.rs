//! Columns: a region divided by equal steps along both horizontal axes.

use sightlines_geometry::Aabb;
use std::ops::Range;

/// Most lines along an axis.
const MOST_LINES: f64 = (1 << 16) as f64;

/// Most columns.
const MOST_COLUMNS: usize = 1 << 22;

/// Lines along two horizontal axes. Each coordinate is computed once, so boxes between lines fit to each other bit by bit.
pub(super) struct Grid {
    pub(super) up: usize,
    /// The two horizontal axes.
    pub(super) axes: [usize; 2],
    /// For each of them its lines, ascending.
    pub(super) lines: [Vec<f64>; 2],
    /// Between which heights cells may be.
    pub(super) within: [f64; 2],
}

/// The horizontal axes.
pub(super) fn horizontal(up: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][up]
}

/// Whether cells of that width are as wide as the region.
pub(super) fn is_one_column(region: &Aabb<3>, up: usize, cell_size: f64) -> bool {
    horizontal(up).iter().all(|&k| region.max[k] - region.min[k] <= cell_size)
}

impl Grid {
    /// None if there would be too many columns, or if doubles are too coarse for them.
    pub(super) fn new(region: &Aabb<3>, up: usize, cell_size: f64) -> Option<Self> {
        let axes = horizontal(up);
        let lines = axes.map(|k| {
            let (low, side) = (region.min[k], region.max[k] - region.min[k]);
            let n = (side / cell_size).ceil().clamp(1.0, MOST_LINES);
            let inner = (0..n as u32).map(|i| low + side * (f64::from(i) / n));
            inner.chain([region.max[k]]).map(|x| x + 0.0).collect::<Vec<f64>>()
        });
        let grid = Self { up, axes, lines, within: [region.min[up], region.max[up]] };
        let ascends = grid.lines.iter().all(|lines| lines.windows(2).all(|pair| pair[0] < pair[1]));
        let fits = axes.iter().all(|&k| region.max[k] - region.min[k] <= cell_size * MOST_LINES);
        (ascends && fits && grid.n(0) * grid.n(1) <= MOST_COLUMNS).then_some(grid)
    }

    /// Number of columns along one of the horizontal axes.
    pub(super) fn n(&self, k: usize) -> usize {
        self.lines[k].len() - 1
    }

    /// The columns along a horizontal axis that meet an interval.
    pub(super) fn meeting(&self, k: usize, low: f64, high: f64) -> Range<usize> {
        let lines = &self.lines[k];
        let start = lines.partition_point(|&x| x <= low).saturating_sub(1);
        let end = lines.partition_point(|&x| x < high).min(self.n(k));
        start..end.max(start)
    }

    /// The cells of all columns as boxes: blocks of columns one after another, within a column from low to high.
    ///
    /// * `columns`: for each column, the second axis first, the heights between which its cells are
    pub(super) fn cells(&self, columns: &[Vec<[f64; 2]>]) -> Vec<Aabb<3>> {
        let n = self.n(0);
        let mut order: Vec<usize> = (0..columns.len()).filter(|&i| !columns[i].is_empty()).collect();
        order.sort_by_key(|&i| interleaved(i % n) | interleaved(i / n) << 1);
        let boxes = |i: usize| columns[i].iter().map(move |&heights| self.cell([i % n, i / n], heights));
        order.into_iter().flat_map(boxes).collect()
    }

    fn cell(&self, place: [usize; 2], [low, high]: [f64; 2]) -> Aabb<3> {
        let mut b = Aabb::EMPTY;
        for ((&axis, lines), at) in self.axes.iter().zip(&self.lines).zip(place) {
            (b.min[axis], b.max[axis]) = (lines[at], lines[at + 1]);
        }
        (b.min[self.up], b.max[self.up]) = (low, high);
        b
    }
}

/// The bits of a number with a 0 before each of them.
fn interleaved(x: usize) -> u64 {
    (0..32).map(|bit| (x as u64 >> bit & 1) << (2 * bit)).sum()
}
