//! Voxels as occluders, with blocker extension.
//!
//! Source: Schaufler, Dorsey, Decoret and Sillion, "Conservative volumetric visibility with occluder fusion", SIGGRAPH
//! 2000. Ours: what is inside is decided by exact parity instead of a flood where surfaces are closed, or closed but for an
//! end that lines cannot use; a grid instead of an octree; umbras by exact predicates.

use crate::blocks::{Blocked, grow};
use crate::grid::Grid;
use crate::interior::Insides;
use crate::shadow::{hides_box, hides_points};
use sightlines_cells::Scene;
use sightlines_geometry::{Aabb, Point3, check_coordinate};
use sightlines_multifocal::{BackendError, FromRegion, Guarantee, Umbra, Volume};

/// Most voxels of a grid.
pub const MAX_VOXELS: usize = 1 << 27;

/// Which voxels hide something by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Interior {
    /// Those that a surface without holes, or with holes that no line in question can use, keeps apart from the volume.
    /// Conservative for every scene.
    Closed,
    /// Those as well that a flood of free voxels from outside, and from the volume, does not reach: the rule of the
    /// paper. A gap that is thinner than a voxel is overlooked.
    Flooded,
}

/// How fine, and how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoxelOptions {
    /// Voxels along the longest side of the scene; about.
    pub n_longest: usize,
    /// Which voxels hide something.
    pub interior: Interior,
    /// No more boxes of voxels are made for a volume; the nearest come first.
    pub max_blockers: usize,
}

impl Default for VoxelOptions {
    /// 128 voxels, closed surfaces, 10,000 blockers.
    fn default() -> Self {
        Self { n_longest: 128, interior: Interior::Closed, max_blockers: 10_000 }
    }
}

/// Why there are no voxels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VoxelError {
    /// None asked for, or more than [`MAX_VOXELS`] in all.
    #[error("{0} voxels along the longest side are none, or more than {MAX_VOXELS} in all")]
    Count(usize),
}

/// A scene as voxels.
#[derive(Debug, Clone)]
pub struct Voxels {
    grid: Grid,
    insides: Insides,
    options: VoxelOptions,
}

impl Voxels {
    /// Makes voxels of what hides in a scene.
    ///
    /// Cost: for n triangles and m voxels O(n log n + m), and one step for each voxel that a triangle meets.
    ///
    /// # Errors
    /// [`VoxelError`]
    pub fn new(scene: &Scene, options: VoxelOptions) -> Result<Self, VoxelError> {
        let n = options.n_longest;
        if !(1..=MAX_VOXELS).contains(&n) {
            return Err(VoxelError::Count(n));
        }
        let grid = Grid::around(&scene.bounds(), n);
        if grid.n_voxels() > MAX_VOXELS {
            return Err(VoxelError::Count(n));
        }
        let insides = Insides::new(&scene.opaque_part(), &grid, options.interior == Interior::Flooded);
        Ok(Self { grid, insides, options })
    }

    /// How many voxels there are along each axis.
    pub fn n(&self) -> [usize; 3] {
        self.grid.n()
    }

    /// Side of a voxel, in scene units.
    pub fn step(&self) -> f64 {
        self.grid.step()
    }

    /// How many voxels triangles meet.
    pub fn n_met(&self) -> usize {
        self.insides.n_met()
    }

    /// How many closed surfaces were found; some may share triangles.
    pub fn n_surfaces(&self) -> usize {
        self.insides.n_chains()
    }

    /// What is hidden from a volume.
    pub fn umbra_of(&self, volume: &Volume) -> VoxelUmbra<'_> {
        let volume = *volume.bounds();
        let opaque = self.insides.opaque(&self.grid, &volume);
        let n_opaque = opaque.len();
        let blocked = grow(opaque, &self.grid, &volume, self.options.max_blockers);
        VoxelUmbra { grid: &self.grid, volume, blocked, n_opaque }
    }
}

impl FromRegion for Voxels {
    fn name(&self) -> String {
        let interior = match self.options.interior {
            Interior::Closed => "closed",
            Interior::Flooded => "flooded",
        };
        format!("voxels-{interior}-{}", self.options.n_longest)
    }

    fn only_in_air(&self) -> bool {
        true
    }

    fn guarantee(&self) -> Guarantee {
        match self.options.interior {
            Interior::Closed => Guarantee::Conservative,
            Interior::Flooded => Guarantee::ConservativeIf("no gap thinner than a voxel leads into an enclosed space"),
        }
    }

    fn umbra(&mut self, volume: &Volume) -> Result<Box<dyn Umbra + '_>, BackendError> {
        Ok(Box::new(self.umbra_of(volume)))
    }
}

/// What voxels hide from one volume.
#[derive(Debug)]
pub struct VoxelUmbra<'a> {
    grid: &'a Grid,
    volume: Aabb<3>,
    blocked: Blocked,
    n_opaque: usize,
}

impl VoxelUmbra<'_> {
    /// How many voxels hide something from the volume by themselves.
    pub fn n_opaque(&self) -> usize {
        self.n_opaque
    }

    /// How many voxels are hidden from the volume, with those.
    pub fn n_hidden(&self) -> usize {
        self.blocked.hidden.len()
    }

    /// The boxes that voxels were grown to, nearest first: closed boxes no point of which the volume sees.
    pub fn blockers(&self) -> &[Aabb<3>] {
        &self.blocked.blockers
    }

    /// Whether voxels that cover a box are all hidden.
    fn is_covered(&self, target: &Aabb<3>) -> bool {
        self.grid.covering(target).is_some_and(|block| self.blocked.hidden.has_block(&block))
    }

    /// Whether a blocker may be in the way: the line to the middle of the target meets it, as far as rounded numbers tell.
    fn may_block(&self, blocker: &Aabb<3>, target: &Aabb<3>) -> bool {
        let middle = |b: &Aabb<3>, k: usize| b.min[k] / 2.0 + b.max[k] / 2.0;
        let mut part = [0.0f64, 1.0];
        for k in 0..3 {
            let (v, p) = (middle(&self.volume, k), middle(target, k));
            let [a, b] = [blocker.min[k], blocker.max[k]].map(|side| (side - v) / (p - v));
            if p != v {
                part = [part[0].max(a.min(b)), part[1].min(a.max(b))];
            } else if !(blocker.min[k]..=blocker.max[k]).contains(&v) {
                return false;
            }
        }
        part[0] <= part[1]
    }
}

/// Whether predicates can take a box, and it has points.
fn is_usable(b: &Aabb<3>) -> bool {
    !b.is_empty() && b.min.iter().chain(&b.max).all(|&x| check_coordinate(x).is_ok())
}

impl Umbra for VoxelUmbra<'_> {
    fn hides(&mut self, target: &Aabb<3>) -> bool {
        is_usable(target)
            && (self.is_covered(target) || {
                let mut blockers = self.blocked.blockers.iter();
                blockers.any(|b| self.may_block(b, target) && hides_box(b, &self.volume, target))
            })
    }

    fn hides_points(&mut self, points: &[Point3]) -> bool {
        let around = Aabb::around(points.iter().copied());
        // Boxes grow past what is no number.
        let are_numbers = points.iter().flatten().all(|x| x.is_finite());
        (are_numbers && is_usable(&around))
            && (self.is_covered(&around) || {
                let mut blockers = self.blocked.blockers.iter();
                // The middle of the box around points need not be between them, so nothing is rejected by it.
                blockers.any(|b| hides_points(b, &self.volume, points))
            })
    }
}
