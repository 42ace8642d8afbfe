#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: which parts of a scene, objects or triangles, some eyes can see ([`strip()`]): free segments to those that are seen, reasons for those that
//!   are not.
//! - **Out of scope**: files; how lines are found to be blocked ([`sightlines_line_space`]), what closed surfaces and balls enclose ([`sightlines_from_region`]).
//! - **Invariants**: what is reported hidden for another reason than [`HiddenReason::Gap`] and [`HiddenReason::Table`] is hidden from every eye, decided
//!   exactly; what is reported seen has a free segment, decided exactly; the rest is counted as undecided. The answer is the same with any number of threads.
//!
//! # Why parts may go together
//! A part that is hidden is met by no line of sight before something that hides: by none, if lines that only graze an edge do not count. So along each line
//! of sight, all that is seen up to the first surface that hides is of parts that stay, and so is that surface. Take all hidden parts away: nothing of what is on
//! the line up to there changes. That holds although hidden parts may hide each other, as what hides is asked of the whole scene.
//!
//! # Why a box is enough for eyes outside
//! An eye outside of the box around the scene, and a point that it sees in the box: behind the eye, the line does not come back to the box, which is
//! convex. So all of the line up to the eye is free, and what the eye sees is seen as well from where the line enters a larger box. There is a thin slab of eyes on each side
//! of that.
//!
//! # Eyes that walk
//! Sight is a way. So what eyes see that walk from some boxes is joined to these by free space: nothing is seen that a closed surface keeps from the boxes, and nothing
//! that meets no cell of a k-d tree to which portals lead from there ([`Eyes::joined_to`]). From outside, too, what is seen is joined to all that is outside. That they see something is shown from points that free segments lead to, one after the other.
//!
//! # What a gap means
//! Surfaces of real files do not close exactly: a lid lies on its housing, and no two corners are equal. Between them is a crack through which a line could
//! pass, so nothing that is exact can call closed what is behind it. A flood of voxels does not settle it either: it finds openings closed that are narrower
//! than a voxel, and sight passes through these. So voxels hide only under a premise that the caller states as a width: openings through which no
//! ball of that diameter fits count as closed ([`BallReach`](sightlines_from_region::BallReach)). What is hidden in no other way is marked by [`HiddenReason::Gap`].
//! Without a gap, voids count that are closed exactly ([`ClosedSurfaces`](sightlines_from_region::ClosedSurfaces)), whose corners are equal where they hang together.
//!
//! # Sides
//! What lets light through or moves hides nothing. Faces that hide from their front only are walls for lines that come from there, and all of a closed surface
//! of them is one for eyes that are outside of it: what would see a back of it has passed a front. A part whose back may be drawn is hidden only if both of its sides are. As
//! everywhere, closed objects hide from both sides for eyes that are not inside of them.

mod eyes;
mod fate;
mod lines;
mod space;
mod strip;
mod witness;

pub use eyes::{Eyes, EyesError};
pub use fate::{Fate, FateCounts, HiddenReason, ObjectFate};
pub use lines::LineEffort;
pub use strip::{Grain, StripError, StripOptions, Stripped, strip};
