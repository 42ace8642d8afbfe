//! Convex portals in space: the stabber, separating planes as Quake's programs use them, and lines through four edges in
//! plain floating point.

mod cases;
pub mod edges;
mod methods;
pub mod separators;

pub use cases::sweeps;
pub use methods::{ConvexPortals, methods};
