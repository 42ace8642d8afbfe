//! Why portals cannot be baked.

use sightlines_formats::Malformed;
use sightlines_formats::quake::VisibilityError;
use sightlines_progress::{Cancelled, Halt};
use sightlines_pvs::TableError;

/// Why portals, or a map with them, could not be baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrtBakeError {
    /// No cluster leads to another, which no map with several clusters intends.
    #[error("there are {n_clusters} clusters, but no portals between them")]
    NoPortals {
        /// Clusters of the file.
        n_clusters: u32,
    },
    /// Portals and map do not fit together, or the answer does not fit into the map.
    #[error(transparent)]
    Visibility(#[from] VisibilityError),
    /// The map cannot be written with its visibility.
    #[error(transparent)]
    Bsp(#[from] Malformed),
    /// The observer cancelled the search.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the search: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(Halt),
    /// A portal that lies on no plane of the map's tree that divides its clusters.
    #[error(
        "portal {portal} is {by} units away from every plane that divides clusters {} and {} of the map",
        clusters[0], clusters[1]
    )]
    OffPlane {
        /// The portal, as an index of those with area.
        portal: usize,
        /// Its clusters.
        clusters: [u32; 2],
        /// How far away its farthest corner is from the nearest such plane, in map units.
        by: f64,
    },
    /// An override of a leaf that cannot be seen.
    #[error("leaf {leaf} of an override is none of the map's that can be seen")]
    NoLeaf {
        /// The leaf, by its number in the map.
        leaf: u32,
    },
    /// An override that hides a cluster from itself.
    #[error("leafs {} and {} of an override are in one cluster, which sees itself", leafs[0], leafs[1])]
    OneCluster {
        /// The leafs, by their numbers in the map.
        leafs: [u32; 2],
    },
    /// The parts of the table do not fit together: a defect of this crate.
    #[error("the table is inconsistent: {0}")]
    Table(#[from] TableError),
}

impl From<Halt> for PrtBakeError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Cancelled(cancelled) => cancelled.into(),
            halt => Self::Halted(halt),
        }
    }
}
