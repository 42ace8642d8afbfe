//! Proofs, true ones and wrong ones.

mod adversary;
mod adversary_convex;
mod convex;
mod plan;
mod space;
