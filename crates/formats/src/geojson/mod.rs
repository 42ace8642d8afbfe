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

mod coordinates;
mod node;
mod plan_builder;
mod properties;
mod read;
mod write;

pub(crate) use read::is_sequence;
pub use read::{parse_plan, parse_plan_file, read_plan, read_plan_file};
pub use write::{write_plan, write_plan_file};

use std::fmt;

/// Groups are below this number, because tables over groups follow.
pub const MAX_GROUPS: u32 = 1 << 20;

/// The place in the text's scene, and why reading failed or is about to fail there.
pub(super) type Context = crate::json::Context<Place>;

/// A place in a scene; what is not known or not meant is `None`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Place {
    /// Index of the feature; 0 for a lone feature or geometry.
    pub(super) feature: Option<usize>,
    /// Index of the geometry in a GeometryCollection, nested ones counted through.
    pub(super) geometry: Option<usize>,
    /// Index of the line or ring in the geometry, those of several polygons counted through.
    pub(super) part: Option<usize>,
    /// Index of the position in that line or ring.
    pub(super) position: Option<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let indices = [self.feature, self.geometry, self.part, self.position];
        let levels = ["feature", "geometry", "part", "position"].into_iter().zip(indices);
        let levels: Vec<String> = levels.filter_map(|(level, index)| Some(format!("{level} {}", index?))).collect();
        f.write_str(&levels.join(": "))
    }
}
