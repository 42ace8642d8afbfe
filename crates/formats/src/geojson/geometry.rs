//! A geometry that was read.

use super::coordinates::Coordinates;

/// A kind of geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GeometryKind {
    Point,
    MultiPoint,
    LineString,
    MultiLineString,
    Polygon,
    MultiPolygon,
}

impl GeometryKind {
    /// The kind that has a name in GeoJSON.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "Point" => Self::Point,
            "MultiPoint" => Self::MultiPoint,
            "LineString" => Self::LineString,
            "MultiLineString" => Self::MultiLineString,
            "Polygon" => Self::Polygon,
            "MultiPolygon" => Self::MultiPolygon,
            _ => return None,
        })
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

/// A geometry whose coordinates have the depth of its kind.
#[derive(Debug)]
pub(super) struct Geometry {
    pub(super) kind: GeometryKind,
    pub(super) coordinates: Coordinates,
    /// Its place in a GeometryCollection.
    pub(super) index: Option<usize>,
}
