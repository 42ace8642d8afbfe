//! Boxes of cells, and fillers: boxes that tile the rest.

use super::grid::Grid;
use sightlines_geometry::Aabb;
use std::ops::Range;

/// A gap between cells that is thinner than this share of the height of eyes is left to the parts of a block: it is likely to be thicker there.
const THIN: f64 = 0.25;

/// Cells of a square block of columns: at the lowest level one column, above it two by two blocks. For each block, heights between which
/// there are cells somewhere in it, ascending.
struct Level {
    n: [usize; 2],
    blocks: Vec<Vec<[f64; 2]>>,
}

/// A filler: columns and heights.
#[derive(Debug, Clone, PartialEq)]
struct Filler {
    columns: [Range<usize>; 2],
    heights: [f64; 2],
}

/// A block and heights in it.
struct Part {
    level: usize,
    at: [usize; 2],
    heights: [f64; 2],
}

/// The cells as boxes: blocks of columns one after another, within a column from low to high.
pub(super) fn cells(grid: &Grid, columns: &[Vec<[f64; 2]>]) -> Vec<Aabb<3>> {
    let n = grid.n(0);
    let mut order: Vec<usize> = (0..columns.len()).filter(|&i| !columns[i].is_empty()).collect();
    order.sort_by_key(|&i| interleaved(i % n) | interleaved(i / n) << 1);
    let boxes = |i: usize| {
        let [x, y] = [i % n, i / n];
        columns[i].iter().map(move |&heights| grid.bounding(&[x..x + 1, y..y + 1], heights))
    };
    order.into_iter().flat_map(boxes).collect()
}

/// The bits of a number with a 0 before each of them.
fn interleaved(x: usize) -> u64 {
    (0..32).map(|bit| (x as u64 >> bit & 1) << (2 * bit)).sum()
}

/// Boxes that tile what is between the heights and is in no cell.
///
/// Where a block of columns has a gap at the same heights in all of them, that is one filler; what is left of the block is done in its four parts.
/// In the end fillers that are a box together are joined.
///
/// * `tall`: the height of eyes
pub(super) fn fillers(grid: &Grid, columns: &[Vec<[f64; 2]>], heights: [f64; 2], tall: f64) -> Vec<Aabb<3>> {
    let levels = levels([grid.n(0), grid.n(1)], columns, THIN * tall);
    let mut fillers = Vec::new();
    let mut pending = vec![Part { level: levels.len() - 1, at: [0, 0], heights }];
    while let Some(Part { level, at: [x, y], heights: [low, high] }) = pending.pop() {
        let Level { n, blocks } = &levels[level];
        let side = 1usize << level;
        let of = |at: usize, k: usize| at * side..((at + 1) * side).min(grid.n(k));
        let mut fill = |from: f64, to: f64| {
            if from < to {
                fillers.push(Filler { columns: [of(x, 0), of(y, 1)], heights: [from, to] });
            }
        };
        let mut from = low;
        let all = &blocks[y * n[0] + x];
        let start = all.partition_point(|of| of[1] <= low);
        for &[a, b] in all[start..].iter().take_while(|of| of[0] < high) {
            fill(from, a);
            from = b;
            if let Some(below) = level.checked_sub(1) {
                let parts = (0..4).map(|i| [2 * x + i % 2, 2 * y + i / 2]);
                let parts = parts.filter(|at| at[0] < levels[below].n[0] && at[1] < levels[below].n[1]);
                pending.extend(parts.map(|at| Part { level: below, at, heights: [a, b] }));
            }
        }
        fill(from, high);
    }
    join(&mut fillers);
    fillers.iter().map(|filler| grid.bounding(&filler.columns, filler.heights)).collect()
}

/// Blocks of columns up to one that has all.
fn levels(n: [usize; 2], columns: &[Vec<[f64; 2]>], thin: f64) -> Vec<Level> {
    let mut levels = vec![Level { n, blocks: columns.to_vec() }];
    while let Some(Level { n, blocks }) = levels.last().filter(|level| level.n != [1, 1]) {
        let above = n.map(|n| n.div_ceil(2));
        let block = |i: usize| {
            let (x, y) = (2 * (i % above[0]), 2 * (i / above[0]));
            let parts = (0..4).map(|k| [x + k % 2, y + k / 2]).filter(|at| at[0] < n[0] && at[1] < n[1]);
            let mut all: Vec<[f64; 2]> = parts.flat_map(|[x, y]| blocks[y * n[0] + x].iter().copied()).collect();
            all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
            let mut joined: Vec<[f64; 2]> = Vec::new();
            for [low, high] in all {
                match joined.last_mut() {
                    Some(last) if low - last[1] < thin => last[1] = last[1].max(high),
                    _ => joined.push([low, high]),
                }
            }
            joined
        };
        let blocks = (0..above[0] * above[1]).map(block).collect();
        levels.push(Level { n: above, blocks });
    }
    levels
}

/// Joins fillers that are a box together, along each axis in turn as long as there are some.
fn join(fillers: &mut Vec<Filler>) {
    loop {
        let before = fillers.len();
        for k in 0..2 {
            let key = |f: &Filler| (f.columns[1 - k].start, f.columns[1 - k].end, f.columns[k].start);
            fillers.sort_by(|f, g| by_heights(f, g).then(key(f).cmp(&key(g))));
            fillers.dedup_by(|f, last| {
                let fits = f.heights == last.heights
                    && f.columns[1 - k] == last.columns[1 - k]
                    && last.columns[k].end == f.columns[k].start;
                if fits {
                    last.columns[k].end = f.columns[k].end;
                }
                fits
            });
        }
        let key = |f: &Filler| f.columns.clone().map(|of| (of.start, of.end));
        fillers.sort_by(|f, g| key(f).cmp(&key(g)).then(by_heights(f, g)));
        fillers.dedup_by(|f, last| {
            let fits = f.columns == last.columns && last.heights[1] == f.heights[0];
            if fits {
                last.heights[1] = f.heights[1];
            }
            fits
        });
        if fillers.len() == before {
            return;
        }
    }
}

fn by_heights(f: &Filler, g: &Filler) -> std::cmp::Ordering {
    f.heights[0].total_cmp(&g.heights[0]).then(f.heights[1].total_cmp(&g.heights[1]))
}
