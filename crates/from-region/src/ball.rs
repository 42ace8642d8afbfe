//! What a ball touches that rolls in from the eyes: what it does not touch is enclosed, but for openings through which it does not fit.
//!
//! # What that means
//! Free voxels are those that no wall meets, to be sure. Their diagonal is less than the radius of the ball. So wherever the ball is without meeting a
//! wall, all voxels that hold its middle are free, and those around a corner or an edge that the middle passes hang together by sides: the flood through sides
//! of free voxels reaches them all. What the ball touches there is no farther from its middle than its radius, so it meets a voxel at most that
//! many voxels, rounded up, from a reached one. Whatever meets none of these is not touched.
//!
//! That is no proof that nothing is seen: sight passes an opening that is narrower than the ball. It is what a stated gap promises: openings through
//! which no ball of that diameter fits count as closed.

use crate::bits::Bits;
use crate::grid::{Block, Grid};
use crate::interior::{Region, mark_all, regions};
use crate::overlap::may_meet;
use sightlines_geometry::{Aabb, Point3};

/// More voxels are not made: a bit each, in two sets.
const MOST_VOXELS: usize = 1 << 30;

/// By how much less than its radius the diagonal of a voxel is: more than rounding can be off where voxels are met.
const MARGIN: f64 = 1.0 / (1u64 << 20) as f64;

/// Why a gap cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GapError {
    /// Too many voxels.
    #[error("a gap of {gap} is too narrow for a scene {longest} long: at least {least} is possible")]
    TooNarrow {
        /// The gap.
        gap: f64,
        /// The longest side of the scene.
        longest: f64,
        /// About the least that is possible.
        least: f64,
    },
    /// No width at all.
    #[error("a gap of {gap} is no width: it has to be a finite number above 0")]
    NoWidth {
        /// The gap.
        gap: f64,
    },
}

/// What a ball touches that starts at the eyes, and does not meet a wall on its way.
#[derive(Debug, Clone)]
pub struct BallReach {
    grid: Grid,
    near: Bits,
    n_reached: usize,
}

impl BallReach {
    /// Floods the free space of a scene.
    ///
    /// * `walls`: triangles that the ball does not meet
    /// * `bounds`: around all of the scene
    /// * `gap`: the diameter of the ball
    /// * `eyes`: boxes where eyes are; none if they are all around the scene. A ball in a place that is narrower than itself goes nowhere
    ///
    /// Costs a bit for each voxel, of which there are about 41 to the cube of a gap, and time in proportion.
    ///
    /// # Errors
    /// [`GapError`] for a gap that needs more than 2^30 voxels.
    pub fn new(
        walls: impl IntoIterator<Item = [Point3; 3]>,
        bounds: &Aabb<3>,
        gap: f64,
        eyes: Option<&[Aabb<3>]>,
    ) -> Result<Self, GapError> {
        let grid = grid_for(bounds, gap)?;
        let radius = (gap / 2.0 / grid.step()).ceil() as usize;
        let mut met = Bits::new(grid.n());
        walls.into_iter().for_each(|t| mark_all(&mut met, &grid, &t));
        let all = regions(&met, grid.n());
        drop(met);
        let starts: Option<Vec<Start>> =
            eyes.map(|eyes| eyes.iter().map(|eye| Start::new(&grid, eye, radius)).collect());
        let mut near = Bits::new(grid.n());
        // What is beside the eyes is seen, however narrow it is there.
        starts.iter().flatten().filter_map(|start| start.near).for_each(|block| near.set_block(&block));
        let is_outside = starts.as_ref().is_none_or(|starts| starts.iter().any(|start| start.is_outside));
        let reaches = |region: &Region| region.runs.iter().any(|run| near.has_any(run.x, run.y, run.from, run.to));
        let reached: Vec<&Region> =
            all.iter().filter(|region| is_outside && region.is_outside || reaches(region)).collect();
        let mut n_reached = 0;
        for run in reached.into_iter().flat_map(|region| &region.runs) {
            n_reached += run.to - run.from;
            let middle = Block { low: [run.x, run.y, run.from], high: [run.x + 1, run.y + 1, run.to] };
            near.set_block(&wider(&grid, middle, radius));
        }
        Ok(Self { grid, near, n_reached })
    }

    /// Whether the ball may touch a triangle. Never wrongly no; of what is outside of the box around the scene, yes.
    pub fn touches(&self, triangle: &[Point3; 3]) -> bool {
        let around = Aabb::around(*triangle);
        let n = self.grid.n();
        let whole = self.grid.bounds(&Block { low: [0; 3], high: n });
        let is_inside = (0..3).all(|k| whole.min[k] < around.min[k] && around.max[k] < whole.max[k]);
        match self.grid.meeting(&around) {
            Some(block) if is_inside => self.any(triangle, block),
            _ => true,
        }
    }

    /// Voxels that the middle of the ball reaches, if it starts there.
    pub fn n_reached(&self) -> usize {
        self.n_reached
    }

    /// Side of a voxel.
    pub fn step(&self) -> f64 {
        self.grid.step()
    }

    fn any(&self, triangle: &[Point3; 3], block: Block) -> bool {
        if !may_meet(triangle, &self.grid.bounds(&block)) {
            return false;
        }
        let size = |k: usize| block.high[k] - block.low[k];
        let axis = (1..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
        if size(axis) == 1 {
            return self.near.get(block.low);
        }
        let middle = usize::midpoint(block.low[axis], block.high[axis]);
        let (mut low, mut high) = (block, block);
        (low.high[axis], high.low[axis]) = (middle, middle);
        self.any(triangle, low) || self.any(triangle, high)
    }
}

/// Where the ball starts.
struct Start {
    /// The voxels of the eyes, and those that a ball there touches.
    near: Option<Block>,
    /// Whether some eyes are outside of the grid.
    is_outside: bool,
}

impl Start {
    fn new(grid: &Grid, eyes: &Aabb<3>, radius: usize) -> Self {
        let whole = grid.bounds(&Block { low: [0; 3], high: grid.n() });
        let is_outside = (0..3).any(|k| eyes.min[k] < whole.min[k] || eyes.max[k] > whole.max[k]);
        Self { near: grid.meeting(eyes).map(|block| wider(grid, block, radius)), is_outside }
    }
}

/// A block with as many voxels more on all sides, as far as there are any.
fn wider(grid: &Grid, mut block: Block, by: usize) -> Block {
    for k in 0..3 {
        block.low[k] = block.low[k].saturating_sub(by);
        block.high[k] = (block.high[k] + by).min(grid.n()[k]);
    }
    block
}

/// Voxels of which the diagonal is less than half the gap.
fn grid_for(bounds: &Aabb<3>, gap: f64) -> Result<Grid, GapError> {
    if !(gap.is_finite() && gap > 0.0) {
        return Err(GapError::NoWidth { gap });
    }
    let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let most = gap / 2.0 / 3f64.sqrt() * (1.0 - MARGIN);
    let n = longest / most;
    let volume: f64 = (0..3).map(|k| (bounds.max[k] - bounds.min[k]).max(0.0) / most + 5.0).product();
    let least = gap * (volume / MOST_VOXELS as f64).cbrt();
    let too_narrow = GapError::TooNarrow { gap, longest, least };
    if volume.is_nan() || volume >= MOST_VOXELS as f64 {
        return Err(too_narrow);
    }
    let mut n = (n.ceil() as usize).max(1);
    // The step is rounded up a little, so it takes a few more of them.
    for _ in 0..8 {
        let grid = Grid::around(bounds, n);
        if grid.step() <= most {
            return if grid.n_voxels() <= MOST_VOXELS { Ok(grid) } else { Err(too_narrow) };
        }
        n += n / 16 + 1;
    }
    // Doubles are too coarse for such voxels.
    Err(too_narrow)
}
