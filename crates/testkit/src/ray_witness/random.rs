//! Chance that does not depend on threads.

use crate::rays::length;
use sightlines_cells::Point3;
use sightlines_geometry::{Aabb, Random as Bits};

/// Every ray has numbers of its own, whichever thread casts it.
#[derive(Debug, Clone)]
pub struct Random(Bits);

impl Random {
    /// The numbers of one ray of the rays of one seed.
    pub fn new(seed: u64, ray: u64) -> Self {
        Self(Bits::new(Bits::new(Bits::new(seed).bits() ^ ray).bits()))
    }

    /// From 0 to one less than `n`; uniform up to rounding.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn below(&mut self, n: usize) -> usize {
        assert!(n > 0, "there is a number to draw");
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    /// Strictly between 0 and 1.
    pub fn unit(&mut self) -> f64 {
        self.0.open_unit()
    }

    /// Uniform over a box.
    pub fn point(&mut self, b: &Aabb<3>) -> Point3 {
        [0, 1, 2].map(|k| b.min[k] + (b.max[k] - b.min[k]) * self.unit())
    }

    /// Uniform over the sphere, of length 1.
    pub fn direction(&mut self) -> Point3 {
        loop {
            let d = [0; 3].map(|_| 2.0 * self.unit() - 1.0);
            let l = length(d);
            if (0.1..=1.0).contains(&l) {
                return d.map(|x| x / l);
            }
        }
    }
}
