//! Which voxels a volume surely cannot see: the insides of closed surfaces.

use crate::bits::Bits;
use crate::grid::{Block, Grid};
use crate::overlap::may_meet;
use crate::parity::Parity;
use crate::surface::chains;
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Point3};
use std::collections::BTreeMap;

/// A row of voxels along the last axis that no triangle meets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) from: usize,
    pub(crate) to: usize,
}

/// Voxels that hang together by faces and that no triangle meets, so that each chain has one parity in all of them.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    /// The chains around it, ascending.
    odd: Vec<u32>,
    pub(crate) runs: Vec<Run>,
    /// Whether it reaches the border of the grid.
    pub(crate) is_outside: bool,
}

/// A scene as voxels.
#[derive(Debug, Clone)]
pub(crate) struct Insides {
    regions: Vec<Region>,
    parity: Parity,
    /// Of each chain.
    holes: Vec<Vec<Aabb<3>>>,
    /// What free voxels hang together to where nothing is closed but by triangles of the scene; nothing if the flood
    /// was not asked for.
    floods: Option<Vec<Region>>,
    n_met: usize,
}

impl Insides {
    /// Finds closed surfaces, the voxels that triangles meet, and the regions between.
    ///
    /// * `flooded`: whether what a flood from outside does not reach hides something too
    ///
    /// Cost: O(n log n) for the triangles, and the number of voxels.
    pub(crate) fn new(scene: &Scene, grid: &Grid, flooded: bool) -> Self {
        // What is thinner than a voxel has none inside.
        let chains = chains(scene, grid.step());
        let mut met = Bits::new(grid.n());
        scene.objects().iter().flat_map(|o| o.corners()).for_each(|t| mark_all(&mut met, grid, &t));
        let n_met = met.len();
        let floods = flooded.then(|| regions(&met, grid.n()));
        // The parity may change where a cap is.
        chains.iter().flat_map(|c| &c.caps).for_each(|t| mark_all(&mut met, grid, t));
        let parity = Parity::new(&chains);
        let mut regions = regions(&met, grid.n());
        for region in &mut regions {
            let Run { x, y, from, .. } = region.runs[0];
            region.odd = parity.odd_at(grid.middle([x, y, from]));
        }
        Self { regions, parity, holes: chains.into_iter().map(|c| c.holes).collect(), floods, n_met }
    }

    /// How many voxels triangles meet.
    pub(crate) fn n_met(&self) -> usize {
        self.n_met
    }

    /// How many closed surfaces there are.
    pub(crate) fn n_chains(&self) -> usize {
        self.holes.len()
    }

    /// Voxels to all of whose points every segment from `volume` meets a triangle before.
    ///
    /// Let a chain have one parity in the voxel and another at the eye. The segment between meets the chain
    /// then, in a triangle of the scene or of a cap. Not in a cap, if a plane has the hole on one side, and volume and voxel on the
    /// other. The voxel meets no triangle, so the meeting comes before its points. The parity is the same at all eyes if the
    /// volume does not meet the chain: asked of one corner then.
    ///
    /// If the flood was asked for, with all that free voxels do not join to the border or to the volume, closed or not.
    pub(crate) fn opaque(&self, grid: &Grid, volume: &Aabb<3>) -> Bits {
        let met = self.parity.meeting(volume);
        let around = self.parity.odd_at(volume.min);
        let mut opaque = Bits::new(grid.n());
        let near = near(grid, volume);
        for flood in self.floods.iter().flatten() {
            if !flood.is_outside && !flood.reaches(near.as_ref()) {
                flood.runs.iter().for_each(|r| opaque.set_run(r.x, r.y, r.from, r.to));
            }
        }
        for region in &self.regions {
            let one_side = |c: &u32| region.odd.binary_search(c).is_ok() != around.binary_search(c).is_ok();
            let mut apart: Vec<u32> = region.odd.iter().chain(&around).copied().filter(one_side).collect();
            apart.retain(|c| met.binary_search(c).is_err());
            let is_closed = apart.iter().any(|&c| self.holes[c as usize].is_empty());
            for run in &region.runs {
                if is_closed {
                    opaque.set_run(run.x, run.y, run.from, run.to);
                } else if !apart.is_empty() {
                    self.opaque_run(grid, volume, &apart, run, &mut opaque);
                }
            }
        }
        opaque
    }

    /// What of a run is apart from the volume by a chain whose holes no segment between can use.
    fn opaque_run(&self, grid: &Grid, volume: &Aabb<3>, apart: &[u32], run: &Run, opaque: &mut Bits) {
        for z in run.from..run.to {
            let voxel = grid.bounds(&Block { low: [run.x, run.y, z], high: [run.x + 1, run.y + 1, z + 1] });
            let unused = |hole: &Aabb<3>| {
                (0..3).any(|k| {
                    hole.max[k] < volume.min[k].min(voxel.min[k]) || hole.min[k] > volume.max[k].max(voxel.max[k])
                })
            };
            if apart.iter().any(|&c| self.holes[c as usize].iter().all(unused)) {
                opaque.set([run.x, run.y, z]);
            }
        }
    }
}

impl Region {
    /// Whether it has a voxel of a block.
    pub(crate) fn reaches(&self, block: Option<&Block>) -> bool {
        block.is_some_and(|b| {
            self.runs.iter().any(|r| {
                (b.low[0]..b.high[0]).contains(&r.x)
                    && (b.low[1]..b.high[1]).contains(&r.y)
                    && r.from < b.high[2]
                    && b.low[2] < r.to
            })
        })
    }
}

/// The voxels that a volume meets, and their neighbours: an eye in a voxel that triangles meet may look into those.
fn near(grid: &Grid, volume: &Aabb<3>) -> Option<Block> {
    let mut block = grid.meeting(volume)?;
    for k in 0..3 {
        block.low[k] = block.low[k].saturating_sub(1);
        block.high[k] = (block.high[k] + 1).min(grid.n()[k]);
    }
    Some(block)
}

/// Adds all voxels that a triangle may meet.
pub(crate) fn mark_all(met: &mut Bits, grid: &Grid, triangle: &[Point3; 3]) {
    if let Some(block) = grid.meeting(&Aabb::around(*triangle)) {
        mark(met, grid, triangle, block);
    }
}

/// Adds all voxels of a block that a triangle may meet, halving it where it does.
fn mark(met: &mut Bits, grid: &Grid, triangle: &[Point3; 3], block: Block) {
    if !may_meet(triangle, &grid.bounds(&block)) {
        return;
    }
    let size = |k: usize| block.high[k] - block.low[k];
    let axis = (1..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
    if size(axis) == 1 {
        met.set(block.low);
        return;
    }
    let middle = usize::midpoint(block.low[axis], block.high[axis]);
    let (mut low, mut high) = (block, block);
    (low.high[axis], high.low[axis]) = (middle, middle);
    mark(met, grid, triangle, low);
    mark(met, grid, triangle, high);
}

/// The regions of what is not met, in the order of their first runs; with nothing said yet about what is around them.
pub(crate) fn regions(met: &Bits, n: [usize; 3]) -> Vec<Region> {
    let mut runs: Vec<Run> = Vec::new();
    // Of each row, its first run; and one more.
    let mut starts = Vec::with_capacity(n[0] * n[1] + 1);
    for (x, y) in (0..n[0]).flat_map(|x| (0..n[1]).map(move |y| (x, y))) {
        starts.push(runs.len());
        let mut z = 0;
        while z < n[2] {
            let from = z;
            while z < n[2] && !met.get([x, y, z]) {
                z += 1;
            }
            if from < z {
                runs.push(Run { x, y, from, to: z });
            }
            z += 1;
        }
    }
    starts.push(runs.len());
    let mut parents: Vec<usize> = (0..runs.len()).collect();
    for row in 0..n[0] * n[1] {
        let next = [(row % n[1] + 1 < n[1]).then_some(row + 1), (row / n[1] + 1 < n[0]).then_some(row + n[1])];
        for other in next.into_iter().flatten() {
            let (mut i, mut j) = (starts[row], starts[other]);
            while i < starts[row + 1] && j < starts[other + 1] {
                if runs[i].from < runs[j].to && runs[j].from < runs[i].to {
                    let (a, b) = (root(&mut parents, i), root(&mut parents, j));
                    parents[a.max(b)] = a.min(b);
                }
                if runs[i].to <= runs[j].to { i += 1 } else { j += 1 }
            }
        }
    }
    let mut found: BTreeMap<usize, Region> = BTreeMap::new();
    for (i, run) in runs.iter().enumerate() {
        let empty = || Region { odd: Vec::new(), runs: Vec::new(), is_outside: false };
        let region = found.entry(root(&mut parents, i)).or_insert_with(empty);
        let ends = [(run.x, run.x + 1, n[0]), (run.y, run.y + 1, n[1]), (run.from, run.to, n[2])];
        region.is_outside |= ends.iter().any(|&(low, high, n)| low == 0 || high == n);
        region.runs.push(*run);
    }
    found.into_values().collect()
}

fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}
