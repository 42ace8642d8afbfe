//! What can be wrong with a GeoJSON plan, and where.

use super::MAX_GROUPS;
use sightlines_cells::PlanError;
use sightlines_geometry::CoordinateError;
use std::fmt;

/// A GeoJSON text that is not a plan, shown as `line 3 column 14: feature 2: position 5: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line} column {column}: {place}{kind}")]
pub struct GeoJsonError {
    /// Line of the text where reading stopped, from 1; for errors that concern a whole feature, its end.
    pub line: usize,
    /// Column in that line.
    pub column: usize,
    /// Where in the scene.
    pub place: GeoJsonPlace,
    /// What is wrong.
    #[source]
    pub kind: GeoJsonErrorKind,
}

/// A place in a scene; what is not known or not meant is `None`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GeoJsonPlace {
    /// Index of the feature; 0 for a lone feature or geometry.
    pub feature: Option<usize>,
    /// Index of the geometry in a GeometryCollection, nested ones counted through.
    pub geometry: Option<usize>,
    /// Index of the line or ring in the geometry, those of several polygons counted through.
    pub part: Option<usize>,
    /// Index of the position in that line or ring.
    pub position: Option<usize>,
}

impl fmt::Display for GeoJsonPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let levels =
            [("feature", self.feature), ("geometry", self.geometry), ("part", self.part), ("position", self.position)];
        for (level, index) in levels {
            if let Some(index) = index {
                write!(f, "{level} {index}: ")?;
            }
        }
        Ok(())
    }
}

/// A kind of geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GeometryKind {
    /// One position.
    Point,
    /// Positions.
    MultiPoint,
    /// Positions joined one after the other.
    LineString,
    /// Lines.
    MultiLineString,
    /// Rings.
    Polygon,
    /// Polygons.
    MultiPolygon,
}

impl GeometryKind {
    pub(super) const ALL: [Self; 6] =
        [Self::Point, Self::MultiPoint, Self::LineString, Self::MultiLineString, Self::Polygon, Self::MultiPolygon];

    /// The name it has in GeoJSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "Point",
            Self::MultiPoint => "MultiPoint",
            Self::LineString => "LineString",
            Self::MultiLineString => "MultiLineString",
            Self::Polygon => "Polygon",
            Self::MultiPolygon => "MultiPolygon",
        }
    }

    /// How many lists there are around a position.
    pub(super) const fn depth(self) -> u8 {
        match self {
            Self::Point => 0,
            Self::MultiPoint | Self::LineString => 1,
            Self::MultiLineString | Self::Polygon => 2,
            Self::MultiPolygon => 3,
        }
    }
}

impl fmt::Display for GeometryKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What is wrong with a GeoJSON text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeoJsonErrorKind {
    /// The text is not JSON, ends early, or has a number that no f64 can hold.
    #[error("not JSON that can be read")]
    Syntax,
    /// The text ends before the value does.
    #[error("the text ends too early")]
    Truncated,
    /// A value of another kind than GeoJSON has there.
    #[error("\"{member}\" is not {expected}")]
    Member {
        /// The member of the object.
        member: &'static str,
        /// What belongs there.
        expected: &'static str,
    },
    /// A value that should be an object is not.
    #[error("not a JSON object")]
    NotAnObject,
    /// A member that the object needs is not there.
    #[error("there is no \"{0}\"")]
    Missing(&'static str),
    /// A member is there twice.
    #[error("there are two members \"{0}\"")]
    Repeated(&'static str),
    /// A position, line or ring of the wrong shape in coordinates.
    #[error("the coordinates are not lists of positions of two numbers or more, all equally deep")]
    Coordinates,
    /// Coordinates with more or fewer lists around a position than their geometry has.
    #[error("the coordinates are not those of a {0}")]
    Depth(GeometryKind),
    /// A number that cannot be a coordinate.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// A property that concerns sight, with a value that is not understood.
    #[error("property \"{property}\" is not {expected}")]
    Property {
        /// The property.
        property: &'static str,
        /// What belongs there.
        expected: &'static str,
    },
    /// A group that is too large.
    #[error("property \"{property}\": group {group} is not below {MAX_GROUPS}")]
    Group {
        /// The property.
        property: &'static str,
        /// The group.
        group: u64,
    },
    /// The whole is not a plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

impl From<GeoJsonError> for crate::ReadErrorKind {
    fn from(error: GeoJsonError) -> Self {
        Self::content(error)
    }
}
