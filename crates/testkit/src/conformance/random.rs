//! Random numbers that make coincidences likely.

use sightlines_geometry::{Aabb, Point3, Random as Bits};

/// The same on every machine.
#[derive(Debug, Clone)]
pub struct Random(Bits);

impl Random {
    /// Equal seeds give equal numbers.
    pub fn new(seed: u64) -> Self {
        Self(Bits::new(seed))
    }

    /// Less than `n`, which is small, so that the bias does not matter.
    pub fn below(&mut self, n: u32) -> u32 {
        (self.0.bits() % u64::from(n)) as u32
    }

    /// One of two.
    pub fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    /// One of a few.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u32) as usize]
    }

    /// A multiple of an eighth from `low` to `high`, both integers: so that things meet, line up and coincide.
    pub fn eighth(&mut self, low: i32, high: i32) -> f64 {
        f64::from(low) + f64::from(self.below((high - low) as u32 * 8 + 1)) / 8.0
    }

    /// A multiple of 1/16 above `low`, by less than `span`.
    pub fn sixteenth(&mut self, low: f64, span: u32) -> f64 {
        low + f64::from(self.below(16 * span)) / 16.0
    }

    /// From `low` to `high`, all bits used.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// A point of a box.
    pub fn point(&mut self, b: &Aabb<3>) -> Point3 {
        [0, 1, 2].map(|k| self.between(b.min[k], b.max[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_paper_and_within_their_ranges() {
        let mut random = Random::new(0);
        assert_eq!([random.0.bits(), random.0.bits()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
        for _ in 0..1000 {
            assert!(random.below(3) < 3);
            let x = random.eighth(-1, 2);
            assert!((-1.0..=2.0).contains(&x) && (x * 8.0).fract() == 0.0);
            assert!((-1.0..=1.0).contains(&random.between(-1.0, 1.0)));
        }
    }
}
