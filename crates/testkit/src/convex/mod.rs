//! Visibility in a world of convex cells, by methods that follow no sequence of portals.
//!
//! | | method | what is proven |
//! | --- | --- | --- |
//! | [`seen_by_rays`] | whole lines, cut by the solid leafs with clearance | pairs that see each other |
//! | [`sight_by_solids`] | subdivision of the segments between two cells, pieces blocked by sections of what is solid | pairs that do, and pairs that do not |
//! | [`sequence_brute_force`] | all lines that touch four edges of a sequence, in exact arithmetic | sequences that no line passes, and sequences that one does |
//!
//! [`classical`](fn@classical) is none of these: it is the method of other programs, to be measured against.

mod blocked;
mod classical;
mod lines;
mod rays;
mod sequences;
mod surd;

pub use blocked::{Sight, SightBySolids, sight_by_solids};
pub use classical::{ClassicalLevel, ClassicalOptions, ClassicalSeen, classical};
pub use rays::{SeenByRays, seen_by_rays};
pub use sequences::{Passable, sequence_brute_force, sequences_between};
