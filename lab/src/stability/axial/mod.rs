//! Axis-aligned doors in space: the stabber, linear programs for octants of directions, and plain floating point.

mod cases;
mod methods;
pub mod naive;

pub use cases::{sweeps, walk};
pub use methods::{AxialDoors, methods};
