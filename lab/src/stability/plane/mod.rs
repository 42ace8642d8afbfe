//! Doors in the plane: funnels and linear programs.

pub(super) mod cases;
mod methods;
pub mod naive;
pub mod truth;

pub use cases::{corridor, gaps, sweeps};
pub use methods::{Doors, methods, said};
