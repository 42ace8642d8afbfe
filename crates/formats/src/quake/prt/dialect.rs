//! Ways of writing portals.

use std::fmt;

/// A way of writing portals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrtDialect {
    /// `PRT1`: clusters are leafs (Quake), or the map lists which leafs they are made of (Quake II).
    Prt1,
    /// `PRT2` of ericw-tools: the leafs of each cluster.
    Prt2,
    /// `PRT1-AM` of bjptools: the cluster of each leaf.
    Prt1Am,
    /// That of Half-Life's compilers, without a word at the beginning: how many leafs follow each other in each cluster.
    HalfLife,
    /// `PRT1` of Quake III's compilers: portals with hints, and the solid faces of clusters.
    ///
    /// If there are portals, `PRT1` has three numbers and a parenthesis behind the two counts, this one five numbers. If there are
    /// none, `PRT1` has nothing, and this one the number of faces. A file that has neither is read as `PRT1`, and refused.
    Quake3,
}

impl PrtDialect {
    /// All that are read.
    pub const ALL: [Self; 5] = [Self::Prt1, Self::Prt2, Self::Prt1Am, Self::HalfLife, Self::Quake3];

    pub(crate) const MAGICS: [&'static [u8]; 3] = [b"PRT1", b"PRT2", b"PRT1-AM"];

    /// The word that a file begins with, if it is one.
    pub const fn magic(self) -> Option<&'static str> {
        match self {
            Self::Prt1 | Self::Quake3 => Some("PRT1"),
            Self::Prt2 => Some("PRT2"),
            Self::Prt1Am => Some("PRT1-AM"),
            Self::HalfLife => None,
        }
    }

    /// Its name, as users know it.
    pub const fn name(self) -> &'static str {
        ["PRT1", "PRT2", "PRT1-AM", "PRT of Half-Life", "PRT1 of Quake III"][self as usize]
    }
}

impl fmt::Display for PrtDialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How leafs that are not clusters are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafList {
    /// The leafs of each cluster, as `PRT2` does.
    PerCluster,
    /// The cluster of each leaf, as `PRT1-AM` does.
    PerLeaf,
    /// The number of leafs of each cluster, which follow those of the one before, as Half-Life does.
    Counts,
}
