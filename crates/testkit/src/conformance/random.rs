//! Random numbers that make coincidences likely.

use super::Random;
use sightlines_geometry::{Aabb, Point3};

impl Random {
    pub(super) fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    /// A multiple of an eighth from `low` to `high`, both integers: so that things meet, line up and coincide.
    pub(super) fn eighth(&mut self, low: i32, high: i32) -> f64 {
        f64::from(low) + self.below((high - low) as usize * 8 + 1) as f64 / 8.0
    }

    /// A multiple of 1/16 above `low`, by less than `span`.
    pub(super) fn sixteenth(&mut self, low: f64, span: usize) -> f64 {
        low + self.below(16 * span) as f64 / 16.0
    }

    /// From `low` to `high`, all bits used.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    pub(super) fn point(&mut self, b: &Aabb<3>) -> Point3 {
        self.0.point(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_paper_and_within_their_ranges() {
        let mut random = Random::new(0);
        assert_eq!([random.next(), random.next()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
        for _ in 0..1000 {
            assert!(random.below(3) < 3);
            let x = random.eighth(-1, 2);
            assert!((-1.0..=2.0).contains(&x) && (x * 8.0).fract() == 0.0);
            assert!((-1.0..=1.0).contains(&random.between(-1.0, 1.0)));
        }
    }
}
