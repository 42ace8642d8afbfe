//! Columns: a region divided by equal steps along both horizontal axes, and what is around it.

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
    /// Between which lines cells may be. Columns before and after are around the region.
    inner: [Range<usize>; 2],
    /// Between which heights cells may be.
    pub(super) within: [f64; 2],
    /// Lowest and highest of all that is drawn, and of the region if it ends.
    heights: [f64; 2],
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
    pub(super) fn new(region: &Aabb<3>, all: &Aabb<3>, up: usize, cell_size: f64) -> Option<Self> {
        let axes = horizontal(up);
        let [(first, inner_first), (second, inner_second)] = axes.map(|k| {
            let (low, side) = (region.min[k], region.max[k] - region.min[k]);
            let n = (side / cell_size).ceil().clamp(1.0, MOST_LINES);
            let mut lines: Vec<f64> = (0..n as u32).map(|i| low + side * (f64::from(i) / n)).collect();
            lines.push(region.max[k]);
            let before = usize::from(all.min[k] < low);
            let inner = before..before + lines.len() - 1;
            if before > 0 {
                lines.insert(0, all.min[k]);
            }
            if all.max[k] > region.max[k] {
                lines.push(all.max[k]);
            }
            (lines.iter().map(|x| x + 0.0).collect::<Vec<f64>>(), inner)
        });
        let (within, inner) = ([region.min[up], region.max[up]], [inner_first, inner_second]);
        let end =
            |region: f64, all: f64, of: fn(f64, f64) -> f64| if region.is_finite() { of(region, all) } else { all };
        let heights = [end(within[0], all.min[up], f64::min), end(within[1], all.max[up], f64::max)];
        let grid = Self { up, axes, lines: [first, second], inner, within, heights };
        let ascends = grid.lines.iter().all(|lines| lines.windows(2).all(|pair| pair[0] < pair[1]));
        let fits = axes.iter().all(|&k| region.max[k] - region.min[k] <= cell_size * MOST_LINES);
        (ascends && fits && grid.n(0) * grid.n(1) <= MOST_COLUMNS).then_some(grid)
    }

    /// Number of columns along one of the horizontal axes.
    pub(super) fn n(&self, k: usize) -> usize {
        self.lines[k].len() - 1
    }

    /// The columns along a horizontal axis in which cells may be and that meet an interval.
    pub(super) fn meeting(&self, k: usize, low: f64, high: f64) -> Range<usize> {
        let (lines, inner) = (&self.lines[k], &self.inner[k]);
        let start = lines.partition_point(|&x| x <= low).saturating_sub(1).max(inner.start);
        let end = lines.partition_point(|&x| x < high).min(inner.end);
        start..end.max(start)
    }

    /// The box from one line to another along both horizontal axes, between two heights.
    pub(super) fn bounding(&self, columns: &[Range<usize>; 2], heights: [f64; 2]) -> Aabb<3> {
        let mut b = Aabb::EMPTY;
        for ((&axis, lines), of) in self.axes.iter().zip(&self.lines).zip(columns) {
            (b.min[axis], b.max[axis]) = (lines[of.start], lines[of.end]);
        }
        (b.min[self.up], b.max[self.up]) = (heights[0], heights[1]);
        b
    }

    /// The box around everything: all that is drawn, the region, and these heights.
    pub(super) fn bounds(&self, [low, high]: [f64; 2]) -> Aabb<3> {
        let heights = [self.heights[0].min(low) + 0.0, self.heights[1].max(high) + 0.0];
        self.bounding(&[0..self.n(0), 0..self.n(1)], heights)
    }
}
