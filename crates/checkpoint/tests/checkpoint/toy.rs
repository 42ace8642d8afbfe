//! A bake with two phases: the second one's units depend on all results of the first.

use sightlines_checkpoint::{Key, KeyHasher};
use sightlines_progress::{Halt, Phase, UnitStore, Units};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

pub(crate) const PROGRAM: &str = "1.0";

/// A toy, and how many units it has computed.
#[derive(Debug)]
pub(crate) struct Toy {
    pub(crate) n_units: [usize; 2],
    pub(crate) n_computed: AtomicUsize,
    /// Ends, as if killed, before it computes more.
    pub(crate) stop_after: usize,
}

pub(crate) fn toy(n_units: [usize; 2]) -> Toy {
    Toy { n_units, n_computed: AtomicUsize::new(0), stop_after: usize::MAX }
}

pub(crate) fn key(of: &str) -> Key {
    let mut hasher = KeyHasher::new(PROGRAM);
    hasher.value("input", of.as_bytes());
    hasher.finish()
}

fn mix(seed: u64, unit: usize) -> Vec<u8> {
    let mixed = (seed + unit as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed.to_le_bytes().repeat(unit % 5)
}

impl Toy {
    fn phase(&self, units: Units<'_>, name: &'static str, n: usize, seed: u64) -> Result<Vec<u8>, Halt> {
        let costs: Vec<f64> = (0..n).map(|unit| (n - unit) as f64).collect();
        units.through(&Phase::new(name, &costs), || {
            let mut all = Vec::new();
            for unit in 0..n {
                let result = units.get(name, unit, || {
                    if self.n_computed.fetch_add(1, Relaxed) >= self.stop_after {
                        return Err(Halt::Store("killed".to_owned()));
                    }
                    Ok(mix(seed, unit))
                })?;
                all.extend(result.unwrap_or_default());
            }
            Ok(all)
        })
    }

    pub(crate) fn bake(&self, store: Option<&dyn UnitStore>) -> Result<Vec<u8>, Halt> {
        let units = Units(store);
        let first = self.phase(units, "pairs", self.n_units[0], 1)?;
        let seed = first.iter().map(|&byte| u64::from(byte)).sum();
        let second = self.phase(units, "objects", self.n_units[1], seed)?;
        Ok([first, second].concat())
    }

    pub(crate) fn n(&self) -> usize {
        self.n_computed.load(Relaxed)
    }
}
