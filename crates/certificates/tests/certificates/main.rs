//! Proofs, true ones and wrong ones.

mod adversary;
mod adversary_convex;
mod axial;
mod convex;
mod planar;
