//! What can be wrong between a map, its portals and its visibility lump.

use super::BspError;
use crate::quake::rle::RleError;

/// Why visibility cannot be read from a map or written for it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VisibilityError {
    /// Portals of another map than that of Quake.
    #[error("the portals are of a map with {portals} leafs, this one has {map} that can be seen")]
    Leafs {
        /// Leafs that the portal file has.
        portals: usize,
        /// Leafs of the map that can be seen.
        map: usize,
    },
    /// Portals of another map than that of Quake II or III.
    #[error("the portals are of a map with {portals} clusters, this one has {map}")]
    Clusters {
        /// Clusters that the portal file has.
        portals: usize,
        /// Clusters that the leafs of the map name.
        map: usize,
    },
    /// Portals of another map, which happens to have as many leafs.
    #[error("the portals are of another map: {n_outside} of {n_sides} sides lie outside the leafs that they belong to")]
    OtherMap {
        /// Sides of portals that lie outside the bounds of their leafs.
        n_outside: usize,
        /// Two for each portal.
        n_sides: usize,
    },
    /// The corners of a portal go round the wrong way, as the tree of the map has its clusters.
    #[error("portal {portal}: its corners are in the wrong order: in the map, clusters {} and {} lie on the other sides of it, so what is visible through it would be hidden", clusters[0], clusters[1])]
    InsideOut {
        /// The portal.
        portal: usize,
        /// The clusters that it leads from and into.
        clusters: [u32; 2],
    },
    /// A matrix for another number of clusters.
    #[error("{n_rows} rows of {n_cols} bits are not for {n_clusters} clusters")]
    Matrix {
        /// Rows of the matrix.
        n_rows: usize,
        /// Columns of the matrix.
        n_cols: usize,
        /// Clusters of the map.
        n_clusters: usize,
    },
    /// The lump would be larger than its 32-bit places can say.
    #[error("the visibility lump would have at least {len} bytes, more than a map can have")]
    TooLarge {
        /// Bytes so far.
        len: usize,
    },
    /// The row of a leaf is not in the lump.
    #[error("leaf {leaf}: its row begins at byte {offset} of the {len} bytes of the visibility lump")]
    RowPlace {
        /// The leaf, as the map counts.
        leaf: usize,
        /// Where its row should begin.
        offset: u32,
        /// Bytes of the lump.
        len: usize,
    },
    /// The row of a leaf cannot be read.
    #[error("leaf {leaf}: its row at byte {offset} of the visibility lump: {source}")]
    Row {
        /// The leaf, as the map counts.
        leaf: usize,
        /// Where its row begins.
        offset: u32,
        /// What is wrong with it.
        source: RleError,
    },
    /// The lump is too short for the places of its rows.
    #[error("the visibility lump of {len} bytes has no room for the places of the rows of {n_clusters} clusters")]
    Places {
        /// Bytes of the lump.
        len: usize,
        /// Clusters that it claims.
        n_clusters: u32,
    },
    /// The lump is too short for its rows, or these are too short for so many clusters.
    #[error("the visibility lump of {len} bytes has no room for rows of {n_clusters} clusters of {width} bytes each")]
    RawRows {
        /// Bytes of the lump.
        len: usize,
        /// Clusters that it claims.
        n_clusters: u32,
        /// Bytes of a row that it claims.
        width: u32,
    },
    /// The lump is for another number of clusters than the map has.
    #[error("the visibility lump is for {lump} clusters, the leafs have {map}")]
    LumpClusters {
        /// Clusters of the lump.
        lump: u32,
        /// Clusters that leafs name.
        map: usize,
    },
    /// The row of a cluster is not in the lump.
    #[error("cluster {cluster}: its row begins at byte {offset} of the {len} bytes of the visibility lump")]
    ClusterRowPlace {
        /// The cluster.
        cluster: usize,
        /// Where its row should begin.
        offset: u32,
        /// Bytes of the lump.
        len: usize,
    },
    /// The row of a cluster cannot be read.
    #[error("cluster {cluster}: its row at byte {offset} of the visibility lump: {source}")]
    ClusterRow {
        /// The cluster.
        cluster: usize,
        /// Where its row begins.
        offset: u32,
        /// What is wrong with it.
        source: RleError,
    },
    /// The faces of a leaf cannot be looked up.
    #[error(transparent)]
    Bsp(#[from] BspError),
}
