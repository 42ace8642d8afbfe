//! What a Quake map or its portal file holds.

use crate::error::Result;
use crate::output::{JsonSchema, Serialize, count, percent, unless_none};
use sightlines::formats::Bsp;
use sightlines::formats::quake::visibility::read_visibility;
use sightlines::formats::quake::{LeafClusters, read_bsp, read_prt};
use std::fmt;
use std::path::Path;

/// The numbers of a portal file.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct PrtInfo {
    /// The file.
    file: String,
    /// `portals`.
    kind: &'static str,
    /// Dialect of the portal file.
    portal_format: &'static str,
    /// Clusters.
    n_clusters: u32,
    /// Leafs; null if the file does not list them.
    n_leafs: Option<usize>,
    /// Portals.
    n_portals: usize,
    /// Of these, portals without area, through which nothing is visible.
    n_degenerate_portals: usize,
    /// Of these, portals that the file has again; they are used once.
    n_repeated_portals: usize,
    /// Clusters that no portal leads to.
    n_closed_clusters: usize,
}

impl PrtInfo {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let prt = read_prt(path)?;
        let mut is_closed = vec![true; prt.n_clusters() as usize];
        prt.portals().flat_map(|portal| portal.clusters).for_each(|cluster| is_closed[cluster as usize] = false);
        Ok(Self {
            file: path.display().to_string(),
            kind: "portals",
            portal_format: prt.dialect().name(),
            n_clusters: prt.n_clusters(),
            n_leafs: prt.listed_leafs().map(LeafClusters::n_leafs),
            n_portals: prt.n_portals(),
            n_degenerate_portals: prt.portals().filter(|portal| portal.is_degenerate()).count(),
            n_repeated_portals: prt.n_repeats(),
            n_closed_clusters: is_closed.iter().filter(|closed| **closed).count(),
        })
    }
}

impl fmt::Display for PrtInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: portal file of a Quake map, {}", self.file, self.portal_format)?;
        let closed = unless_none(self.n_closed_clusters, |n| format!(", {n} of them without a portal"));
        writeln!(f, "clusters       {}{closed}", self.n_clusters)?;
        match self.n_leafs {
            Some(n) => writeln!(f, "leafs          {n}")?,
            None => writeln!(f, "leafs          not listed")?,
        }
        let degenerate = unless_none(self.n_degenerate_portals, |n| format!(", {n} of them without area"));
        let repeated = unless_none(self.n_repeated_portals, |n| format!(", {n} of them repeats"));
        writeln!(f, "portals        {}{degenerate}{repeated}", self.n_portals)
    }
}

/// The numbers of a map.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct BspInfo {
    /// The file.
    file: String,
    /// `bsp`.
    kind: &'static str,
    /// Format of the map.
    format: &'static str,
    #[serde(skip)]
    game: &'static str,
    /// Leafs, including the solid one and those of doors and the like.
    n_leafs: usize,
    /// Leafs that can be visible.
    n_visible_leafs: usize,
    /// Clusters of Quake II; null in other formats.
    n_clusters: Option<usize>,
    /// `none`, `there` or `damaged`.
    visibility: &'static str,
    /// Bytes of the visibility.
    visibility_bytes: usize,
    /// What sees and is seen: `leaf`, or `cluster` in Quake II and III.
    pairs_of: &'static str,
    /// Ordered pairs of different ones of which the second is visible from the first, as the map lists them; null without visibility.
    n_seen_pairs: Option<u64>,
    /// The same as a share of all ordered pairs of different ones.
    seen_share: Option<f64>,
    /// Why the visibility cannot be read; null if it can.
    error: Option<String>,
}

impl BspInfo {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let bsp = read_bsp(path)?;
        let has_clusters = bsp.format().has_clusters();
        let mut info = Self {
            file: path.display().to_string(),
            kind: "bsp",
            format: bsp.format().name(),
            game: bsp.format().game(),
            n_leafs: bsp.leafs().len(),
            n_visible_leafs: bsp.n_visible_leafs(),
            n_clusters: has_clusters.then(|| bsp.n_clusters()),
            visibility: if bsp.visibility().is_empty() { "none" } else { "there" },
            visibility_bytes: bsp.visibility().len(),
            pairs_of: if has_clusters { "cluster" } else { "leaf" },
            n_seen_pairs: None,
            seen_share: None,
            error: None,
        };
        if !bsp.visibility().is_empty() {
            match seen_pairs(&bsp) {
                Err(error) => (info.visibility, info.error) = ("damaged", Some(error)),
                Ok((n_seen, n_pairs)) => {
                    info.n_seen_pairs = Some(n_seen);
                    info.seen_share = Some(n_seen as f64 / n_pairs.max(1) as f64);
                }
            }
        }
        Ok(info)
    }
}

/// How many ordered pairs of different leafs or clusters see each other, and how many there are.
fn seen_pairs(bsp: &Bsp) -> Result<(u64, u64), String> {
    let n = if bsp.format().has_clusters() { bsp.n_clusters() } else { bsp.n_visible_leafs() };
    let leafs = LeafClusters::identity(u32::try_from(n).unwrap_or(u32::MAX)).map_err(|error| error.to_string())?;
    let seen = read_visibility(bsp, &leafs).map_err(|error| error.to_string())?;
    let Some(seen) = seen else { return Ok((0, 0)) };
    let itself = (0..n).filter(|&k| seen.get(k, k)).count() as u64;
    Ok((seen.count_ones() - itself, n as u64 * (n as u64).saturating_sub(1)))
}

impl fmt::Display for BspInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} map, {}", self.file, self.game, self.format)?;
        writeln!(f, "leafs          {}, {} of them can be seen", self.n_leafs, self.n_visible_leafs)?;
        if let Some(n) = self.n_clusters {
            writeln!(f, "clusters       {n}")?;
        }
        let size = count(self.visibility_bytes as u64, "byte");
        match (&self.error, self.n_seen_pairs, self.seen_share) {
            (Some(error), _, _) => writeln!(f, "visibility     {size}, cannot be read: {error}"),
            (None, Some(n), Some(share)) => {
                writeln!(f, "visibility     {size}: {n} pairs of {}s, {}", self.pairs_of, percent(share))
            }
            _ => writeln!(f, "visibility     none: not computed yet"),
        }
    }
}
