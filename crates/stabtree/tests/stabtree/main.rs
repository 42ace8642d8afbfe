//! Searches through portals, their proofs and explanations.

mod boxes;
mod certify;
mod columns;
mod explain_convex;
mod explain_space;
mod from_boxes;
mod limited;
mod live_space;
mod picture;
mod search;
mod space;
mod stab_trees;
