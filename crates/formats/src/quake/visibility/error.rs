//! What can be wrong between a map, its portals and its visibility lump.

use crate::error::Malformed;

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
    /// The visibility lump of the map cannot be read, or the faces of a leaf cannot be looked up.
    #[error(transparent)]
    Bsp(#[from] Malformed),
}
