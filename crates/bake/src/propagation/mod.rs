//! Shadows propagated over the faces between cells: what is hidden from thousands of cells at once.
//!
//! Cells share faces. If an object is hidden from the cell beyond a face, no line through that face reaches it, so only faces whose
//! neighbour may see the object need a question: are all lines blocked that leave the cell through this face and end at the object? What
//! is asked grows with the surface of an object's shadow, not with its volume.
//!
//! *Why it is conservative.* At the end the box of each cell in the set `H` of those from which the object is hidden misses the box of the object, and each
//! part of each of its sides that faces the object was found blocked, or is covered by a cell of `H` behind it. Let `a` be a point of a cell in `H`
//! and `b` one of the object. `b` is not in the cell, so the segment leaves it for good at a point `c` of a side that faces the object. If the
//! part of the side with `c` was found blocked, so is the segment. Else `c` is in a cell of `H` behind the side, and the same holds there of the segment from
//! `c` to `b`. No plane is crossed twice, so this ends, and not in a cell that has `b`. It needs no order of the cells: they may lean on each other in
//! circles, and any `H` of which this is true is right. `is_sound` repeats that check without the solver.
//!
//! Rays come first: what they reach is visible, and need not be asked about. They only choose.

mod lines;
mod solve;
#[cfg(test)]
mod tests;
mod tiling;

pub(crate) use solve::{Propagation, Solved};
