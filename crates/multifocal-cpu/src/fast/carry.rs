//! Least values over ranges of columns and rows, for all texels of a plane.

use rayon::prelude::*;
use sightlines_multifocal::{Buffer, Carry};

/// Memory that is used again.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    /// For each row of the plane before and each column of the next: the least over the column's range.
    least: Vec<u32>,
    /// Least over runs of rows.
    runs: Vec<u32>,
}

/// Fills `after` with what is carried over from `before`; 0 where nothing is.
pub(super) fn carry(carry: &Carry, before: &Buffer, after: &mut Buffer, scratch: &mut Scratch) {
    let width = carry.columns.len();
    let n_rows = before.texels()[1] as usize;
    scratch.least.clear();
    scratch.least.resize(width * n_rows, 0);
    let run = shortest(&carry.columns);
    scratch.least.par_chunks_mut(width).zip(before.values().par_chunks(before.texels()[0] as usize)).for_each_init(
        Vec::new,
        |runs, (least, row)| {
            runs.clear();
            runs.extend_from_slice(row);
            double(runs, 1, run);
            for (least, &[first, last]) in least.iter_mut().zip(&carry.columns) {
                *least = starts(first, last, run).map(|i| runs[i]).min().unwrap_or(0);
            }
        },
    );
    let run = shortest(&carry.rows);
    scratch.runs.clear();
    scratch.runs.extend_from_slice(&scratch.least);
    double(&mut scratch.runs, width, run);
    let runs = &scratch.runs;
    after.values_mut().par_chunks_mut(width).zip(&carry.rows).for_each(|(out, &[first, last])| {
        let mut starts = starts(first, last, run);
        let Some(start) = starts.next() else { return out.fill(0) };
        out.copy_from_slice(&runs[start * width..][..width]);
        for start in starts {
            out.iter_mut().zip(&runs[start * width..][..width]).for_each(|(v, &other)| *v = (*v).min(other));
        }
        out.iter_mut().for_each(|v| *v += if *v > 0 { carry.rise } else { 0 });
    });
}

/// The largest power of two that is no longer than any range that is not empty.
fn shortest(ranges: &[[u32; 2]]) -> usize {
    let least = ranges.iter().filter(|[first, last]| first <= last).map(|[first, last]| last - first + 1).min();
    least.map_or(1, |n| 1 << n.ilog2())
}

/// Where runs of length `run` start that together make up a range.
fn starts(first: u32, last: u32, run: usize) -> impl Iterator<Item = usize> {
    let (first, end) = (first as usize, last as usize + 1);
    let n = if first < end { (end - first).div_ceil(run) } else { 0 };
    (0..n).map(move |i| (first + i * run).min(end - run))
}

/// Replaces each value by the least of the `run` values from it on, `stride` apart; `run` is a power of two. What runs
/// past the end is unspecified.
fn double(values: &mut [u32], stride: usize, run: usize) {
    let mut length = 1;
    while length < run {
        let shift = length * stride;
        for i in 0..values.len().saturating_sub(shift) {
            values[i] = values[i].min(values[i + shift]);
        }
        length *= 2;
    }
}
