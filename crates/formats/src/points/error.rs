//! What can be wrong with a file of points, and where.

use crate::GeoJsonError;
use sightlines_geometry::CoordinateError;

/// A text that is not a list of points, shown as `line 3 column 5: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line} column {column}: {kind}")]
pub struct PointsError {
    /// Line of the text, from 1.
    pub line: usize,
    /// Byte in that line at which the value begins, from 1.
    pub column: usize,
    /// What is wrong.
    #[source]
    pub kind: PointsErrorKind,
}

impl PointsError {
    pub(super) const fn at(line: usize, column: usize, kind: PointsErrorKind) -> Self {
        Self { line, column, kind }
    }
}

/// What is wrong with a text of points.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointsErrorKind {
    /// Bytes that are not text.
    #[error("this is not UTF-8")]
    NotText,
    /// A value that should be a number.
    #[error("'{}' is not a number", .0.escape_debug())]
    Number(String),
    /// A number that cannot be a coordinate, such as infinity.
    #[error(transparent)]
    Coordinate(#[from] CoordinateError),
    /// A value that is not there.
    #[error("there is no {0}")]
    Missing(&'static str),
    /// More values than columns.
    #[error("there are more values than x, y and a name")]
    TooMany,
    /// A value in quotes that does not end on its line, or goes on behind them.
    #[error("the quotes are not closed at the end of the value")]
    Quotes,
    /// A header without a column that is needed.
    #[error("the header names no column {0}")]
    Header(&'static str),
    /// A header with two columns of one name.
    #[error("the header names two columns {0}")]
    Twice(&'static str),
    /// A file without any point.
    #[error("there are no points in the file")]
    None,
    /// GeoJSON with something else than points.
    #[error("there are lines in the file, which should hold points only")]
    Lines,
    /// GeoJSON with points that are one object together.
    #[error("the object \"{}\" is a box, not a point", .0.escape_debug())]
    Box(String),
    /// The text is not GeoJSON.
    #[error("{}", .0.kind)]
    GeoJson(#[source] Box<GeoJsonError>),
}

impl From<GeoJsonError> for PointsError {
    fn from(error: GeoJsonError) -> Self {
        Self::at(error.line, error.column, PointsErrorKind::GeoJson(error.into()))
    }
}

impl From<PointsError> for crate::ReadErrorKind {
    fn from(error: PointsError) -> Self {
        Self::content(error)
    }
}
