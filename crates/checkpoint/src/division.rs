//! How the phase of a bake is divided.

use sightlines_progress::Phase;
use xxhash_rust::xxh3::Xxh3;

/// The number of units, and a hash of what they cost: a bake that was divided otherwise has another one.
pub(crate) fn division_of(phase: &Phase<'_>) -> Vec<u8> {
    let mut hasher = Xxh3::new();
    phase.costs.iter().for_each(|cost| hasher.update(&cost.to_bits().to_le_bytes()));
    let mut division = (phase.costs.len() as u64).to_le_bytes().to_vec();
    division.extend(hasher.digest128().to_le_bytes());
    division
}
