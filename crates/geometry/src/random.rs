//! Pseudorandom numbers, the same on every machine: for places and directions to sample.

use crate::{Aabb, Point3};

/// The generator SplitMix64, the only one of the workspace. Equal seeds give equal numbers; not for secrets.
///
/// # Source
/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// A generator with a seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Any 64 bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to before 1, a multiple of 2^-53.
    #[inline]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Strictly between 0 and 1: an odd multiple of 2^-53.
    #[inline]
    pub fn open_unit(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }

    /// A whole number from 0 to before `n`; 0 for `n` = 0.
    #[inline]
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// A point of a box, uniform but for rounding; never outside the closed box.
    pub fn point(&mut self, b: &Aabb<3>) -> Point3 {
        std::array::from_fn(|k| (b.min[k] + (b.max[k] - b.min[k]) * self.unit()).clamp(b.min[k], b.max[k]))
    }

    /// A direction of length near 1, uniform on the sphere but for rounding.
    ///
    /// # Source
    /// Marsaglia, "Choosing a point from the surface of a sphere", Ann. Math. Stat. 43(2), 1972: needs no function of the C
    /// library, so it is the same everywhere.
    pub fn direction(&mut self) -> Point3 {
        loop {
            let (x, y) = (2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0);
            let square = x * x + y * y;
            if square < 1.0 {
                let root = 2.0 * (1.0 - square).sqrt();
                return [x * root, y * root, 1.0 - 2.0 * square];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_even() {
        let mut random = Random::new(1);
        let n = 100_000;
        let (mut sum, mut octants) = ([0.0; 3], [0usize; 8]);
        for _ in 0..n {
            let d = random.direction();
            assert!((d.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
            (0..3).for_each(|k| sum[k] += d[k]);
            octants[(0..3).map(|k| usize::from(d[k] > 0.0) << k).sum::<usize>()] += 1;
        }
        // Standard deviations: 183 of each sum, 105 of each count.
        assert!(sum.iter().all(|s| s.abs() < 1000.0), "{sum:?}");
        assert!(octants.iter().all(|&c| c.abs_diff(n / 8) < 600), "{octants:?}");
    }

    #[test]
    fn first_numbers_are_the_published_ones() {
        let mut random = Random::new(0);
        assert_eq!([random.bits(), random.bits()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
    }

    #[test]
    fn points_stay_in_their_box() {
        let mut random = Random::new(2);
        let tiny = Aabb { min: [1.0, -3.0, 0.0], max: [1.0f64.next_up(), -3.0, 1e300] };
        for _ in 0..1000 {
            assert!(tiny.contains(random.point(&tiny)));
            assert!(random.below(3) < 3);
            assert!(random.open_unit() > 0.0 && random.open_unit() < 1.0);
        }
        assert_eq!(random.below(0), 0);
    }
}
