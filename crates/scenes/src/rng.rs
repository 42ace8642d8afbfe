//! Pseudorandom integers for the generators: no floating point, so scenes are the same on every machine.

use sightlines_geometry::Random;

/// A stream of numbers that is determined by its seed; integers only, so nothing rounds.
#[derive(Debug, Clone)]
pub(crate) struct Rng(Random);

impl Rng {
    /// The stream of `seed`; `purpose` separates the streams of different generators.
    pub(crate) fn new(seed: u64, purpose: u64) -> Self {
        let mut random = Random::new(seed ^ purpose.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        random.bits();
        Self(random)
    }

    /// The next 64 bits.
    pub(crate) fn next(&mut self) -> u64 {
        self.0.bits()
    }

    /// A number below `n`, which is not 0. The bias is below n / 2^32, which is negligible.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        let high = self.next() >> 32;
        let n = u64::try_from(n).expect("sizes have 64 bits");
        usize::try_from((high * n) >> 32).expect("a number below a size is a size")
    }

    /// A number from `low` to `high`, both included.
    pub(crate) fn between(&mut self, low: i32, high: i32) -> i32 {
        debug_assert!(low <= high, "the range is not empty");
        let span = usize::try_from(high - low).expect("low is not above high") + 1;
        low + i32::try_from(self.below(span)).expect("a number in a range of i32")
    }

    /// True once in `n` times.
    pub(crate) fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rng_first_numbers_are_the_published_ones() {
        // The reference stream of SplitMix64 from state 0, of which the first number is dropped.
        let mut rng = Rng::new(0, 0);
        assert_eq!(rng.next(), 0x6E78_9E6A_A1B9_65F4);
    }

    #[test]
    fn rng_ranges_are_reached_and_kept() {
        let mut rng = Rng::new(7, 0);
        let mut seen = [0; 5];
        for _ in 0..1000 {
            seen[usize::try_from(rng.between(-2, 2) + 2).unwrap()] += 1;
        }
        assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
    }
}
