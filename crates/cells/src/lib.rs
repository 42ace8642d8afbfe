#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: [`Plan`] (a scene in the plane, validated once), [`CellGraph`] (convex cells, the portals between them,
//!   and which portal leads where) for every kind of cell, and what makes a graph well formed.
//! - **Out of scope**: how a scene was cut, how a sight line is found, files.
//! - **Invariants**: ids are dense from 0; a portal joins two different cells; a cell's exits are ordered by
//!   side, then portal; every cell lies on the left of its own sides.

pub mod axial;
pub mod closed;
pub mod convex;
mod digest;
pub mod graph;
pub mod plan;
pub mod planar;
pub mod scene;
pub mod unlike;

pub use axial::{Axial, BoxCell};
pub use convex::{Convex, ConvexCell3};
pub use graph::{CellGraph, Exit, Portal, PortalId, Space};
pub use plan::{Joint, LineId, Plan, PlanError, PlanLine, PlanObject};
pub use planar::{ConvexCell2, Planar, WellFormedError};
pub use scene::{ANYWHERE, MovingObject, Scene, SceneError, SceneObject, places_of_triangles};
pub use sightlines_geometry::{AxialDoor, Point3, Portal2, Portal3};
pub use sightlines_pvs::CellId;
pub use unlike::{Unlike, unlike};
