//! Chords: straight lines shot through the portals of a graph, to find most visible pairs cheaply.
//!
//! Each step of a chord certainly passes a portal strictly, so every pair that chords find is visible; what they miss
//! is left to the search. Chords affect the cost of a search, never its answer.

mod axial;
mod planar;

pub use axial::shoot_axial_chords;
pub use planar::shoot_chords;

use sightlines_pvs::BitMatrix;

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
