//! Where the voxels are: a grid whose planes are doubles without rounding.

use sightlines_geometry::{Aabb, Point3};

/// A range of voxels: lower corner, and one past the upper one, along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Block {
    pub(crate) low: [usize; 3],
    pub(crate) high: [usize; 3],
}

/// Cubes of one size around a scene, with a layer of cubes all around that nothing of the scene touches.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    origin: Point3,
    step: f64,
    n: [usize; 3],
}

/// The largest power of two that is no larger than `x`, a positive normal number.
fn power_of_two_at_most(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000)
}

impl Grid {
    /// A grid around `bounds` with about `n_longest >= 1` voxels along its longest side; fewer where doubles are too
    /// coarse for that, far from the origin.
    ///
    /// All planes are exact: the step is a multiple of a power of two `g` with `16 g <= step <= 32 g`, the
    /// origin is a multiple of `g / 8`, and coordinates are below 2^41 steps, so below 2^49 such parts. What is between
    /// two planes in the middle is exact too.
    pub(crate) fn around(bounds: &Aabb<3>, n_longest: usize) -> Self {
        let bounds = if bounds.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *bounds };
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| m.max(x.abs()));
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        // No smaller than predicates take, with room for the parts of a step.
        let least = (largest / (1u64 << 40) as f64).max(f64::from_bits((1023 - 120) << 52));
        let step = (longest / n_longest as f64).max(least);
        let g = power_of_two_at_most(step) / 16.0;
        let step = (step / g).ceil() * g;
        // Five eighths: walls at round coordinates then do not lie between two voxels, and touch one layer only.
        let origin: Point3 = std::array::from_fn(|k| ((bounds.min[k] / step).floor() - 2.0) * step + 0.625 * step);
        let n = std::array::from_fn(|k| ((bounds.max[k] - origin[k]) / step).ceil() as usize + 2);
        Self { origin, step, n }
    }

    /// Voxels along each axis.
    pub(crate) fn n(&self) -> [usize; 3] {
        self.n
    }

    /// Side of a voxel.
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// Number of voxels; saturates.
    pub(crate) fn n_voxels(&self) -> usize {
        self.n.iter().fold(1usize, |all, &n| all.saturating_mul(n))
    }

    /// Plane `i` of `0..=n` across an axis. Exact.
    pub(crate) fn plane(&self, axis: usize, i: usize) -> f64 {
        self.origin[axis] + self.step * i as f64
    }

    /// Which plane `x` lies at, as a number with a fraction; rounded, so only good for a guess.
    pub(crate) fn place(&self, axis: usize, x: f64) -> f64 {
        (x - self.origin[axis]) / self.step
    }

    /// The closed box of a block. Exact.
    pub(crate) fn bounds(&self, block: &Block) -> Aabb<3> {
        Aabb {
            min: std::array::from_fn(|k| self.plane(k, block.low[k])),
            max: std::array::from_fn(|k| self.plane(k, block.high[k])),
        }
    }

    /// The middle of a voxel. Exact.
    pub(crate) fn middle(&self, p: [usize; 3]) -> Point3 {
        std::array::from_fn(|k| (self.plane(k, p[k]) + self.plane(k, p[k] + 1)) / 2.0)
    }

    /// The voxels that meet a box, as far as there are any; with those that only touch it.
    pub(crate) fn meeting(&self, b: &Aabb<3>) -> Option<Block> {
        let mut block = Block { low: [0; 3], high: [0; 3] };
        for k in 0..3 {
            // The first whose upper plane reaches up to the box, and one past the last whose lower plane does.
            let first = self.first_plane(k, |x| x >= b.min[k]);
            let past = self.first_plane(k, |x| x > b.max[k]);
            block.low[k] = first.saturating_sub(1);
            block.high[k] = past.min(self.n[k]);
            if first > self.n[k] || past == 0 {
                return None;
            }
        }
        Some(block)
    }

    /// A block that covers a box, with as few voxels as possible; none if the grid does not.
    pub(crate) fn covering(&self, b: &Aabb<3>) -> Option<Block> {
        let mut block = Block { low: [0; 3], high: [0; 3] };
        for k in 0..3 {
            let above = self.first_plane(k, |x| x > b.min[k]);
            block.low[k] = above.checked_sub(1)?;
            // A box without thickness still needs a voxel.
            block.high[k] = self.first_plane(k, |x| x >= b.max[k]).max(above);
            if block.high[k] > self.n[k] {
                return None;
            }
        }
        Some(block)
    }

    /// The first plane of an axis that is far enough; `n + 1` if none is.
    fn first_plane(&self, axis: usize, is_enough: impl Fn(f64) -> bool) -> usize {
        let (mut low, mut high) = (0, self.n[axis] + 1);
        while low < high {
            let middle = usize::midpoint(low, high);
            if is_enough(self.plane(axis, middle)) { high = middle } else { low = middle + 1 }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Aabb<3>> {
        let corner = || prop::array::uniform3(-40i32..40);
        (corner(), corner(), -60i32..60)
            .prop_map(|(a, b, e)| Aabb::around([a, b].map(|p| p.map(|x| f64::from(x) * 0.1 * 2f64.powi(e)))))
    }

    proptest! {
        /// Invariant: planes are at their nominal positions, without rounding, and the scene is inside a free layer.
        #[test]
        fn planes_are_exact_and_leave_a_layer(b in boxes(), n in 1usize..70) {
            let grid = Grid::around(&b, n);
            let exact = |x: f64| num_rational::BigRational::from_float(x).unwrap();
            for k in 0..3 {
                prop_assert!(grid.plane(k, 1) < b.min[k] && b.max[k] < grid.plane(k, grid.n()[k] - 1));
                prop_assert!(grid.n()[k] <= n + 5);
                for i in [0, 1, grid.n()[k] / 2, grid.n()[k]] {
                    let at = exact(grid.origin[k]) + exact(grid.step) * exact(i as f64);
                    prop_assert_eq!(exact(grid.plane(k, i)), at);
                }
            }
        }

        /// Invariant: what meets a box and what covers it is found as one by one.
        #[test]
        fn blocks_meet_and_cover(b in boxes(), pick in prop::array::uniform3((-2i32..30, 0i32..9)), n in 1usize..9) {
            let grid = Grid::around(&b, n);
            // Ends on planes and between them, also outside.
            let end = |k: usize, i: i32| grid.plane(k, 0) + grid.step() / 2.0 * f64::from(i);
            let probe = Aabb {
                min: std::array::from_fn(|k| end(k, pick[k].0)),
                max: std::array::from_fn(|k| end(k, pick[k].0 + pick[k].1)),
            };
            let meets = |k: usize, i: usize| grid.plane(k, i) <= probe.max[k] && probe.min[k] <= grid.plane(k, i + 1);
            let found = |k: usize| (0..grid.n()[k]).filter(|&i| meets(k, i)).collect::<Vec<_>>();
            match grid.meeting(&probe) {
                None => prop_assert!((0..3).any(|k| found(k).is_empty())),
                Some(block) => for k in 0..3 {
                    prop_assert_eq!((block.low[k]..block.high[k]).collect::<Vec<_>>(), found(k));
                }
            }
            let inside = (0..3).all(|k| grid.plane(k, 0) <= probe.min[k] && probe.max[k] <= grid.plane(k, grid.n()[k]));
            let last = (0..3).any(|k| probe.min[k] == grid.plane(k, grid.n()[k]));
            match grid.covering(&probe) {
                None => prop_assert!(!inside || last),
                Some(block) => {
                    let around = grid.bounds(&block);
                    prop_assert!((0..3).all(|k| around.min[k] <= probe.min[k] && probe.max[k] <= around.max[k]));
                    prop_assert!((0..3).all(|k| block.high[k] > block.low[k]));
                    prop_assert!((0..3).all(|k| grid.plane(k, block.low[k] + 1) > probe.min[k]));
                }
            }
        }
    }
}
