//! Chords: straight lines shot through the portals of a graph, to find most visible pairs cheaply.
//!
//! Each step of a chord is certain that it passes a portal strictly, so every pair that chords find is
//! visible; what they miss is left to the search. They change no answer, only its cost.

mod axial;
mod planar;

pub use axial::shoot_axial_chords;
pub use planar::shoot_chords;

use sightlines_pvs::BitMatrix;

/// A small generator of numbers for chord directions: SplitMix64.
///
/// Source: Steele, Lea and Flood, OOPSLA 2014.
pub(crate) struct SplitMix(pub(crate) u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in (0, 1), never an end.
    pub(crate) fn unit(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) * 2f64.powi(-52)
    }
}

/// All zones of a path see each other.
pub(crate) fn mark(seen: &mut BitMatrix, path: &mut Vec<u32>) {
    path.sort_unstable();
    path.dedup();
    for (i, &a) in path.iter().enumerate() {
        for &b in &path[..i] {
            seen.set(a as usize, b as usize, true);
            seen.set(b as usize, a as usize, true);
        }
    }
}
