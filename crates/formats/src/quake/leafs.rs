//! Which leafs make up which cluster.

use super::MAX_CLUSTERS;

/// The clusters of a map and their leafs. Every leaf is in exactly one cluster; a cluster may be empty.
///
/// Leafs count from 0 here: leaf `k` is leaf `k + 1` of the map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeafClusters {
    cluster_of_leaf: Vec<u32>,
    /// Where the leafs of each cluster begin in `leafs`, and behind them its length.
    starts: Vec<u32>,
    leafs: Vec<u32>,
}

/// Why leafs do not make clusters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LeafError {
    /// No clusters, or more than can be held.
    #[error("{n_clusters} clusters are not from 1 to {MAX_CLUSTERS}")]
    Clusters {
        /// How many.
        n_clusters: u32,
    },
    /// A leaf names a cluster that does not exist.
    #[error("leaf {leaf} is in cluster {cluster}, but there are {n_clusters}")]
    Cluster {
        /// The leaf, from 0.
        leaf: usize,
        /// The cluster that it names.
        cluster: u32,
        /// How many clusters there are.
        n_clusters: u32,
    },
    /// More leafs than 32 bits count.
    #[error("{n_leafs} leafs are too many")]
    Leafs {
        /// How many.
        n_leafs: usize,
    },
}

impl LeafClusters {
    /// Groups leafs by the cluster of each. O(leafs + clusters).
    ///
    /// # Errors
    /// [`LeafError`].
    pub fn new(n_clusters: u32, cluster_of_leaf: Vec<u32>) -> Result<Self, LeafError> {
        let n_leafs = cluster_of_leaf.len();
        if !(1..=MAX_CLUSTERS).contains(&n_clusters) {
            return Err(LeafError::Clusters { n_clusters });
        }
        if u32::try_from(n_leafs).is_err() {
            return Err(LeafError::Leafs { n_leafs });
        }
        if let Some(leaf) = cluster_of_leaf.iter().position(|&c| c >= n_clusters) {
            return Err(LeafError::Cluster { leaf, cluster: cluster_of_leaf[leaf], n_clusters });
        }
        let mut starts = vec![0u32; n_clusters as usize + 1];
        cluster_of_leaf.iter().for_each(|&c| starts[c as usize + 1] += 1);
        (1..starts.len()).for_each(|k| starts[k] += starts[k - 1]);
        let mut free = starts.clone();
        let mut leafs = vec![0; n_leafs];
        for (leaf, &cluster) in cluster_of_leaf.iter().enumerate() {
            leafs[free[cluster as usize] as usize] = leaf as u32;
            free[cluster as usize] += 1;
        }
        Ok(Self { cluster_of_leaf, starts, leafs })
    }

    /// Every leaf is a cluster of its own.
    ///
    /// # Errors
    /// [`LeafError::Clusters`].
    pub fn identity(n_clusters: u32) -> Result<Self, LeafError> {
        // The count is checked before memory is taken for it.
        Self::new(n_clusters, if n_clusters <= MAX_CLUSTERS { (0..n_clusters).collect() } else { Vec::new() })
    }

    /// Number of leafs.
    pub fn n_leafs(&self) -> usize {
        self.leafs.len()
    }

    /// Number of clusters.
    pub fn n_clusters(&self) -> usize {
        self.starts.len() - 1
    }

    /// The cluster of each leaf.
    pub fn cluster_of_leaf(&self) -> &[u32] {
        &self.cluster_of_leaf
    }

    /// The leafs of a cluster, ascending.
    ///
    /// # Panics
    /// If there is no such cluster.
    pub fn leafs_of(&self, cluster: usize) -> &[u32] {
        &self.leafs[self.starts[cluster] as usize..self.starts[cluster + 1] as usize]
    }
}
