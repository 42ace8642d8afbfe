//! What can be wrong with a portal file, and where.

use super::PORTAL_POINTS;
use crate::quake::LeafError;
use sightlines_geometry::CoordinateError;
use std::fmt;

/// Why a text is not a portal file, shown as `line 12, column 3: ...`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {kind}")]
pub struct PrtError {
    /// The line, from 1.
    pub line: usize,
    /// The byte in the line, from 1.
    pub column: usize,
    /// What is wrong there.
    #[source]
    pub kind: PrtErrorKind,
}

/// A piece of a portal file. Portals, points, clusters and leafs count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PrtItem {
    /// The word at the beginning.
    Magic,
    /// How many clusters there are.
    Clusters,
    /// How many portals there are.
    Portals,
    /// How many leafs there are.
    Leafs,
    /// How many points a portal has.
    Points {
        /// The portal.
        portal: usize,
    },
    /// One of the clusters that a portal joins.
    Cluster {
        /// The portal.
        portal: usize,
    },
    /// The parenthesis before a point.
    Open {
        /// The portal.
        portal: usize,
        /// The point.
        point: usize,
    },
    /// A coordinate.
    Coordinate {
        /// The portal.
        portal: usize,
        /// The point.
        point: usize,
    },
    /// The parenthesis behind a point.
    Close {
        /// The portal.
        portal: usize,
        /// The point.
        point: usize,
    },
    /// A leaf of a cluster, or the -1 behind the last.
    LeafOfCluster {
        /// The cluster.
        cluster: usize,
    },
    /// The cluster of a leaf.
    ClusterOfLeaf {
        /// The leaf.
        leaf: usize,
    },
    /// How many leafs a cluster has.
    LeafCount {
        /// The cluster.
        cluster: usize,
    },
    /// Whether a portal is a hint.
    Hint {
        /// The portal.
        portal: usize,
    },
    /// How many solid faces there are.
    Faces,
    /// How many points a solid face has.
    FacePoints {
        /// The face.
        face: usize,
    },
    /// The cluster of a solid face.
    FaceCluster {
        /// The face.
        face: usize,
    },
    /// The parenthesis before or behind a point of a solid face, or a coordinate of it.
    FacePoint {
        /// The face.
        face: usize,
        /// The point.
        point: usize,
    },
    /// Nothing more.
    End,
}

impl fmt::Display for PrtItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Magic => f.write_str("PRT1, PRT2, PRT1-AM or the number of clusters"),
            Self::Clusters => f.write_str("the number of clusters"),
            Self::Portals => f.write_str("the number of portals"),
            Self::Leafs => f.write_str("the number of leafs"),
            Self::Points { portal } => write!(f, "the number of points of portal {portal}"),
            Self::Cluster { portal } => write!(f, "a cluster of portal {portal}"),
            Self::Open { portal, point } => write!(f, "the \"(\" before point {point} of portal {portal}"),
            Self::Coordinate { portal, point } => write!(f, "a coordinate of point {point} of portal {portal}"),
            Self::Close { portal, point } => write!(f, "the \")\" behind point {point} of portal {portal}"),
            Self::LeafOfCluster { cluster } => write!(f, "a leaf of cluster {cluster} or -1"),
            Self::ClusterOfLeaf { leaf } => write!(f, "the cluster of leaf {leaf}"),
            Self::LeafCount { cluster } => write!(f, "the number of leafs of cluster {cluster}"),
            Self::Hint { portal } => write!(f, "the hint of portal {portal}"),
            Self::Faces => f.write_str("the number of solid faces"),
            Self::FacePoints { face } => write!(f, "the number of points of solid face {face}"),
            Self::FaceCluster { face } => write!(f, "the cluster of solid face {face}"),
            Self::FacePoint { face, point } => write!(f, "point {point} of solid face {face} in parentheses"),
            Self::End => f.write_str("the end of the file"),
        }
    }
}

/// What is wrong with a portal file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrtErrorKind {
    /// Something else stands where a piece should.
    #[error("expected {item}, found {found:?}")]
    Unexpected {
        /// What should stand there.
        item: PrtItem,
        /// What stands there, cut off after some characters.
        found: String,
    },
    /// The file ends where a piece should stand.
    #[error("expected {item}, found the end of the file")]
    Truncated {
        /// What should stand there.
        item: PrtItem,
    },
    /// A whole number is not in its range.
    #[error("{item}: {found} is not from {min} to {max}")]
    Count {
        /// What it counts.
        item: PrtItem,
        /// The number, as the file has it.
        found: String,
        /// The least that it may be.
        min: u64,
        /// The most that it may be.
        max: u64,
    },
    /// A coordinate cannot be used.
    #[error("portal {portal}, point {point}: {source}")]
    Coordinate {
        /// The portal.
        portal: usize,
        /// The point.
        point: usize,
        /// What is wrong with it.
        source: CoordinateError,
    },
    /// A coordinate of a solid face cannot be used.
    #[error("solid face {face}, point {point}: {source}")]
    FaceCoordinate {
        /// The face.
        face: usize,
        /// The point.
        point: usize,
        /// What is wrong with it.
        source: CoordinateError,
    },
    /// A portal's points span an area but go round none, so that it has no direction.
    #[error("portal {portal} is not a convex polygon: its points go round no area")]
    NotConvex {
        /// The portal.
        portal: usize,
    },
    /// The points of a portal are farther from one plane than rounding explains.
    #[error("portal {portal} is not flat: a point is {by:.3} units off the plane of the others")]
    NotFlat {
        /// The portal.
        portal: usize,
        /// How far the farthest point is from the plane in the middle, map units.
        by: f64,
    },
    /// The corners of a portal go round the wrong way.
    #[error("portal {portal}: its corners are in the wrong order: the other portals of clusters {} and {} lie on the wrong side of it, so what is visible through it would be hidden", clusters[0], clusters[1])]
    InsideOut {
        /// The portal.
        portal: usize,
        /// The clusters that it leads from and into.
        clusters: [u32; 2],
    },
    /// A portal leads back to where it comes from.
    #[error("portal {portal} joins cluster {cluster} with itself")]
    SelfPortal {
        /// The portal.
        portal: usize,
        /// The cluster.
        cluster: u32,
    },
    /// The rest of the file is too short to list the leafs that it claims.
    #[error("{n_leafs} leafs cannot be listed in the {n_bytes} bytes that follow")]
    LeafClaim {
        /// How many the file claims.
        n_leafs: u32,
        /// How many bytes follow.
        n_bytes: usize,
    },
    /// A leaf is in two clusters.
    #[error("leaf {leaf} is in cluster {first} and in cluster {second}")]
    LeafTwice {
        /// The leaf.
        leaf: u32,
        /// The cluster that lists it first.
        first: u32,
        /// The cluster that lists it again; it may be the same.
        second: u32,
    },
    /// A leaf is in no cluster.
    #[error("leaf {leaf} is in no cluster")]
    LeafMissing {
        /// The leaf.
        leaf: usize,
    },
    /// A leaf of an earlier cluster than the leaf before, where only the numbers of leafs are written.
    #[error("leaf {leaf} is of cluster {cluster}, and the leaf before it of a later one")]
    LeafOrder {
        /// The leaf.
        leaf: usize,
        /// Its cluster.
        cluster: u32,
    },
    /// Leafs given by a program do not make clusters.
    #[error(transparent)]
    Leafs(#[from] LeafError),
}

/// The range of how many points a portal may have, as counts are compared.
pub(super) fn point_range() -> std::ops::RangeInclusive<u64> {
    *PORTAL_POINTS.start() as u64..=*PORTAL_POINTS.end() as u64
}

impl From<PrtError> for crate::ReadErrorKind {
    fn from(error: PrtError) -> Self {
        Self::content(error)
    }
}

impl PrtErrorKind {
    /// A number that is not in a range.
    pub(super) fn count(item: PrtItem, found: impl ToString, range: std::ops::RangeInclusive<u64>) -> Self {
        Self::Count { item, found: found.to_string(), min: *range.start(), max: *range.end() }
    }
}
