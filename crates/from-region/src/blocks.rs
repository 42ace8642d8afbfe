//! Blockers: boxes of blocked voxels, grown as far as they go.

use crate::bits::Bits;
use crate::grid::{Block, Grid};
use crate::shadow::add_umbra;
use sightlines_geometry::Aabb;

/// What is hidden from a volume, as found.
#[derive(Debug)]
pub(crate) struct Blocked {
    /// Voxels to all of whose points every segment from the volume is blocked before.
    pub(crate) hidden: Bits,
    /// The boxes of such voxels whose umbras were taken, first the first.
    pub(crate) blockers: Vec<Aabb<3>>,
}

/// Grows blockers from the opaque voxels nearest to the volume to the farthest, through what is opaque or already
/// hidden, and adds what they hide.
///
/// # Why blockers may grow into hidden space
/// By induction, every segment from the volume to a point of a voxel in `hidden` meets a triangle strictly before the point:
/// opaque voxels are like that. A blocker is a union of such voxels. Let all segments from the
/// volume to a point `p` meet the blocker, one of them in `x`. Then it is blocked strictly before `x`, and `x` does not
/// come after `p`. So whatever lies in the umbra of a blocker is as hidden as the blocker itself, and may be
/// part of the next: a line through the hidden part is blocked before it gets there.
pub(crate) fn grow(opaque: Bits, grid: &Grid, volume: &Aabb<3>, max_blockers: usize) -> Blocked {
    let mut hidden = opaque.clone();
    // What needs no blocker of its own: in a blocker, or in the umbra of one.
    let mut done = Bits::new(grid.n());
    let mut blockers = Vec::new();
    for seed in nearest_first(&opaque, grid, volume) {
        if done.get(seed) {
            continue;
        }
        for order in orders(grid, volume, seed) {
            if blockers.len() >= max_blockers {
                return Blocked { hidden, blockers };
            }
            let block = extend(&hidden, seed, order, grid.n());
            let blocker = grid.bounds(&block);
            if blockers.last() == Some(&blocker) {
                continue;
            }
            done.set_block(&block);
            add_umbra([&mut hidden, &mut done], grid, volume, &blocker);
            blockers.push(blocker);
        }
    }
    Blocked { hidden, blockers }
}

/// How many planes away from the volume each opaque voxel is, at least 0, along the axis where it is farthest;
/// ascending, ties by place.
fn nearest_first(opaque: &Bits, grid: &Grid, volume: &Aabb<3>) -> Vec<[usize; 3]> {
    let n = grid.n();
    // Rounded, and only for the order.
    let away = |k: usize, i: usize| {
        let x = i as f64 + 0.5;
        (grid.place(k, volume.min[k]) - x).max(x - grid.place(k, volume.max[k])).max(0.0) as usize
    };
    let [ax, ay, az]: [Vec<usize>; 3] = std::array::from_fn(|k| (0..n[k]).map(|i| away(k, i)).collect());
    let mut shells: Vec<Vec<[usize; 3]>> = Vec::new();
    for (x, &ax) in ax.iter().enumerate() {
        for (y, &ay) in ay.iter().enumerate() {
            for (z, &az) in az.iter().enumerate().filter(|&(z, _)| opaque.get([x, y, z])) {
                let shell = ax.max(ay).max(az);
                if shells.len() <= shell {
                    shells.resize_with(shell + 1, Vec::new);
                }
                shells[shell].push([x, y, z]);
            }
        }
    }
    shells.concat()
}

/// In which orders of axes a voxel is grown: across the line to it first, both ways round, then along.
fn orders(grid: &Grid, volume: &Aabb<3>, seed: [usize; 3]) -> [[usize; 3]; 2] {
    let middle = grid.middle(seed);
    let gap = |k: usize| (volume.min[k] - middle[k]).max(middle[k] - volume.max[k]);
    let along = (1..3).fold(0, |best, k| if gap(k) > gap(best) { k } else { best });
    let (a, b) = ((along + 1) % 3, (along + 2) % 3);
    [[a, b, along], [b, a, along]]
}

/// The block around a voxel, grown axis by axis as far as all of it is hidden.
fn extend(hidden: &Bits, seed: [usize; 3], order: [usize; 3], n: [usize; 3]) -> Block {
    let mut block = Block { low: seed, high: seed.map(|i| i + 1) };
    for k in order {
        let slab = |block: &Block, at: usize| {
            let mut slab = *block;
            (slab.low[k], slab.high[k]) = (at, at + 1);
            slab
        };
        while block.low[k] > 0 && hidden.has_block(&slab(&block, block.low[k] - 1)) {
            block.low[k] -= 1;
        }
        while block.high[k] < n[k] && hidden.has_block(&slab(&block, block.high[k])) {
            block.high[k] += 1;
        }
    }
    block
}
