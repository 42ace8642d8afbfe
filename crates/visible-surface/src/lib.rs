#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: faces and cameras; back-face and frustum culling; the painter, Newell, Schumacker and BSP methods, which
//!   order faces and split them where they must; the z-buffer and the ray caster; the comparison of their pictures.
//! - **Out of scope**: visibility tables (a caller that has one passes the faces to draw), files, colours.
//! - **Invariants**: which pixels a face covers, which of two faces is nearer at a pixel, and on which side of a plane
//!   a fragment lies are signs of polynomials in input coordinates, computed exactly. So all exact methods show the
//!   same face in every pixel, except where two faces of different planes are met first at exactly one depth: on the
//!   line where they intersect, or on an edge that they share. There either may be shown. The same input gives the same
//!   picture.

pub mod any_order;
pub mod bsp;
pub mod camera;
pub mod compare;
pub mod counters;
pub mod cull;
pub mod cull_step;
mod extents;
pub mod face_mask;
pub mod faces;
pub mod fragment;
pub mod hierarchical;
pub mod image;
pub mod method;
mod nearness;
pub mod newell;
pub mod painter;
pub mod plane;
pub mod raycast;
mod rows;
pub mod schumacker;
mod side;
pub mod technique;
mod vector;
mod window;
pub mod zbuffer;

pub use any_order::{AnyOrder, is_convex};
pub use bsp::{BspOptions, BspStats, FaceBsp, FaceBspNode, Heuristic};
pub use camera::{Camera, CameraError};
pub use compare::{Comparison, compare};
pub use counters::Counters;
pub use cull_step::CullStep;
pub use face_mask::FaceMask;
pub use faces::{Faces, FacesError, NOTHING};
pub use fragment::{Extents, Fragment, Relation};
pub use image::Image;
pub use method::{RenderInput, RenderOutput, VisibleSurface};
pub use newell::Newell;
pub use painter::Painter;
pub use plane::InputPlane;
pub use raycast::{RayCaster, Rays};
pub use schumacker::{Schumacker, SchumackerOptions, SchumackerStats};
pub use technique::{PreparedMethod, Preparer, Technique};
pub use zbuffer::{DepthFormat, ZBuffer};
