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
    /// All of them in their order, with their names in GeoJSON, and how many lists there are around a position.
    const ALL: [(Self, &str, u8); 6] = [
        (Self::Point, "Point", 0),
        (Self::MultiPoint, "MultiPoint", 1),
        (Self::LineString, "LineString", 1),
        (Self::MultiLineString, "MultiLineString", 2),
        (Self::Polygon, "Polygon", 2),
        (Self::MultiPolygon, "MultiPolygon", 3),
    ];

    /// The kind that has a name in GeoJSON.
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, own, _)| *own == name).map(|(kind, ..)| kind)
    }

    /// How many lists there are around a position.
    pub(super) const fn depth(self) -> u8 {
        Self::ALL[self as usize].2
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
