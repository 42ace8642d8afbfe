//! Seeds of the siblings of an input that once failed.

use proptest::prelude::Rng as _;
use proptest::test_runner::{Config, TestRunner};

/// Seeds of the siblings of a kind of input: four times as many as a property has cases, so 1,024 by default. `PROPTEST_CASES` changes their
/// number, and `PROPTEST_RNG_SEED` replays them; the gate draws others for each state of the project.
pub fn siblings() -> impl ExactSizeIterator<Item = u64> {
    let config = Config { failure_persistence: None, ..Config::default() };
    let n = 4 * config.cases as usize;
    let mut runner = TestRunner::new(config);
    let seeds: Vec<u64> = (0..n).map(|_| runner.rng().next_u64()).collect();
    seeds.into_iter()
}

#[cfg(test)]
mod tests {
    use super::siblings;
    use std::collections::BTreeSet;

    /// As many as said, all different.
    #[test]
    fn siblings_differ() {
        let n = siblings().len();
        assert!(n > 0 && siblings().collect::<BTreeSet<u64>>().len() == n);
    }
}
