//! Which leafs make up which cluster.

use super::MAX_CLUSTERS;
use crate::error::{Malformed, malformed};

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

impl LeafClusters {
    /// Groups leafs by the cluster of each. O(leafs + clusters).
    ///
    /// # Errors
    /// [`Malformed`] for no clusters or more than [`MAX_CLUSTERS`], for more leafs than 32 bits count, and for a leaf of a cluster that does not exist.
    pub fn new(n_clusters: u32, cluster_of_leaf: Vec<u32>) -> Result<Self, Malformed> {
        let n_leafs = cluster_of_leaf.len();
        if !(1..=MAX_CLUSTERS).contains(&n_clusters) {
            return Err(malformed!("{n_clusters} clusters are not from 1 to {MAX_CLUSTERS}"));
        }
        if u32::try_from(n_leafs).is_err() {
            return Err(malformed!("{n_leafs} leafs are too many"));
        }
        if let Some(leaf) = cluster_of_leaf.iter().position(|&c| c >= n_clusters) {
            let cluster = cluster_of_leaf[leaf];
            return Err(malformed!("leaf {leaf} is in cluster {cluster}, but there are {n_clusters}"));
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
    /// [`Malformed`] for a number of clusters as in [`Self::new`].
    pub fn identity(n_clusters: u32) -> Result<Self, Malformed> {
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
