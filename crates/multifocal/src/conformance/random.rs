//! The suite's own source of chance: SplitMix64, the same on every machine.

/// Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#[derive(Debug, Clone)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Less than `n`, which is small, so that it does not matter that some are a little more likely.
    pub(super) fn below(&mut self, n: u32) -> u32 {
        (self.next() % u64::from(n)) as u32
    }

    pub(super) fn coin(&mut self) -> bool {
        self.below(2) == 0
    }

    pub(super) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u32) as usize]
    }

    /// An eighth from `low` to `high`, both whole: so that things meet, line up and coincide.
    pub(super) fn eighth(&mut self, low: i32, high: i32) -> f64 {
        f64::from(low) + f64::from(self.below((high - low) as u32 * 8 + 1)) / 8.0
    }

    /// From `low` to `high`, all bits used.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
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
