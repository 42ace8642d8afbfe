#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: views of single points in the plane: the [`WallMesh`], isovists and their measures, sight between points,
//!   isovists of regions and paths; estimates of the same in space ([`Surroundings`]).
//! - **Out of scope**: visibility between cells (`stabtree`), graphs of points (`visibility-graph`), files, pictures.
//! - **Invariants**: every decision is the sign of a determinant of input coordinates, computed exactly; what is rounded is
//!   output only, each coordinate once. In space rays estimate, with intervals, and a table decides what is 0.

mod build;
mod constructed;
mod corner;
mod delaunay;
mod edge;
mod expand;
mod isovist;
mod limit;
mod locate;
mod locator;
mod measures;
mod mesh;
mod points;
mod region;
mod sees;
mod space;

pub use isovist::{Boundary, Isovist, IsovistFinder};

pub use limit::{LimitError, Limits, Sector};
pub use locate::EyeError;
pub use measures::Measures;
pub use mesh::WallMesh;
pub use points::PointIndex;
pub use region::{ViewerRegion, cells_of_region, seen_from_any};
pub use sees::Touch;
pub use space::{Estimate, Surroundings};

/// Why a plan has no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No line of the plan blocks sight.
    #[error("no line of the plan blocks sight")]
    Empty,
    /// A wall is not strictly inside the frame.
    #[error("line {line} is not inside the frame")]
    Frame {
        /// Index of the line.
        line: usize,
    },
    /// The triangulation rejected a vertex.
    #[error("vertex ({x}, {y}) cannot be triangulated")]
    Vertex {
        /// Its coordinate.
        x: f64,
        /// Its coordinate.
        y: f64,
    },
}
