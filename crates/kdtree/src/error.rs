//! What can be wrong with a scene that is to be cut.

use sightlines_geometry::CoordinateError;

/// What is wrong with one face.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaceError {
    /// A coordinate cannot be used.
    #[error(transparent)]
    Coordinate(CoordinateError),
    /// The axis does not exist in this dimension.
    #[error("axis {0} does not exist")]
    Axis(usize),
    /// The face does not lie on its own plane.
    #[error("extends from {min} to {max} across its plane at {at}")]
    OffPlane {
        /// Where the plane is.
        at: f64,
        /// Lower end of the face across the plane.
        min: f64,
        /// Upper end of the face across the plane.
        max: f64,
    },
    /// The lower end is above the upper.
    #[error("begins at {min} on axis {axis}, above its end {max}")]
    Reversed {
        /// On which axis.
        axis: usize,
        /// The lower end.
        min: f64,
        /// The upper end.
        max: f64,
    },
}

/// Why a scene cannot be cut.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KdError {
    /// A face is invalid.
    #[error("face {face}: {kind}")]
    Face {
        /// Index of the face.
        face: usize,
        /// What is wrong with it.
        #[source]
        kind: FaceError,
    },
    /// A coordinate of the bounds cannot be used.
    #[error("bounds: {0}")]
    Bounds(#[source] CoordinateError),
    /// There is nothing to cut.
    #[error("the scene is empty")]
    Empty,
    /// The bounds have no extent along an axis, so there is no room for cells.
    #[error("the scene has no extent along axis {axis}")]
    Flat {
        /// The axis.
        axis: usize,
    },
    /// The threshold is not a number from 0 to 1.
    #[error("obscuration threshold {0} is not a number from 0 to 1")]
    Tau(f64),
    /// The size of detail is not a number of at least 0.
    #[error("size of detail {0} is not a number from 0 on")]
    DetailBelow(f64),
    /// The view region has a lower corner above its upper one.
    #[error("the view region has a lower corner above its upper one")]
    ViewRegion,
    /// More faces than can be counted.
    #[error("{0} faces are more than a tree can hold")]
    TooManyFaces(usize),
    /// The subdivision has more cells than [`KdOptions::max_cells`](crate::KdOptions::max_cells).
    #[error("the scene falls into more than {limit} cells; raise the limit, the threshold tau, or the size of detail")]
    TooManyCells {
        /// The limit.
        limit: u32,
    },
}
