#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the coordinate types ([`Point2`], [`Point3`], [`Segment2`], [`Aabb`]), the orientation predicate of
//!   the plane in two forms with one meaning ([`Adaptive`], [`SmallGrid`]) and that of space ([`orient3d`]),
//!   convex polygons in the plane, [`PolygonRegion`]s inside of any polygon, triangles of polygons in space ([`triangles`]), oriented portals of each kind, trees of boxes ([`BoxTree`]); and for estimates in plain doubles
//!   ranges of numbers ([`range`]), sines that are the same everywhere ([`sin_cos`]), vectors of space ([`vector`]), rays ([`ray_triangle`], [`ray_box`]) and pseudorandom numbers ([`Random`]).
//! - **Out of scope**: walls, cells, portals, files.
//! - **Invariants**: a predicate reads input coordinates only and its sign is exact for every coordinate that
//!   [`check_coordinate`] accepts; nothing here compares with an epsilon.

pub mod angle;
pub mod bounds;
pub mod boxtree;
pub mod coordinate;
pub mod door;
pub mod orient;
pub mod orient3;
pub mod polygon;
pub mod portal;
pub mod portal3;
pub mod random;
pub mod range;
pub mod ray;
pub mod region;
pub mod segment;
pub mod triangles;
pub mod vector;

pub use angle::sin_cos;
pub use bounds::Aabb;
pub use boxtree::{BoxNode, BoxTree};
pub use coordinate::{CoordinateError, check_coordinate};
pub use door::{AxialDoor, OneWayRectangle};
pub use orient::{Adaptive, Orient2d, SmallGrid, along, orient2d};
pub use orient3::orient3d;
pub use polygon::{is_convex_ccw, polygon_contains, signed_area};
pub use portal::Portal2;
pub use portal3::Portal3;
pub use random::Random;
pub use ray::{ray_box, ray_triangle};
pub use region::PolygonRegion;
pub use segment::Segment2;

/// A point of the plane in scene units.
pub type Point2 = glam::DVec2;

/// A point of space: x, y and z in scene units.
pub type Point3 = [f64; 3];
