//! Searches through portals, their proofs and explanations.

mod axial;
mod boxes;
mod certify;
mod columns;
mod explain_axial;
mod explain_convex;
mod from_boxes;
mod limited;
mod live_axial;
mod one_way;
mod picture;
mod search;
mod stab_trees;
