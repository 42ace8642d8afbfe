//! Floor plans as GeoJSON: lines and outlines are walls, points are objects.
//!
//! The reader takes FeatureCollections, single Features and bare geometries, GeometryCollections included, with
//! coordinates as they are: numbers in one plane, not degrees. Heights are ignored.
//!
//! | property of a feature | meaning |
//! | --- | --- |
//! | `"sight": "transparent"` or `"opaque": false` | its lines do not block sight |
//! | `"mirror": true` | its lines are mirrors, which have to block sight |
//! | `"left_group"`, `"right_group"` | groups on the two sides of its lines |
//! | `"name"`, else `"id"` | what its points are called |
//! | `"object": "box"` | its points are corners of one object, not an object each |
//!
//! Several texts one behind the other are one plan: a text a line, as newline-delimited GeoJSON has them, or a sequence of RFC 8142, in which
//! a record separator stands before each.
//!
//! A member `crs` of the whole, as older files have, is kept as it is and written again ([`write_plan_file`]). A member
//! `sightlines_precision` of the whole states how precise coordinates are ([`Plan::precision`](sightlines_cells::Plan::precision)), in units of the
//! plan; without it their digits tell. Lines without length and
//! lines that repeat others are dropped and counted ([`PlanFile`](crate::PlanFile)). Other properties and members mean nothing here. The reader works as it goes and keeps nothing but the
//! plan and one geometry, so a large file that is no plan costs no memory.

mod context;
mod coordinates;
mod geometry;
mod node;
mod plan_builder;
mod properties;
mod read;
mod sequence;
mod write;

pub(crate) use sequence::is_sequence;

pub use read::{parse_plan, parse_plan_file, read_plan, read_plan_file};
pub use write::{write_plan, write_plan_file};

/// Groups are below this number, because tables over groups follow.
pub const MAX_GROUPS: u32 = 1 << 20;
