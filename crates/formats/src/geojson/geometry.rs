//! A geometry that was read.

use super::coordinates::Coordinates;
use super::error::GeometryKind;

/// A geometry whose coordinates have the depth of its kind.
#[derive(Debug)]
pub(super) struct Geometry {
    pub(super) kind: GeometryKind,
    pub(super) coordinates: Coordinates,
    /// Its place in a GeometryCollection.
    pub(super) index: Option<usize>,
}
